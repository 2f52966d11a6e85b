#!/bin/bash
# SPDX-License-Identifier: MIT
# The KMS driver on vkms: modes, flips, what is really scanned out, busy, missing and forced screens.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/screen.sh

"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
load vkms
vkms=$(card_of vkms)

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

# ---- memory ----
: >"$VM_OUT/said"
# By name and path, because LD_PRELOAD ends at a blank.
env "ALLOCATIONS=$VM_OUT/allocations" "LD_LIBRARY_PATH=$BUILD/tests/cli/tools" LD_PRELOAD=allocations.so \
	"$tools/show" kms "$VM_OUT/chart.png" 300 "device=/dev/dri/card$vkms" >"$VM_OUT/said" 2>&1 &
showing=$!
eventually grep -q '^ready' "$VM_OUT/said"
hide
matches "memory is allocated before the first frames alone" 'before [1-9][0-9]* after 0 turns [1-9]' \
	"$(cat "$VM_OUT/allocations")"

# ---- vkms: whoever had it before has left a cursor ----
planes() { # what they show
	awk '/^plane/ { name = $2 } /^\t(crtc|fb)=/ { print name, $1 }' \
		"/sys/kernel/debug/dri/$vkms/state"
}
"$tools/scanout" leave "$vkms" >"$VM_OUT/left" 2>&1 &
leaving=$!
check "vkms: a program leaves a cursor" eventually grep -q '^left' "$VM_OUT/left"
left=$(planes)
show 3 "device=/dev/dri/card$vkms"
check "vkms: it does not lie on the picture (checksum)" "$tools/scanout" checksum "$vkms"
hide
equal "vkms: and is back after that" "$left" "$(planes)"
kill $leaving
wait $leaving 2>/dev/null

# ---- busy ----
show 3 "device=/dev/dri/card$vkms"
"$tools/show" kms "$VM_OUT/chart.png" 1 "device=/dev/dri/card$vkms" >"$VM_OUT/second" 2>&1
equal "a screen that another program drives is refused" 1 $?
equal "in one line" 1 "$(wc -l <"$VM_OUT/second")"
matches "that names the card" "card$vkms" "$(cat "$VM_OUT/second")"
matches "and says how to see who holds it" "fuser -v" "$(cat "$VM_OUT/second")"
check "and the first program's picture stays" "$tools/scanout" checksum "$vkms"
hide

# ---- no screen ----
for status in /sys/class/drm/card*-*/status; do
	echo off >"$status"
done
show 1
matches "no connected screen is an error in words" '[Nn]o .*(screen|connected)' "$(said error)"
wait $showing

comes_and_goes "$vkms" 192 144

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
