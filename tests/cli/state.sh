#!/bin/bash
# SPDX-License-Identifier: MIT
# Choices made with the buttons survive a power cut at any moment.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
state=$work/kept/state
mkdir "$work/kept"
keep=(--set "state.file=$state" --set state.interval=0)
press=(--set buttons.driver=script --set "buttons.script.file=$work/presses")
run() {
	timeout 60 "$INLAY" run --config "$work/studio.conf" --set screen.driver=null \
		--stats "$work/run.jsonl" "$@" 2>"$work/run.log"
}

# ---- over an end in order ----
printf '0.1 threshold-set 40\n0.2 view-next\n0.3 quit\n' >"$work/presses"
check "buttons choose" run "${keep[@]}" "${press[@]}" --set state.interval=3600
check "the threshold is kept" grep -qx 'threshold = 40' "$state"
check "so is the view" grep -qx 'view = before' "$state"
check "the next run" run "${keep[@]}" --frames 3
equal "begins with it" 40 "$(number "$work/run.jsonl" threshold)"
check "over what the configuration says" run "${keep[@]}" --frames 3 --set lights.threshold=7
equal "which does not count" 40 "$(number "$work/run.jsonl" threshold)"
printf '0.1 threshold-set 2.5%%\n0.3 quit\n' >"$work/presses"
check "a percentage is chosen" run "${keep[@]}" "${press[@]}"
check "and kept as one" grep -qx 'threshold = 2.5%' "$state"
check "the next start" run "${keep[@]}" --frames 3
check "begins with it" grep -q '"threshold":2.5,"threshold_unit":"percent"' "$work/run.jsonl"

# ---- over a power cut, wherever it falls ----
for i in $(seq 400); do echo "0.$(printf %03d "$i") threshold-set $((i % 256))"; done >"$work/presses"
whole=0
for i in $(seq 20); do
	rm -f "$state"
	start "${keep[@]}" "${press[@]}"
	until_true 20 test -e "$state"
	sleep "0.0$((RANDOM % 10))$((RANDOM % 10))"
	kill -KILL "$inlay"
	wait "$inlay" 2>/dev/null
	run "${keep[@]}" --frames 1 && ! grep -q 'state:' "$work/run.log" &&
		grep -qE '^threshold = [0-9]+$' "$state" && whole=$((whole + 1))
done
inlay=
equal "killed 20 times while it writes, the file is whole" 20 $whole

# ---- files that are wrong ----
printf '[chosen]\nthreshold = 40\nview = sideways\n' >"$state"
check "a damaged file is no reason not to start" run "${keep[@]}" --frames 2
check "it is named with its line" says "$work/run.log" "$state:3: [chosen] view"
equal "and ignored whole" 0 "$(number "$work/run.jsonl" threshold)"
printf '[chosen]\nthreshold = 41\npose = 5\n' >"$state"
check "nor is a pose that is no more" run "${keep[@]}" --frames 2
check "which is said" says "$work/run.log" "pose is 5, expected 0..0"
equal "what else is kept counts" 41 "$(number "$work/run.jsonl" threshold)"
printf '[chosen]\nview = scene\n' >"$state"
check "nor a view that has no camera" run "${keep[@]}" --frames 2
check "which is said too" says "$work/run.log" "view is scene, but no camera"

rm "$state"
mkfifo "$state"
check "nor is a pipe, that nobody would write to" run "${keep[@]}" --frames 2
check "it is named" says "$work/run.log" "$state: not a regular file but a named pipe"
rm "$state"

# ---- folders that are wrong ----
rm -rf "$work/kept"
printf '0.1 threshold-set 50\n0.3 threshold-set 51\n' >"$work/presses"
check "a missing folder is no reason not to start" run "${keep[@]}" --frames 1
check "it is said, before anything is chosen" says "$work/run.log" "what is chosen cannot be kept"
start "${keep[@]}" "${press[@]}"
check "a missing folder is said" until_true 20 says "$work/run.log" "state: $state: cannot be written"
check "the kiosk goes on" until_true 20 has threshold 51
until_true 20 test "$(grep -c . "$work/live.jsonl")" -gt 3
equal "it is said at the start, and once when it is tried" 2 "$(said "$work/run.log" "cannot be written")"
mkdir "$work/kept"
check "when there is one the file is written" until_true 20 grep -qsx 'threshold = 51' "$state"
check "which is said" until_true 20 says "$work/run.log" "is written again"
stop
equal "it ends in order" 0 $?
finish
