#!/bin/bash
# SPDX-License-Identifier: MIT
# The real programs, built with a sanitizer: a bake (by scene.sh), a run on the wall clock with two
# workers and buttons, the thesis's four pictures, a camera that vanishes, and a still.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/../cli/tools/scene.sh"

clean() { # NAME COMMAND...: succeeds, and no sanitizer speaks
	local name=$1
	shift
	if timeout 300 "$@" >"$work/out" 2>&1 && ! grep -qE 'Sanitizer|runtime error' "$work/out"; then
		pass "$name"
	else
		fail "$name" <"$work/out"
	fi
}
if grep -qE 'Sanitizer|runtime error' "$work/bake.log"; then
	fail "bake" <"$work/bake.log"
else
	pass "bake"
fi
run=("$INLAY" run --config "$work/studio.conf" --set screen.driver=null)
real=(--set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real)
printf '0.2 threshold-up\n0.3 view-next\n0.4 object\n0.5 freeze\n0.6 freeze\n' >"$work/presses"

clean "run on the wall clock, with buttons" "${run[@]}" "${real[@]}" --frames 60 \
	--set buttons.driver=script --set "buttons.script.file=$work/presses" --stats "$work/stats"
clean "run on demand, four pictures" "${run[@]}" --frames 20 --set screen.show=quad
clean "a camera that vanishes and comes back" "${run[@]}" "${real[@]}" --frames 60 \
	--set camera.fisheye.sim.vanish_after=10
clean "pictures to files" "$INLAY" run --config "$work/studio.conf" --frames 3 \
	--set "screen.device=$work/p%d.png"
clean "still" "$INLAY" still --config "$work/studio.conf" --basis "$work/box.inlay" \
	--background "$work/p0.png" --fisheye "$work/p1.png" -o "$work/still.png"
clean "info" "$INLAY_BAKE" info "$work/box.inlay"
finish
