#!/bin/bash
# The simulated hardware itself, by Debian's own tools: if this fails, look here first.
. tests/vm/tap.sh
. tests/vm/devices.sh

check "vivid loads" load vivid n_devs=2
in=$(video_node vivid-000-vid-cap)
matches "vivid has a camera" '^/dev/video' "$in"
check "it streams" v4l2-ctl -d "$in" --stream-mmap=3 --stream-count=3 --stream-to=/dev/null
v4l2-ctl -d "$in" --list-ctrls-menus >"$VM_OUT/controls" 2>&1
v4l2-ctl -d "$in" --list-formats-ext >"$VM_OUT/formats" 2>&1
check "vivid unloads" unload vivid

check "vkms loads" load vkms
"$tools/scanout" list >"$VM_OUT/screens"
matches "vkms shows a connected screen" '^[0-9]+ vkms ' "$(cat "$VM_OUT/screens")"
matches "virtio-gpu shows a connected screen" '^[0-9]+ virtio_gpu ' "$(cat "$VM_OUT/screens")"
check "QEMU's screen can be photographed" screendump "$VM_OUT/screen.ppm"
check "vkms unloads" unload vkms
check "gpio-sim loads" load gpio-sim
check "gpio-sim unloads" unload gpio-sim
