#!/bin/bash
# SPDX-License-Identifier: MIT
# The KMS driver on vkms and virtio-gpu: modes, flips, what is really scanned out, busy and missing
# screens, and the console's picture given back as it was.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

said() {
	awk -v name="$1" '$1 == name { sub(/^[^ ]* /, ""); print; exit }' "$VM_OUT/said"
}

# show FRAMES name=value...: a picture stays on the screen until hide.
show() {
	local frames=$1
	shift
	: >"$VM_OUT/said"
	"$tools/show" kms "$VM_OUT/chart.png" "$frames" "$@" >"$VM_OUT/said" 2>&1 &
	showing=$!
	within_seconds 40 grep -q -E '^(ready|error)' "$VM_OUT/said"
}

hide() {
	kill $showing 2>/dev/null
	wait $showing
}

"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
load vkms
vkms=$(card_of vkms)
virtio=$(card_of virtio)

# ---- vkms: read back from the kernel, and held against the device's own checksum ----
show 20 "device=/dev/dri/card$vkms"
equal "vkms: all flips come back" 20 "$(said shown)"
equal "vkms: in order, time rising" "0 0" "$(said out_of_order) $(said backwards)"
equal "vkms: the preferred mode is set" 1024x768 "$(said mode)"
holds "vkms: flips keep to the refresh" "$(said measured_rate) < $(said rate) * 1.05"
check "vkms: its picture can be read back" \
	"$tools/scanout" picture "$vkms" "$VM_OUT/vkms.png"
check "vkms: it is what was drawn, pixel by pixel" \
	"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/vkms.png" x=192 y=144
check "vkms: the device puts out exactly that (checksum)" "$tools/scanout" checksum "$vkms"
hide
equal "vkms: closes well" 0 $?

show 5 "device=/dev/dri/card$vkms" width=1280 height=720
equal "vkms: a mode that is asked for is set" 1280x720 "$(said mode)"
hide
equal "vkms: closes well after another mode" 0 $?
show 1 "device=/dev/dri/card$vkms" width=1234 height=777
matches "vkms: a mode that there is not is an error that names it" 1234 "$(said error)"

# ---- vkms: whoever had it before has left a cursor ----
planes() { # what they show
	awk '/^plane/ { name = $2 } /^\t(crtc|fb)=/ { print name, $1 }' \
		"/sys/kernel/debug/dri/$vkms/state"
}
"$tools/scanout" leave "$vkms" >"$VM_OUT/left" 2>&1 &
leaving=$!
check "vkms: a program leaves a cursor" within_seconds 10 grep -q '^left' "$VM_OUT/left"
left=$(planes)
show 3 "device=/dev/dri/card$vkms"
check "vkms: it does not lie on the picture (checksum)" "$tools/scanout" checksum "$vkms"
hide
equal "vkms: and is back after that" "$left" "$(planes)"
kill $leaving
wait $leaving 2>/dev/null

# ---- virtio-gpu: photographed from outside; it holds the text console ----
echo 0 >/sys/class/graphics/fbcon/cursor_blink
printf '\033[2J\033[Hthe console before\n' >/dev/tty1
settled() { # two photographs in a row are the same
	screendump "$1" && screendump "$1.again.ppm" && cmp "$1" "$1.again.ppm"
}
within_seconds 5 settled "$VM_OUT/before.ppm"
show 20 "device=/dev/dri/card$virtio"
equal "virtio-gpu: all flips come back" 20 "$(said shown)"
equal "virtio-gpu: the preferred mode is set" 1280x800 "$(said mode)"
check "virtio-gpu: can be photographed" screendump "$VM_OUT/virtio.ppm"
check "virtio-gpu: it shows what was drawn, pixel by pixel" \
	"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/virtio.ppm" x=320 y=160

hide
: >"$VM_OUT/said"
# By name and path, because LD_PRELOAD ends at a blank.
env "ALLOCATIONS=$VM_OUT/allocations" "LD_LIBRARY_PATH=$BUILD/tests/cli/tools" LD_PRELOAD=allocations.so \
	"$tools/show" kms "$VM_OUT/chart.png" 300 "device=/dev/dri/card$virtio" >"$VM_OUT/said" 2>&1 &
showing=$!
within_seconds 60 grep -q '^ready' "$VM_OUT/said"
hide
matches "memory is allocated before the first frames alone" 'before [1-9][0-9]* after 0 turns [1-9]' \
	"$(cat "$VM_OUT/allocations")"

# ---- busy ----
show 3 "device=/dev/dri/card$virtio"
"$tools/show" kms "$VM_OUT/chart.png" 1 "device=/dev/dri/card$virtio" >"$VM_OUT/second" 2>&1
equal "a screen that another program drives is refused" 1 $?
equal "in one line" 1 "$(wc -l <"$VM_OUT/second")"
matches "that names the card" "card$virtio" "$(cat "$VM_OUT/second")"
matches "and who holds it" "show \(pid $showing\)" "$(cat "$VM_OUT/second")"
check "and the first program's picture stays" screendump "$VM_OUT/virtio.ppm"
check "unchanged" "$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/virtio.ppm" x=320 y=160

hide
equal "virtio-gpu: closes well" 0 $?
given_back() {
	screendump "$VM_OUT/after.ppm" && cmp "$VM_OUT/before.ppm" "$VM_OUT/after.ppm"
}
check "the console's picture is given back, pixel by pixel" within_seconds 5 given_back

# ---- killed without a chance to clean up: the next one must still work ----
show 3 "device=/dev/dri/card$virtio"
kill -KILL $showing
wait $showing 2>/dev/null
show 3 "device=/dev/dri/card$virtio"
equal "after a killed program the screen can be used again" 1 "$(said ready)"
hide

# ---- no screen ----
for status in /sys/class/drm/card*-*/status; do
	echo off >"$status"
done
show 1
matches "no connected screen is an error in words" '[Nn]o .*(screen|connected)' "$(said error)"
wait $showing

# ---- a screen that is plugged in later, pulled out, and back ----
# saw COUNT REGEX: so many lines of it, sooner or later.
saw_by_now() {
	[ "$(grep -c -E "$2" "$VM_OUT/said")" -ge "$1" ]
}
saw() {
	within_seconds 20 saw_by_now "$@"
}
plug() { # card number; off, on or detect
	local status
	for status in "/sys/class/drm/card$1"-*/status; do
		echo "$2" >"$status"
	done
}
for card in "$vkms" "$virtio"; do
	: >"$VM_OUT/said"
	"$tools/show" kms "$VM_OUT/chart.png" 3 patient "device=/dev/dri/card$card" \
		>"$VM_OUT/said" 2>&1 &
	showing=$!
	check "card$card: a screen that is absent at the start is waited for" \
		saw 1 '^waiting no screen: .*connected'
	plug "$card" detect
	check "card$card: and used when it is plugged in" saw 1 '^ready'
	for round in 1 2; do
		plug "$card" off
		check "card$card: pulled out, it is missed ($round)" \
			saw $round '^lost no screen: .*unplugged'
		plug "$card" detect
		check "card$card: and used again when it is back ($round)" saw $((round + 1)) '^ready'
	done
	check "card$card: its picture can be read back" \
		"$tools/scanout" picture "$card" "$VM_OUT/back.png"
	x=192 y=144
	[ "$card" = "$vkms" ] || x=320 y=160
	check "card$card: and is what was drawn" \
		"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/back.png" x=$x y=$y
	# The kernel says so when something about a card changes; most of it changes nothing.
	for _ in 1 2 3; do
		echo change >"/sys/class/drm/card$card/uevent"
	done
	plug "$card" off
	echo change >"/sys/class/drm/card$card/uevent"
	check "card$card: a message of the kernel is heeded" saw 3 '^lost no screen'
	equal "card$card: and those before it have changed nothing" 3 "$(grep -c '^ready' "$VM_OUT/said")"
	plug "$card" detect
	saw 4 '^ready'
	hide
	equal "card$card: it closes well after all this" 0 $?
done

# ---- another screen while it is used (QEMU's window is resized: a true hotplug event) ----
: >"$VM_OUT/said"
"$tools/show" kms "$VM_OUT/chart.png" 3 patient "device=/dev/dri/card$virtio" >"$VM_OUT/said" 2>&1 &
showing=$!
saw 1 '^ready'
shown_on=1
for size in 1024x768 1600x900; do
	resize_window ${size%x*} ${size#*x}
	check "another screen is noticed and its mode set ($size)" saw 1 "^mode $size"
	check "and drawn on" saw $((++shown_on)) '^ready'
done
matches "the reason is said" '^lost .*other modes' "$(cat "$VM_OUT/said")"
check "it shows what was drawn, pixel by pixel" screendump "$VM_OUT/virtio.ppm"
check "in the middle of it" \
	"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/virtio.ppm" x=480 y=210
resize_window 0 0
check "pulled out in earnest, it is missed" saw 1 '^lost no screen: .*unplugged'
resize_window 1280 800
check "and used again when it is back" saw 2 '^mode 1280x800'
saw 4 '^ready'
hide
equal "it closes well then" 0 $?

# ---- forced, and told a mode ----
plug "$vkms" off
show 3 "device=/dev/dri/card$vkms" mode=800x600
matches "a mode alone does not light a connector without a screen" 'no screen' "$(said error)"
wait $showing
show 3 "device=/dev/dri/card$vkms" force=yes
equal "forced, it is used" "1 1024x768" "$(said ready) $(said mode)"
matches "and that the timing is ours is said" 'has not named' "$(cat "$VM_OUT/said")"
hide
show 3 "device=/dev/dri/card$vkms" force=yes mode=1400x1050@60
equal "forced, with the mode that is told" "1 1400x1050" "$(said ready) $(said mode)"
check "the device puts out exactly that" "$tools/scanout" checksum "$vkms"
hide
plug "$vkms" detect
show 3 "device=/dev/dri/card$vkms" "mode=40 800 840 968 1056 600 601 605 628 +hsync +vsync"
equal "a modeline is taken to the letter" "1 800x600 60.3165" \
	"$(said ready) $(said mode) $(said rate)"
hide
show 3 "device=/dev/dri/card$vkms" mode=large
matches "a mode that is none is an error that says what is expected" '1920x1080@60' "$(said error)"
wait $showing

# ---- names that are none ----
"$tools/show" kms "$VM_OUT/chart.png" 1 device=/dev/dri/card9 >"$VM_OUT/said" 2>&1
matches "a card that is not there is an error that names it" card9 "$(said error)"
"$tools/show" kms "$VM_OUT/chart.png" 1 device=/dev/null >"$VM_OUT/said" 2>&1
matches "a file that is no screen is an error that names it" /dev/null "$(said error)"
show 3 connector=Virtual-77
matches "a connector that there is not is an error that names it" Virtual-77 "$(said error)"
wait $showing

# ---- stopped by hand for a while: not a stall ----
# (The time that it is stopped for is what is tested: twice what a flip may take.)
: >"$VM_OUT/said"
"$tools/show" kms "$VM_OUT/chart.png" 200 patient "device=/dev/dri/card$vkms" >"$VM_OUT/said" 2>&1 &
showing=$!
saw 1 '^mode'
kill -STOP $showing
sleep 2
kill -CONT $showing
check "a program that was stopped for 2 s goes on" saw 1 '^ready'
equal "and has not lost the screen" 0 "$(grep -c '^lost' "$VM_OUT/said")"
hide
equal "and closes well" 0 $?
unload vkms
