#!/bin/bash
# SPDX-License-Identifier: MIT
# The simulated hardware itself, by Debian's own tools: if this fails, look here first.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

check "vivid loads" load vivid n_devs=2
in=$(video_node vivid-000-vid-cap)
matches "vivid has a camera" '^/dev/video' "$in"
check "it streams" v4l2-ctl -d "$in" --stream-mmap=3 --stream-count=3 --stream-to=/dev/null
v4l2-ctl -d "$in" --list-ctrls-menus >"$VM_OUT/controls" 2>&1
v4l2-ctl -d "$in" --list-formats-ext >"$VM_OUT/formats" 2>&1
check "vivid unloads" unload vivid

# The joint that the live tests rest on.
load vivid n_devs=2 num_inputs=1,1 input_types=3,3 num_outputs=1,1 output_types=1,1
check "HDMI out and in can be joined" hdmi_loop 0 XR24
"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
"$tools/picture" raw BGRX "$VM_OUT/chart.png" "$VM_OUT/chart.raw"
# The comparison that everything rests on must be able to fail.
"$tools/picture" chart background 638 480 "$VM_OUT/narrow.png"
for shift in 0 1 2; do
	if "$tools/picture" compare "$VM_OUT/narrow.png" "$VM_OUT/chart.png" x=$shift >/dev/null; then
		echo "shift $shift went unnoticed" | not_ok "a picture that differs is told apart"
	else
		ok "a picture that differs is told apart ($shift)"
	fi
done
play 0 "$VM_OUT/chart.raw"
comes_back() {
	v4l2-ctl -d "$(video_node vivid-000-vid-cap)" --stream-mmap=3 --stream-count=1 \
		--stream-to="$VM_OUT/back.raw" && cmp "$VM_OUT/chart.raw" "$VM_OUT/back.raw"
}
check "what is played out comes in again, byte by byte" eventually comes_back
stop_playing
unload vivid

check "vkms loads" load vkms
echo detect >"$(echo "/sys/class/drm/card$(card_of vkms)"-Virtual-*/status)" # nobody else has asked it yet
"$tools/scanout" list >"$VM_OUT/screens"
matches "vkms shows a connected screen" '^[0-9]+ vkms ' "$(cat "$VM_OUT/screens")"
check "vkms unloads" unload vkms
check "gpio-sim loads" load gpio-sim
check "gpio-sim unloads" unload gpio-sim
