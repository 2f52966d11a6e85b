#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay control and the kiosk that it speaks with; several users, in the simulated machine.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
tell() {
	"$INLAY" control --socket "$work/socket" "$@"
}

refused "no command" 2 "no command, expected one like view-next" "$INLAY" control --socket "$work/socket"
refused "a configuration without a socket" 2 "names no socket in [control]" "$INLAY" control --config config/demo.conf status
refused "two values" 2 "expected one command and at most one value" "$INLAY" control a b c
refused "two lines in one" 2 "a command is one line" "$INLAY" control "view-next
quit"
refused "no kiosk" 1 "no kiosk listens at \"$work/socket\"" "$INLAY" control --socket "$work/socket" quit
refused "no configuration" 1 "none.conf: No such file or directory" \
	"$INLAY" control --config "$work/none.conf" quit
refused "a folder that is not there" 1 "No such file or directory" "$INLAY" control \
	--socket "$work/none/socket" quit

timeout 600 "$INLAY" run --config "$work/studio.conf" --set screen.driver=null \
	--set "control.socket=$work/socket" 2>"$work/run.log" &
kiosk=$!
check "a kiosk with a socket answers" until_true tell status
check "by one line of JSON" grep -qxE '\{"version":.*\}' <(tell status)
equal "a command is answered" ok "$(tell threshold-set 40)"
check "and done" grep -q '"threshold":40[,.}]' <(tell status)
equal "a percentage too" ok "$(tell threshold-set 1.5%)"
check "which is said to be one" grep -q '"threshold":1.5,"threshold_unit":"percent"[,}]' <(tell status)
equal "a view is taken by its name" ok "$(tell view fisheye)"
check "and shown" grep -q '"view":"fisheye"' <(tell status)
refused "a view that is none" 1 "no view \"sky\", expected one of composite, before, fisheye" \
	"$INLAY" control --socket "$work/socket" view sky
tell view composite >/dev/null
for turn in off off on on; do
	equal "the object is turned $turn" ok "$(tell object $turn)"
	check "and it is $turn" grep -q "\"object\":$([ $turn = on ] && echo true || echo false)" <(tell status)
done
printf '[control]\nsocket = %s\n[screen]\nwidth = many\n' "$work/socket" >"$work/faulty.conf"
check "a fault elsewhere in the file keeps nobody from the kiosk" \
	"$INLAY" control --config "$work/faulty.conf" status
equal "a step is one of its unit" ok "$(tell threshold-up)"
check "and done" grep -q '"threshold":9.5,"threshold_unit":"percent"[,}]' <(tell status)
refused "a percentage that is none" 1 "or a percentage 0%..100%" tell threshold-set 101%
equal "the socket is its owner's alone" srw------- "$(stat -c %A "$work/socket")"
echo "[control]
socket = socket" >"$work/place.conf"
equal "the configuration names the socket" ok "$("$INLAY" control --config "$work/place.conf" view-next)"
refused "a misspelt command" 1 'unknown action "veiw-next", did you mean "view-next"?' tell veiw-next
refused "a value too many" 1 "view-next takes no value" tell view-next 3
refused "a level that is none" 1 "expected one number 0..255" tell threshold-set 300
refused "a second kiosk there" 1 "another kiosk listens" "$INLAY" run --config "$work/studio.conf" \
	--set screen.driver=null --set "control.socket=$work/socket"
refused "another file there" 1 "is there and no socket" "$INLAY" run --config "$work/studio.conf" \
	--set screen.driver=null --frames 1 --set "control.socket=$work/studio.conf"
refused "a name that no socket can have" 1 "is too long for a socket" "$INLAY" run \
	--config "$work/studio.conf" --set screen.driver=null --frames 1 \
	--set "control.socket=$work/$(printf '%0200d' 0)"
# ---- what the screen shows ----
check "a picture of the screen" tell snapshot "$work/shown.png"
equal "in the screen's size" "48 x 32" "$(file "$work/shown.png" | grep -o '[0-9]* x [0-9]*')"
refused "a picture that is there already" 1 "shown.png: is there already, expected another name" \
	tell snapshot "$work/shown.png"
check "unless it may be replaced" tell --force snapshot "$work/shown.png"
tell snapshot - >"$work/streamed.png"
equal "to standard output it is a picture alone" "48 x 32" "$(file "$work/streamed.png" | grep -o '[0-9]* x [0-9]*')"
refused "which has to take it" 1 "cannot write to standard output" sh -c '"$0" control --socket "$1" snapshot - >/dev/full' "$INLAY" "$work/socket"
two_of_one_name() {
	local first=0 second=0
	tell snapshot "$work/one.png" >"$work/a.out" 2>&1 &
	tell snapshot "$work/one.png" >"$work/b.out" 2>&1 || second=1
	wait $! || first=1
	[ $((first + second)) = "$(cat "$work/a.out" "$work/b.out" | grep -cE "is there already|File exists")" ] &&
		[ "$(cat "$work/a.out" "$work/b.out" | grep -c "48x32")" = 1 ]
}
check "of two that write one name one says so" two_of_one_name
refused "a picture without a name" 2 "expected the name of the picture's file" tell snapshot
refused "a kind that is not written" 1 "shown.jpg: expected a name that ends in .png" tell snapshot "$work/shown.jpg"
refused "no such folder" 1 "none/shown.png: cannot be written: No such file" tell snapshot "$work/none/shown.png"
refused "a folder of the kernel's" 1 "/proc/shown.png: cannot be written" tell snapshot /proc/shown.png
absent "nothing else is left" "$work/shown.jpg"

equal "quit is answered" ok "$(tell quit)"
wait $kiosk
equal "and done" 0 $?
check "the socket is removed" test ! -e "$work/socket"

# Each camera has given a picture: one that has none yet takes its first even when the screen is frozen.
all_seen() {
	tell status | sed 's/.*"cameras"//' >"$work/cameras" && grep -q '"frames":' "$work/cameras" &&
		! grep -q '"frames":0,' "$work/cameras"
}
# The last picture of a run is in a file, and a frozen one stays: both are the same, in each view.
for view in composite quad; do
	rm -f "$work/shown.png"
	"$INLAY" run --config "$work/studio.conf" --set "screen.device=$work/screen.png" --set "screen.show=$view" \
		--set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real \
		--set "control.socket=$work/socket" 2>"$work/run.log" &
	kiosk=$!
	check "both cameras are seen: $view" until_true all_seen
	tell freeze on >/dev/null
	check "a picture of a frozen screen: $view" tell snapshot "$work/shown.png"
	tell quit >/dev/null
	wait $kiosk
	same "is what a file shows: $view" "$work/shown.png" "$work/screen.png"
done
"$INLAY" run --config "$work/studio.conf" --set screen.driver=kms --set screen.device=/dev/dri/none \
	--set "control.socket=$work/socket" 2>"$work/run.log" &
kiosk=$!
check "a kiosk without a screen" until_true tell status
refused "says so" 1 "control: the kiosk has no screen: " tell snapshot "$work/none.png"
absent "and there is no picture" "$work/none.png"
tell quit >/dev/null
wait $kiosk

finish
