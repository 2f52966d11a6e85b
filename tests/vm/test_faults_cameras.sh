#!/bin/bash
# SPDX-License-Identifier: MIT
# What goes wrong with cameras, one fault after another, in one run of the kiosk that is never
# restarted.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/faults.sh

faults_load

# ---- wrapping counters, from the first frame on ----
control "$(video_node vivid-000-vid-cap)" wrap_sequence_number=1
control "$(video_node vivid-001-vid-cap)" wrap_timestamp=1
kiosk cameras
check "the kiosk starts with all cameras" eventually all_fine
check "pictures go on while counters wrap" pictures_go_on
holds "a counter that wraps loses no frames by itself" "$(stat cameras drops) < 1000000"
camera_control 0 wrap_sequence_number=0
camera_control 1 wrap_timestamp=0

# during NAME CAMERA SITUATION: begins, is named, ends, all is fine and pictures go on.
during() {
	local fault=$1 camera=$2 expected=$3
	"${fault}_begin"
	check "$fault: the $camera camera is named ($expected)" \
		eventually is_situation "$camera" "$expected"
	check "$fault: the screen goes on meanwhile" pictures_go_on
	"${fault}_end"
	check "$fault: it is used again" eventually all_fine
	check "$fault: pictures go on" pictures_go_on
}

unplugged_begin
check "unplugged: it is named" eventually logged "camera fisheye: no device"
check "unplugged: it is used again when it is back" eventually all_fine
check "unplugged: pictures go on" pictures_go_on

during silent background stalled
during no_signal scene "no signal"

# ---- frames that are lost or broken are counted and passed over ----
lossy_begin
check "lossy: lost frames are counted" \
	eventually counts drops $(($(stat cameras drops) + 1))
check "lossy: pictures go on" pictures_go_on
lossy_end
corrupt_begin
check "corrupt: pictures go on" pictures_go_on
check "corrupt: all is fine" eventually all_fine

# ---- another source ----
cp "$VM_OUT/cameras.jsonl" "$VM_OUT/before-source-change.jsonl"
camera_control 2 dv_timings_signal_mode=4
check "source change: the camera follows it" \
	eventually logged "camera scene: fine again, [0-9]+x[0-9]+"
check "source change: pictures go on" pictures_go_on
camera_control 2 dv_timings_signal_mode=0
check "source change: and back" eventually all_fine

# ---- back under other numbers ----
numbers() {
	local i
	for i in 0 1 2; do video_node vivid-00$i-vid-cap; done
}
numbers >"$VM_OUT/numbers-before"
all_unplugged_begin
check "renumbered: all cameras are named" eventually is_situation background "no device"
check "renumbered: the screen goes on, and says so" pictures_go_on
load vimc
all_unplugged_end
numbers >"$VM_OUT/numbers-after"
if cmp -s "$VM_OUT/numbers-before" "$VM_OUT/numbers-after"; then
	not_ok "renumbered: the numbers are others" <"$VM_OUT/numbers-after"
else
	ok "renumbered: the numbers are others"
fi
check "renumbered: all are found again" eventually all_fine
check "renumbered: pictures go on" pictures_go_on

check "the kiosk was never restarted" kill -0 $running
stop_run
equal "it ends well" 0 $?
unload vimc

faults_unload
