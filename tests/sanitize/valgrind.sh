#!/bin/bash
# SPDX-License-Identifier: MIT
# The release build under valgrind: no leak, no bad access, in a run, a still and a bake.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/../cli/tools/scene.sh"

clean() { # NAME COMMAND...
	local name=$1
	shift
	if valgrind --quiet --leak-check=full --errors-for-leak-kinds=definite,possible \
		--show-leak-kinds=definite,possible --suppressions=tests/sanitize/valgrind.supp \
		--error-exitcode=9 "$@" >"$work/out" 2>&1; then
		pass "$name"
	else
		fail "$name" < <(head -n 60 "$work/out")
	fi
}
clean "run" "$INLAY" run --config "$work/studio.conf" --set screen.driver=null --frames 10 \
	--set screen.show=quad
clean "run to files" "$INLAY" run --config "$work/studio.conf" --frames 2 \
	--set "screen.device=$work/p%d.png"
clean "still" "$INLAY" still --basis "$work/box.inlay" --background "$work/p0.png" \
	--fisheye "$work/p0.png" -o "$work/still.png"
clean "check" "$INLAY" check --config "$work/studio.conf"
clean "render" "$INLAY_BAKE" render "$work/box.scene" -o "$work/again.inlay" --samples 1 --quiet
clean "info" "$INLAY_BAKE" info "$work/box.inlay"
finish
