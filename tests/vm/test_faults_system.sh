#!/bin/bash
# SPDX-License-Identifier: MIT
# What goes wrong around the kiosk: buttons, disk, configuration, descriptors, time. One run, never
# restarted.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/faults.sh

faults_load
threshold_is() { [ "$(of_status threshold)" = "$1" ]; }
descriptors() { find "/proc/$running/fd" -mindepth 1 | wc -l; }
kept_is() { grep -q "^threshold = $1\$" $state_folder/state; }

# ---- buttons that are not there, come, go and come back ----
gpio_gone_begin
kiosk system
check "the kiosk starts without its buttons" eventually all_fine
matches "and says so" "buttons" "$(cat "$VM_OUT/system.log")"
gpio_gone_end
# A press changes the threshold: press_leaves VALUE
press_leaves() { press_button && [ "$(of_status threshold)" != "$1" ]; }
check "buttons are used when they come" eventually press_leaves 0
act threshold-set 10
gpio_gone_begin
check "gpio gone: pictures go on" pictures_go_on
gpio_gone_end
check "gpio gone: buttons are used again" eventually press_leaves 10

# ---- no room for the state ----
act threshold-set 50
check "the state is kept" eventually kept_is 50
disk_full_begin
act threshold-set 60
check "disk full: it is said" eventually logged "state"
check "disk full: pictures go on" pictures_go_on
check "disk full: the old state is whole" kept_is 50
equal "disk full: nothing else is left there" "filler state" "$(cd $state_folder && echo *)"
disk_full_end
check "disk full: the new one is written when there is room" eventually kept_is 60

# ---- a configuration that is wrong ----
wrong_conf_begin
check "wrong configuration: the line is named" \
	eventually logged "kiosk.conf:[0-9]+: \[lights\] threshold_step: .*plenty"
act threshold-set 70 && act threshold-up
check "wrong configuration: the old one stays" threshold_is 80
check "wrong configuration: pictures go on" pictures_go_on
wrong_conf_end
rm $kiosk_conf && kill -HUP $running
check "a configuration that is gone is named" eventually logged "kiosk.conf: .*No such file"
cp /run/right.conf $kiosk_conf
sed -i 's/^threshold_step = .*/threshold_step = 20/' $kiosk_conf
kill -HUP $running
stepped() { act threshold-set 70 && act threshold-up && threshold_is 90; }
check "a right configuration takes effect" eventually stepped
frames_before=$(stat system frames)
sed -i 's/^device = platform:vivid-000/device = platform:vivid-001/' $kiosk_conf
kill -HUP $running
check "what cannot change meanwhile is named" eventually logged "camera fisheye.*device.*next start"
check "and pictures go on" pictures_go_on
holds "none was lost" "$(stat system frames) > $frames_before"
cp /run/right.conf $kiosk_conf

# ---- no descriptors ----
no_descriptors_begin
camera_control 0 disconnect=1
check "no descriptors: the camera is named" \
	eventually logged "camera fisheye: .*(descriptor|open files|no device)"
check "no descriptors: pictures go on" pictures_go_on
no_descriptors_end
check "no descriptors: it is opened when there are some" eventually all_fine

# ---- stopped for ten seconds ----
count=$(descriptors)
lines=$(wc -l <"$VM_OUT/system.log")
frozen_begin
sleep 10 # that long
frozen_end
check "stopped: pictures go on" pictures_go_on
check "stopped: no camera was given up" all_fine
equal "stopped: nor said to be in trouble" 0 \
	"$(tail -n "+$((lines + 1))" "$VM_OUT/system.log" | grep -c stalled)"
equal "descriptors do not grow" "$count" "$(descriptors)"

check "the kiosk was never restarted" kill -0 $running
stop_run
equal "it ends well" 0 $?

# ---- what was chosen is there after kill -9 ----
kiosk killed
eventually all_fine
act threshold-set 110
check "the choice is written" eventually kept_is 110
kill -KILL $running
wait $running
kiosk again
eventually all_fine
check "and is there after a kill" threshold_is 110
stop_run
faults_unload
