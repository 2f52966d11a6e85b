#!/bin/bash
# SPDX-License-Identifier: MIT
# Cameras that go and come back while `inlay run` runs.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh

load vivid n_devs=2 input_types=0xe4,0xe4
load vkms
sets=(--set camera.fisheye.format=YUYV --set camera.background.format=YUYV)
for camera in fisheye background; do
	sets+=(--set "camera.$camera.width=640" --set "camera.$camera.height=480"
		--set "camera.$camera.rate=10")
done

run pulled --set "screen.device=/dev/dri/card$(card_of vkms)" "${sets[@]}"
check "a run starts" eventually situation pulled fisheye fine
for camera in 0:fisheye 1:background; do
	control "$(video_node "vivid-00${camera%:*}-vid-cap")" disconnect=1
	name=${camera#*:}
	# vivid comes back as soon as the program has let go of it.
	check "the $name camera is named when it is pulled out" \
		eventually grep -q "camera $name: no device" "$VM_OUT/pulled.log"
	check "and used again when it is back" \
		eventually grep -q "camera $name: fine again" "$VM_OUT/pulled.log"
done
frames=$(stat pulled frames)
eventually eval '[ "$(stat pulled frames)" -gt $((frames + 2)) ]'
holds "pictures go on after that" "$(stat pulled frames) > $frames"
stop_run
equal "and it ends well" 0 $?

unload vkms
unload vivid
