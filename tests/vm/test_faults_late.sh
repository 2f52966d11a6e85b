#!/bin/bash
# SPDX-License-Identifier: MIT
# Cameras that refuse a control, and cameras that come long after the kiosk.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/faults.sh

faults_load
# ---- controls: what is refused is named, what is taken is read back, at every opening ----
sed -i '/^\[camera background\]/a controls = brightness=77, no_such_control=1, contrast=100000' $kiosk_conf
kiosk controls
check "controls: the kiosk starts all the same" eventually all_fine
check "controls: one that there is not is named" logged "no_such_control"
check "controls: one out of range is named" logged "contrast"
brightness() {
	v4l2-ctl -d "$(video_node vivid-001-vid-cap)" -C brightness | grep -q ': 77$'
}
check "controls: one that is right is set" brightness
camera_control 1 disconnect=1
check "controls: the camera is lost" eventually logged "camera background: no device"
check "controls: and found" eventually all_fine
camera_control 1 brightness=10
camera_control 1 disconnect=1
check "controls: they are set again at the next opening" eventually brightness
stop_run
sed -i '/^controls = /d' $kiosk_conf

# ---- nothing is there until a minute after the start ----
all_unplugged_begin
kiosk late
check "late: the kiosk starts without a camera" eventually pictures_go_on
matches "late: and names what is missing" "camera fisheye: no device" "$(cat "$VM_OUT/late.log")"
sleep 60 # that long, and nothing comes
check "late: the screen is alive after a minute" pictures_go_on
equal "late: each camera is named once, not every second" 1 \
	"$(grep -c "camera fisheye" "$VM_OUT/late.log")"
all_unplugged_end
check "late: the cameras are used when they come" eventually all_fine
check "late: pictures go on" pictures_go_on
stop_run
equal "late: it ends well" 0 $?
faults_unload
