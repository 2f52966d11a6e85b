#!/bin/bash
# SPDX-License-Identifier: MIT
# What is measured in time: whether frames are on the screen when they are due, what a kiosk thinks of cameras that
# stood still. It runs in a simulated machine (tests/vm/uml.sh),
# whose time stands still while a program computes: figures are the same on every host, however busy.
set -u
if [ -z "${VM_KERNEL:-}" ]; then # set in the machine
	cd "$(dirname "$0")/../.." || exit 1
	job=$(mktemp -d "${TMPDIR:-/tmp}/inlay-pace.XXXXXX")
	trap 'rm -rf "$job"' EXIT
	tests/vm/uml.sh "$job" tests/cli/pace.sh
	code=$?
	cat "$job/console.log"
	exit $code
fi
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

# ---- in health: a frame is on the screen within a frame's time and the work on it ----
start
check "it shows frames" until_true has_lines 5
equal "every one of them, whole seconds long" "25.00 25.00 25.00" \
	"$(grep -oE '"fps":[0-9.]*' "$work/live.jsonl" | cut -d: -f2 | sed -n 2,4p | xargs)"
equal "none is late" 0 "$(grep -cv '"late":0,' "$work/live.jsonl")"
check "a kiosk that held each frame for one too long would be seen" awk -v ms="$(grep -oE '"latency_ms":{"mean":[0-9.]*' \
	"$work/live.jsonl" | tail -n 1 | cut -d: -f3)" 'BEGIN { exit !(ms > 0 && ms < 20) }'
tail -n 1 "$work/live.jsonl" | grep -oE '"latency_ms":{[^}]*}' | sed 's/^/# /'

# ---- it stands still for ten seconds ----
kill -USR1 "$inlay"
kill -USR2 "$inlay"
check "signals that mean nothing to it do nothing" frames_go_on
kill -STOP "$inlay"
sleep 10
kill -CONT "$inlay"
check "stopped for ten seconds, it goes on" frames_go_on
check "for seconds" until_true has_lines $(($(grep -c . "$work/live.jsonl") + 2))
equal "no camera is blamed" 0 "$(said "$work/run.log" "camera")"
stop
equal "it ends in order" 0 $?

finish
