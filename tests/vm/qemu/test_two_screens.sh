#!/bin/bash
# SPDX-License-Identifier: MIT
# Two screens of one card that show one picture (virtio-gpu, photographed from outside). It has no second screen, so
# the kernel is told that there is one; it does not scale, and its screens have 1024x768 in common.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

said() {
	awk -v name="$1" '$1 == name { sub(/^[^ ]* /, ""); print; exit }' "$VM_OUT/said"
}

# begin FRAMES name=value...: a picture stays on the screens until hide.
begin() {
	"$tools/show" kms "$VM_OUT/chart.png" "$@" "device=/dev/dri/card$virtio" connector=Virtual-1 \
		second=Virtual-2 >"$VM_OUT/said" 2>&1 &
	showing=$!
}

# show FRAMES name=value...: and waits until they are shown.
show() {
	begin "$@"
	eventually grep -q -E '^(ready|error)' "$VM_OUT/said"
}

hide() {
	kill $showing 2>/dev/null
	wait $showing
}

# drawn HEAD: the picture is in the middle of that screen of 1024x768.
drawn() {
	screendump "$VM_OUT/head$1.ppm" "$1" &&
		"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/head$1.ppm" x=192 y=144
}

second() { # on, off, detect
	echo "$1" >"/sys/class/drm/card$virtio-Virtual-2/status"
}

"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
virtio=$(card_of virtio)

show 20 width=1024 height=768
equal "without the second one the first shows alone" "1 20" "$(said ready) $(said shown)"
check "what was drawn" drawn 0
hide

second on
show 20 width=1024 height=768
equal "with both all flips come back" "1 20" "$(said ready) $(said shown)"
equal "in order, time rising" "0 0" "$(said out_of_order) $(said backwards)"
check "the first one shows what was drawn, pixel by pixel" drawn 0
check "and so does the second" drawn 1
hide
equal "they close well" 0 $?

show 20
equal "with a size that the second one has not the first shows alone" "1 20 1280x800" \
	"$(said ready) $(said shown) $(said mode)"
matches "and the second one is told of" 'second screen at Virtual-2 stays dark' "$(cat "$VM_OUT/said")"
hide

second off
begin 600 width=1024 height=768
check "while pictures flow" eventually grep -q '^mode' "$VM_OUT/said"
second on
check "the second one is lit when it comes" eventually grep -q 'Virtual-2 shows the same' "$VM_OUT/said"
second off
check "and left when it goes" eventually grep -q 'Virtual-2 was unplugged' "$VM_OUT/said"
check "the first one goes on" eventually grep -q '^ready' "$VM_OUT/said"
equal "and was never lost" 0 "$(grep -c '^lost' "$VM_OUT/said")"
hide

second on
echo off >"/sys/class/drm/card$virtio-Virtual-1/status"
show 20 width=1024 height=768
equal "where the first one is missing the second is enough" "1 20" "$(said ready) $(said shown)"
check "and shows what was drawn" eventually drawn 1
hide
echo detect >"/sys/class/drm/card$virtio-Virtual-1/status"
second detect
