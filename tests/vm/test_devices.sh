#!/bin/bash
# SPDX-License-Identifier: MIT
# `inlay devices` names what is there.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

"$INLAY" devices >"$VM_OUT/none" 2>&1
equal "with no camera there is nothing wrong" 0 $?

load vivid n_devs=1 input_types=0xe4
load vkms
load gpio-sim
make_panel 4

"$INLAY" devices >"$VM_OUT/listed" 2>"$VM_OUT/errors"
equal "devices lists and is well" 0 $?
equal "without complaint" "" "$(cat "$VM_OUT/errors")"
listed=$(cat "$VM_OUT/listed")
in=$(video_node vivid-000-vid-cap)
matches "vivid's camera" "v4l2: $in .*vivid" "$listed"
for format in YUYV UYVY NV12 RGB24 BGR24 BGRX GREY; do
	matches "its format $format" "$format.*640x480" "$listed"
done
matches "vkms's screen with its modes" "card$(card_of vkms)" "$listed"
matches "and its preferred one" '1024x768' "$listed"
matches "the chip with buttons" 'panel.*4 lines' "$listed"

"$INLAY" devices --json >"$VM_OUT/listed.json" 2>"$VM_OUT/errors"
if command -v python3 >/dev/null; then
	check "the list for programs is JSON" python3 -m json.tool "$VM_OUT/listed.json" /dev/null
fi
matches "and names the camera" "\"device\": \"$in\"" "$(cat "$VM_OUT/listed.json")"

remove_panel
unload gpio-sim
unload vkms
unload vivid
