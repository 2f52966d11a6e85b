#!/bin/bash
# SPDX-License-Identifier: MIT
# What a service manager hears: ready, alive, reloading, stopping; and when it hears nothing.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
heard=$work/heard
"$INLAY" --version >/dev/null
if ! ldd "$INLAY" | grep -q libsystemd; then
	pass "# SKIP built without libsystemd"
	finish
fi
python3 "$(dirname "$0")/tools/manager.py" "$work/notify" >"$heard" &
manager=$!
trap 'kill $manager; rm -rf "$work"' EXIT
until_true test -S "$work/notify"

# serve MICROSECONDS OPTIONS...: inlay run under a watchdog.
serve() {
	local watchdog=$1
	shift
	: >"$heard"
	export NOTIFY_SOCKET=$work/notify WATCHDOG_USEC=$watchdog
	start "$@"
	unset NOTIFY_SOCKET WATCHDOG_USEC
}
hears() {
	grep -q -- "$1" "$heard"
}
feeds() { # at least so many
	[ "$(grep -c WATCHDOG=1 "$heard")" -ge "$1" ]
}
order() {
	sed 's/^[0-9.]* //' "$heard" | grep -oE "$1" | uniq | tr '\n' ' '
}

# ---- a run in order ----
serve 2000000
check "ready when a picture is on the screen" until_true hears READY=1
check "the watchdog is fed" until_true feeds 3
check "what it does is told" until_true hears "STATUS=showing"
kill -HUP "$inlay"
check "reloading is told, with its time" until_true hears "RELOADING=1 MONOTONIC_USEC=[0-9]"
reloaded() {
	[ "$(order 'READY=1|RELOADING=1')" = "READY=1 RELOADING=1 READY=1 " ]
}
check "and its end" until_true reloaded
stop
equal "it stops" 0 $?
check "which is told" until_true hears STOPPING=1

# ---- slow but alive ----
serve 8000000 --set screen.rate=1
check "a picture a second feeds it" until_true feeds 2
stop
serve 2000000 --set camera.background.sim.stall_after=10 --set camera.fisheye.sim.stall_after=10
check "cameras that stall: the picture is drawn again" until_true feeds 8
check "and they are named" until_true hears "STATUS=.*camera"
check "it was a stall" says "$work/run.log" "stalled"
stop
serve 2000000 --set camera.background.driver=v4l2 --set camera.background.device=/dev/video250 \
	--set camera.fisheye.driver=v4l2 --set camera.fisheye.device=/dev/video251
check "no camera at all: ready all the same" until_true hears READY=1
check "and fed" until_true feeds 5
stop

# ---- at rest: its hours begin three hours later ----
serve 2000000 --set "screen.hours=$(date -u -d '+3 hours' +%H:%M)-$(date -u -d '+4 hours' +%H:%M)" \
	--set screen.time_zone=UTC0
check "at rest it is ready" until_true hears READY=1
check "which is told" until_true hears "STATUS=at rest"
check "and fed, without a picture" until_true feeds 5
check "there is none" has frames 0
stop

# ---- frozen: flips that do not come, a loop that does not turn ----
serve 800000 --set screen.rate=0.001
check "flips that never come: it turns" until_true has_lines 4
check "flips that never come do not feed it" test "$(grep -c WATCHDOG=1 "$heard")" = 0
check "nor is it ready" test "$(grep -c READY=1 "$heard")" = 0
kill -KILL "$inlay"
wait "$inlay" 2>/dev/null
serve 800000
until_true feeds 3
kill -STOP "$inlay"
until_true grep -q '^State:	T' "/proc/$inlay/status"
# What it has sent before is heard by the time that a word of ours is.
python3 -c 'import socket, sys
socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM).sendto(b"MARK=1", sys.argv[1])' "$work/notify"
until_true hears MARK=1
before=$(grep -c WATCHDOG=1 "$heard")
sleep 1.5
equal "a loop that stands still does not feed it" "$before" "$(grep -c WATCHDOG=1 "$heard")"
kill -CONT "$inlay"
check "it goes on when the loop does" until_true feeds $((before + 2))
stop

# ---- no screen: waiting is right ----
if "$INLAY" devices 2>/dev/null | grep -q kms && [ ! -e /dev/dri/card0 ]; then
	serve 2000000 --set screen.driver=kms
	check "no screen: ready all the same" until_true hears READY=1
	check "fed while it waits" until_true feeds 3
	check "what it waits for is told" hears "STATUS=.*"
	equal "and said once" 1 "$(said "$work/run.log" "screen:")"
	stop
	equal "it stops" 0 $?
fi
finish
