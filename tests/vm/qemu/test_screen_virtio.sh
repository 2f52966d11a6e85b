#!/bin/bash
# SPDX-License-Identifier: MIT
# The KMS driver on the card that holds the text console: what is shown, missing screens, another screen
# while it is used, and the console's picture given back as it was.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/screen.sh

"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
virtio=$(card_of virtio)
check "QEMU's screen can be photographed" screendump "$VM_OUT/screen.ppm"
"$INLAY" devices >"$VM_OUT/devices" 2>&1
matches "devices lists it with its preferred mode" "card$virtio.*1280x800" "$(tr '\n' ' ' <"$VM_OUT/devices")"

# ---- virtio-gpu: photographed from outside; it holds the text console ----
echo 0 >/sys/class/graphics/fbcon/cursor_blink
printf '\033[2J\033[Hthe console before\n' >/dev/tty1
settled() { # two photographs in a row are the same
	screendump "$1" && screendump "$1.again.ppm" && cmp "$1" "$1.again.ppm"
}
eventually settled "$VM_OUT/before.ppm"
show 20 "device=/dev/dri/card$virtio"
equal "virtio-gpu: all flips come back" 20 "$(said shown)"
equal "virtio-gpu: the preferred mode is set" 1280x800 "$(said mode)"
check "virtio-gpu: can be photographed" screendump "$VM_OUT/virtio.ppm"
check "virtio-gpu: it shows what was drawn, pixel by pixel" \
	"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/virtio.ppm" x=320 y=160
hide
equal "virtio-gpu: closes well" 0 $?
given_back() {
	screendump "$VM_OUT/after.ppm" && cmp "$VM_OUT/before.ppm" "$VM_OUT/after.ppm"
}
check "the console's picture is given back, pixel by pixel" eventually given_back

# ---- killed without a chance to clean up: the next one must still work ----
show 3 "device=/dev/dri/card$virtio"
kill -KILL $showing
wait $showing 2>/dev/null
show 3 "device=/dev/dri/card$virtio"
equal "after a killed program the screen can be used again" 1 "$(said ready)"
hide

plug "$virtio" off
comes_and_goes "$virtio" 320 160

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

