#!/bin/bash
# SPDX-License-Identifier: MIT
# The libcamera driver while udev tells of other devices, too late, or more than the program's socket
# holds.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/libcamera.sh
# shellcheck disable=SC2154 # tools and basis are set there

load vimc
start_udev
udevadm control --children-max=1 # nodes are told in the kernel's order
load vkms
capture 3 format=BGR24 width=600 height=480
expect "$VM_OUT/frame.png" "$VM_OUT/frame.png" "$VM_OUT/expected.png"

# ---- a camera that is looked for while another runs ----
run_libcamera two --set "fisheye.camera=other" --set camera.other.driver=libcamera \
	--set "camera.other.device=Sensor C"
said_by_two() {
	grep -q "$1" "$VM_OUT/two.log"
}
anew() {
	grep -c "begins anew" "$VM_OUT/two.log"
}
check "a camera that there is not is named" \
	eventually said_by_two 'camera other: no device: .*"Sensor C"; there is platform/vimc'
tell_again
check "when devices come it is looked for among them" \
	eventually said_by_two "begins anew"
sleep 3
equal "but not without end" "$(anew)" "$(sleep 3; anew)"
unbind
check "and the other camera has been opened again" \
	eventually said_by_two "camera board: no device: .*the camera has gone"
bind
check "and comes back" eventually said_by_two "camera board: fine again"
stop_run
equal "that run ends well" 0 $?

# ---- udev is behind, and tells more than the program's socket holds ----
# The device has been taken away and is back under the same numbers: libcamera finds it, as udev,
# which has yet to tell that it went, knows those. (The run before had the numbers of its camera in
# use to its end; the first time gives them up.) The program's socket has little room, and the
# program no right to more.
unbind
bind
udevd=$(pgrep -o -x systemd-udevd)
kill -STOP "$udevd"
unbind
bind_untold
echo 8192 >/proc/sys/net/core/rmem_max
as=(setpriv --bounding-set=-net_admin --inh-caps=-net_admin
	env "LD_LIBRARY_PATH=$tools" LD_PRELOAD=webcam.so)
run_libcamera late
as=()
lines() {
	wc -l <"$VM_OUT/late.jsonl"
}
more_lines() {
	[ "$(lines)" -gt "$1" ]
}
goes_on() {
	eventually more_lines $(($(lines) + 1))
}
lost_messages() {
	awk '$2 == 15 && $4 == "00000002" && $9 > 0 { lost = 1 } END { exit !lost }' /proc/net/netlink
}
shows "a camera that has just come back is shown" vkms "$VM_OUT/expected.png" within=0
check "and libcamera treats it as a webcam" grep -q "^webcam: a device" "$VM_OUT/late.log"
kill -CONT "$udevd"
udevadm settle --timeout=30
check "udev tells now that it went, and the run goes on" goes_on
kill -STOP $running
tell_again
tell_again
check "what udev tells while the program is stopped is lost in part" lost_messages
kill -CONT $running
check "and the run goes on" goes_on
shows "the picture is right" vkms "$VM_OUT/expected.png" within=0
equal "and the camera was never lost" 0 "$(grep -c "no device" "$VM_OUT/late.log")"
stop_run
equal "that run ends well, too" 0 $?

unload vkms
stop_udev
unload vimc
