#!/bin/bash
# The KMS driver on vkms and virtio-gpu: modes, flips, what is really scanned out, busy and missing
# screens, and the console's picture given back as it was.
. tests/vm/tap.sh
. tests/vm/devices.sh

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
	within_seconds 20 grep -q -E '^(ready|error)' "$VM_OUT/said"
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

# ---- busy ----
"$tools/show" kms "$VM_OUT/chart.png" 1 "device=/dev/dri/card$virtio" >"$VM_OUT/second" 2>&1
equal "a screen that another program drives is refused" 1 $?
equal "in one line" 1 "$(wc -l <"$VM_OUT/second")"
matches "that names the card" "card$virtio" "$(cat "$VM_OUT/second")"
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
for status in /sys/class/drm/card*-*/status; do
	echo detect >"$status"
done
"$tools/show" kms "$VM_OUT/chart.png" 1 device=/dev/dri/card9 >"$VM_OUT/said" 2>&1
matches "a card that is not there is an error that names it" card9 "$(said error)"
"$tools/show" kms "$VM_OUT/chart.png" 1 device=/dev/null >"$VM_OUT/said" 2>&1
matches "a file that is no screen is an error that names it" /dev/null "$(said error)"
show 3 connector=Virtual-77
matches "a connector that there is not is an error that names it" Virtual-77 "$(said error)"
wait $showing
unload vkms
