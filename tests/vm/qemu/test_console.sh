#!/bin/bash
# SPDX-License-Identifier: MIT
# The screen and the text consoles on it (virtio-gpu, photographed from outside): what a person sees
# who switches away and back, and after the program has ended in whatever way.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

card=/dev/dri/card$(card_of virtio)
said=$VM_OUT/said

# show name=value...: the chart is on the screen, or whatever the program says instead.
show() {
	"$tools/show" kms "$VM_OUT/chart.png" 3 "device=$card" "$@" >"$said" 2>&1 &
	showing=$!
	eventually grep -q -E '^(ready|error|waiting)' "$said"
}

hide() {
	kill "-${1:-TERM}" $showing
	wait $showing 2>/dev/null
}

# says DESCRIPTION REGEX: sooner or later.
says() {
	if eventually grep -q -E "$2" "$said"; then
		ok "$1"
	else
		not_ok "$1" <"$said"
	fi
}

settled() { # two photographs in a row are the same
	screendump "$1" && screendump "$1.again.ppm" && cmp "$1" "$1.again.ppm"
}

console_is() { # photograph
	screendump "$VM_OUT/now.ppm" && cmp "$1" "$VM_OUT/now.ppm"
}

chart_is() {
	screendump "$VM_OUT/now.ppm" &&
		"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/now.ppm" x=320 y=160
}

chvt() {
	timeout 20 busybox chvt "$1"
}

"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
echo 0 >/sys/class/graphics/fbcon/cursor_blink
printf '\033[2J\033[Hthe second console\n' >/dev/tty2
printf '\033[2J\033[Hthe first console\n' >/dev/tty1
chvt 2
eventually settled "$VM_OUT/second.ppm"
chvt 1
eventually settled "$VM_OUT/first.ppm"
differ() {
	! cmp -s "$1" "$2"
}
check "the two consoles look different" differ "$VM_OUT/first.ppm" "$VM_OUT/second.ppm"

# ---- away and back ----
show vt=/dev/tty1
check "on its console it shows its picture" eventually chart_is
check "another console can be switched to" chvt 2
says "the program knows" '^hidden 1'
check "and that console shows its own text" eventually console_is "$VM_OUT/second.ppm"
check "the first console can be switched back to" chvt 1
says "the program knows that too" '^exposed 1'
says "and is no longer hidden" '^hidden 0'
check "and its picture is back, pixel by pixel" eventually chart_is
chvt 2 && chvt 1 && chvt 2 && chvt 1
check "as after switching in haste" eventually chart_is
hide
equal "it closes well" 0 $?
check "the console's own text is back" eventually console_is "$VM_OUT/first.ppm"
check "consoles switch freely then" chvt 2
check "the second shows its text" eventually console_is "$VM_OUT/second.ppm"

# ---- started on another console, ended on another console ----
show vt=/dev/tty1
check "started while another console is shown, it comes to the front" eventually chart_is
chvt 2
eventually grep -q '^hidden 1' "$said"
hide
equal "ended while hidden, it closes well" 0 $?
check "the console that is shown stays" eventually console_is "$VM_OUT/second.ppm"
chvt 1
check "its own console is one of text again" eventually console_is "$VM_OUT/first.ppm"

show vt=auto
check "auto takes the console that is shown" eventually chart_is
chvt 2
says "as a switch shows" '^hidden 1'
chvt 1
eventually chart_is

# ---- a second one, and what cannot be taken ----
"$tools/show" kms "$VM_OUT/chart.png" 1 "device=$card" vt=/dev/tty2 >"$VM_OUT/second" 2>&1
equal "a second program is refused" 1 $?
matches "in words that say how to see who holds it" "fuser -v" \
	"$(cat "$VM_OUT/second")"
chvt 2
check "and has not touched the console that it was to take" \
	eventually console_is "$VM_OUT/second.ppm"
chvt 1
check "nor the picture" eventually chart_is
hide
check "text is back after that" eventually console_is "$VM_OUT/first.ppm"

show vt=/dev/null
says "what is no console is said" 'console /dev/null: .*going on without'
check "and the picture shown all the same" eventually chart_is
hide
check "text is back after that too" eventually console_is "$VM_OUT/first.ppm"

# ---- without privileges ----
as_nobody=(setpriv --reuid=65534 --regid=65534 --clear-groups)
chmod 666 "$card"
"${as_nobody[@]}" "$tools/show" kms "$VM_OUT/chart.png" 3 "device=$card" vt=/dev/tty1 \
	>"$said" 2>&1 &
showing=$!
says "somebody who may not take the console is told so" 'console /dev/tty1: Permission denied'
says "and goes on" '^ready'
check "with the picture" eventually chart_is
"${as_nobody[@]}" "$tools/show" kms "$VM_OUT/chart.png" 1 "device=$card" >"$VM_OUT/second" 2>&1
matches "a second one without privileges is told that another holds the screen" "fuser -v $card" \
	"$(cat "$VM_OUT/second")"
hide
check "text is back then" eventually console_is "$VM_OUT/first.ppm"
chgrp tty "$card" && chmod 660 "$card"
"${as_nobody[@]}" "$tools/show" kms "$VM_OUT/chart.png" 1 "device=$card" >"$VM_OUT/second" 2>&1
matches "a card that may not be opened is named, and its group" "$card: .*group \"tty\"" \
	"$(cat "$VM_OUT/second")"

# ---- killed ----
show
eventually chart_is
hide KILL
check "a killed program leaves the console's text" eventually console_is "$VM_OUT/first.ppm"
show vt=/dev/tty1
eventually chart_is
hide KILL
check "so does one that had taken the console" eventually console_is "$VM_OUT/first.ppm"
check "it can be left for another" chvt 2
check "that shows its text" eventually console_is "$VM_OUT/second.ppm"
chvt 1
check "as the first does again" eventually console_is "$VM_OUT/first.ppm"
printf 'and a line more\n' >/dev/tty1
console_is_not() {
	screendump "$VM_OUT/now.ppm" && differ "$1" "$VM_OUT/now.ppm"
}
check "and new text" eventually console_is_not "$VM_OUT/first.ppm"
printf '\033[2J\033[Hthe first console\n' >/dev/tty1
show vt=/dev/tty1
check "the next program can take it" eventually chart_is
hide
check "and give it back" eventually console_is "$VM_OUT/first.ppm"
