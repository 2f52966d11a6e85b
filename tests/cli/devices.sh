#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay devices and inlay devices --sample: a newcomer's first steps, with whatever this machine has
# plugged in (tests/vm does the same with simulated devices).
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

"$INLAY" devices >"$work/listed" 2>"$work/said"
equal "devices lists" 0 $?
for title in cameras screens buttons drivers; do
	check "it has a list of $title" grep -q "^$title\$" "$work/listed"
done
check "drivers are named with what they are for" grep -q '^  camera  *v4l2  *Video4Linux' \
	"$work/listed"
check "help leads to a first configuration" \
	grep -q 'inlay devices --sample > kiosk.conf' <("$INLAY" devices --help)

# Every key of the sample is valid; only the basis is missing.
"$INLAY" devices --sample >"$work/kiosk.conf" 2>"$work/said"
equal "a sample is written" 0 $?
equal "without a word beside it" "" "$(cat "$work/said")"
"$INLAY" check --config "$work/kiosk.conf" >"$work/out" 2>"$work/said"
equal "it lacks only the basis" "" "$(grep -v 'object.inlay' "$work/said")"
check "which check says" grep -q '\[basis\] file: .*object.inlay' "$work/said"
"$INLAY" check --config "$work/kiosk.conf" --set "basis.file=$work/box.inlay" >"$work/out" 2>&1
equal "with a basis it is a configuration" "configuration is fine" "$(cat "$work/out")"
"$INLAY" run --config "$work/kiosk.conf" --print-config >"$work/whole" 2>&1
check "both views have a camera" test "$(grep -c '^camera = camera[12]$' "$work/whole")" = 2
check "a misspelt key would have been found" \
	bash -c 'sed "s/^centre =/center =/" "$0/kiosk.conf" >"$0/wrong.conf" &&
		! "$1" check --config "$0/wrong.conf" --set "basis.file=$0/box.inlay" 2>/dev/null' \
	"$work" "$INLAY"

refused "both forms at once" 2 "expected one of them" "$INLAY" devices --json --sample
refused "what it does not know" 2 "colour" "$INLAY" devices --colour

finish
