#!/bin/bash
# SPDX-License-Identifier: MIT
# The libcamera driver on vimc, the kernel's simulated sensor with a processing pipeline: what is
# listed, choice by name, formats and sizes, controls, a device that goes away, a whole run.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/libcamera.sh
# shellcheck disable=SC2154 # tools and basis are set there

# ---- why there is none ----
capture 1
matches "without a device that is said" "error libcamera: no camera: there is no /dev/media" \
	"$(cat "$VM_OUT/said")"
equal "and is something that waiting can mend" "no device" "$(said situation)"
load vimc
capture 1
matches "without udev that is said" "error libcamera: no camera: .*udev.* not running" \
	"$(cat "$VM_OUT/said")"
"$INLAY" devices >"$VM_OUT/listed" 2>&1
equal "devices is well without udev" 0 $?

start_udev

setpriv --reuid=65534 --regid=65534 --clear-groups \
	"$tools/capture" libcamera 1 /dev/null >"$VM_OUT/said" 2>/dev/null
matches "without permission that is said" "error libcamera: no permission for /dev/media" \
	"$(cat "$VM_OUT/said")"
equal "and named so" "no permission" "$(said situation)"

# ---- listing, and choice by name ----
"$INLAY" devices >"$VM_OUT/listed" 2>"$VM_OUT/errors"
equal "devices lists and is well" 0 $?
equal "and libcamera's own messages are not shown" "" "$(cat "$VM_OUT/errors")"
listed=$(cat "$VM_OUT/listed")
matches "id and model are listed" 'libcamera: platform/vimc.0 Sensor B \(Sensor B\)' "$listed"
matches "formats and sizes" 'RGB888 BGR24 48x48 to 4096x2160' "$listed"
matches "controls with their ranges" 'control "Contrast" 0..2, default 1' "$listed"

size="width=600 height=480"
# shellcheck disable=SC2086 # size is two words
for name in "" "platform/vimc.0 Sensor B" "Sensor B" "VIMC"; do
	check "the camera is found by \"$name\"" capture 1 device="$name" $size
done
capture 1 device="Sensor C"
equal "a name that fits none is no device" "no device" "$(said situation)"
matches "and the error names those that there are" \
	'"Sensor C"; there is platform/vimc.0 Sensor B \(Sensor B\)' "$(said error)"

# ---- pictures ----
# The middle of bar 0..7 holds one colour: 191 and 0 in every combination. They are 75 px wide.
bar() { # N R G B
	local got
	got=$("$tools/picture" colour "$VM_OUT/frame.png" $(($1 * 75 + 20)) 200 36 60)
	[ "$got" = "$2 $3 $4 $2 $3 $4" ] && return
	echo "bar $1: expected $2 $3 $4, is $got"
	return 1
}

colour_bars() {
	local failed=0
	bar 0 191 191 191 || failed=1
	bar 1 191 191 0 || failed=1
	bar 2 0 191 191 || failed=1
	bar 3 0 191 0 || failed=1
	bar 4 191 0 191 || failed=1
	bar 5 191 0 0 || failed=1
	bar 6 0 0 191 || failed=1
	bar 7 0 0 0 || failed=1
	return $failed
}

# shellcheck disable=SC2086
for format in RGB24 BGR24; do
	capture 3 format=$format $size
	equal "$format is taken" "$format 600x480 1800" "$(said format) $(said size) $(said stride)"
	check "$format holds the test pattern's colours" colour_bars
	mv "$VM_OUT/frame.png" "$VM_OUT/$format.png"
done
check "both formats give the same picture" \
	"$tools/picture" compare "$VM_OUT/RGB24.png" "$VM_OUT/BGR24.png" within=0
# shellcheck disable=SC2086
capture 1 $size
equal "without a wish the cheapest format is taken" BGR24 "$(said format)"

# The pipeline is still as libcamera set it up: the same through the video node.
"$tools/capture" v4l2 3 "$VM_OUT/node.png" device="$(video_node 'RGB/YUV Capture')" \
	format=BGR24 width=600 height=480 >"$VM_OUT/said" 2>&1
check "and the same as the video node gives" \
	"$tools/picture" compare "$VM_OUT/BGR24.png" "$VM_OUT/node.png" within=0
capture 2 width=300 height=240
equal "another size is taken" "300x240 900" "$(said size) $(said stride)"
capture 2 width=640 height=480
equal "a size that it cannot have becomes one that it can" "636x480 1908" \
	"$(said size) $(said stride)"
matches "which is said" "asked for 640x480, it gives 636x480" "$(cat "$VM_OUT/said")"
capture 1 format=NV12
equal "a format that it has not is unsupported" "unsupported format" "$(said situation)"
matches "and those that it has are named" "it offers .*RGB888.*, expected NV12" "$(said error)"

# ---- frames ----
capture 40 width=48 height=48
equal "frames come whole" "40 0" "$(said taken) $(said broken)"
holds "what is missing among them is counted lost" "$(said lost) >= $(said gaps)"
equal "timestamps rise" 0 "$(said backwards)"
capture 6 width=48 height=48 hold=300
holds "a slow reader gets the newest frame, the older are counted lost" "$(said lost) > 5"

# ---- it goes away and comes back ----
rm "$VM_OUT/said"
capture 1000 width=48 height=48 &
check "frames come" eventually grep -q '^stride' "$VM_OUT/said"
unbind
wait $!
equal "a program whose camera is taken away ends by itself" 1 $?
equal "a camera that is taken away is named so" "no device" "$(said situation)"
matches "in a sentence" "error libcamera: platform/vimc.0 Sensor B: the camera has gone" \
	"$(cat "$VM_OUT/said")"
bind
check "and opens again when it is back" capture 2 width=48 height=48

# ---- a whole run: both views of one camera, onto vkms ----
load vkms
expect "$VM_OUT/BGR24.png" "$VM_OUT/BGR24.png" "$VM_OUT/expected.png"
run_libcamera run
shows "the screen shows what inlay still makes of the picture" vkms "$VM_OUT/expected.png" within=0
named() { # TIMES TEXT
	[ "$(grep -c "$2" "$VM_OUT/run.log")" = "$1" ]
}
# One at a time, nodes are told in the kernel's order, those of pictures before the media node. Else
# the latter, for which udev has less to do, overtakes them but on a busy machine.
udevadm control --children-max=1
for time in 1 2; do
	unbind
	check "$time: a camera that is taken away is named" \
		eventually named $time "camera board: no device"
	bind
	check "$time: and used again when it is back" \
		eventually named $time "camera board: fine again"
done
shows "and the picture is right again" vkms "$VM_OUT/expected.png" within=0
tell_again
shows "a camera that udev tells of again runs on" vkms "$VM_OUT/expected.png" within=0
check "and was not lost once more" named 2 "camera board: no device"
stop_run
equal "the run ends well" 0 $?
equal "nothing of libcamera's own chatter is in its log" "" \
	"$(grep -E 'libcamera: *(INFO|WARN|DEBUG)' "$VM_OUT/run.log")"

# ---- controls: set after every opening, refusals named ----
brightness_is 128 || echo "it is not" | not_ok "the sensor's brightness is at its default"
run_libcamera controls \
	--set "camera.board.controls=Brightness = 0.25, Contrast=9, Sparkle=1, saturation=high"
check "a control is set in the sensor" eventually brightness_is 160
check "a value out of range is refused and named" eventually \
	grep -q 'control Contrast is not set: 9 is out of its range 0..2' "$VM_OUT/controls.log"
check "so is a control that there is not" \
	grep -q 'control Sparkle is not set: the camera has no such' "$VM_OUT/controls.log"
check "so is a word where a number belongs" \
	grep -q 'control saturation is not set: "high" is no value' "$VM_OUT/controls.log"
unbind
eventually grep -q "camera board: no device" "$VM_OUT/controls.log"
bind
check "it is set again after the camera was away" eventually brightness_is 160
stop_run
equal "that run ends well" 0 $?

unload vkms
stop_udev
unload vimc
