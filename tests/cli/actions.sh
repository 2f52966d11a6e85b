#!/bin/bash
# SPDX-License-Identifier: MIT
# A kiosk with 12 poses of which few are in memory, and whatever may be done to it, at random: all
# actions, other configurations, its file cut short and put back. INLAY_ACTIONS says how often (200 times in each
# mode), INLAY_SEED what (when each comes has its part, too, and must not matter).
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

most=200
[ -z "${INLAY_THOROUGH:-}" ] || most=5000
times=${INLAY_ACTIONS:-$most}
seed=${INLAY_SEED:-20261120}
echo "# actions: INLAY_SEED=$seed, $times times"
cat "$work/box.scene" - >"$work/turn.scene" <<'END'
[poses]
count = 12
[keyframe front]
object = box
[keyframe round]
object = box
pose = 11
rotate = 0 0 80
END
check "12 poses are baked" "$INLAY_BAKE" render "$work/turn.scene" --quiet --exact --frequency 1 --samples 1 \
	-o "$work/turn.inlay"
sed '/^\[basis\]/,/^file/d; /^\[composite\]/,$d' "$work/studio.conf" >"$work/first.conf"

round() { # MODE
	cp "$work/turn.inlay" "$work/own.inlay"
	cp "$work/first.conf" "$work/studio.conf"
	start --set "basis.file=$work/own.inlay" --set "control.socket=$work/socket" --set composite.mode="$1" \
		--set camera.background.rate=60
	check "$1: frames are shown" shows_frames
	check "$1: it answers whatever happens, and shows a pose at the end" python3 "$(dirname "$0")/tools/actions.py" \
		"$work/socket" "$inlay" "$times" "$seed" "$work/studio.conf" \
		"$work/own.inlay"
	check "$1: it still runs" alive
	stop
	equal "$1: it ends well" 0 $?
	equal "$1: no sanitizer has anything to say" "" \
		"$(grep -E 'runtime error|Sanitizer' "$work/run.log")"
}
round fast
round exact
finish
