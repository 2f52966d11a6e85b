# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced after devices.sh and runs.sh: a kiosk with everything that a kiosk has, and what can go
# wrong with it. Each fault is a pair of functions, NAME_begin and NAME_end; between them the kiosk
# says what is wrong, after them it works as before, in the same process.
#
# Two vivid webcams are fisheye and background, a third vivid's HDMI input looks on; vkms is the
# screen, gpio-sim the buttons; the state lies on a file system of its own that can be filled.
# shellcheck disable=SC2154 # tools, running are set by the others
# shellcheck disable=SC2329 # faults are called by name

kiosk_conf=/run/kiosk.conf
state_folder=/run/state
control_socket=/run/control

faults_load() {
	load vivid n_devs=3 num_inputs=1,1,1 input_types=0,0,3
	v4l2-ctl -d "$(video_node vivid-002-vid-cap)" --set-dv-bt-timings "cvt,width=640,height=480,fps=38"
	load vkms
	load gpio-sim
	make_panel 4
	release_button
	mkdir -p $state_folder && mount -t tmpfs -o size=4m none $state_folder
	cp tests/vm/scenes/faults.conf $kiosk_conf
	sed -i "s|^file = basis|file = $basis|; s|CARD|/dev/dri/card$(card_of vkms)|" $kiosk_conf
}

faults_unload() {
	umount $state_folder
	remove_panel
	unload gpio-sim
	unload vkms
	unload vivid
}

# kiosk NAME option...: starts the kiosk; its log and statistics in $VM_OUT. Ended by stop_run.
kiosk() {
	local name=$1
	shift
	kiosk_name=$name
	"$INLAY" run --config $kiosk_conf --stats "$VM_OUT/$name.jsonl" "$@" >>"$VM_OUT/$name.log" 2>&1 &
	running=$!
}

logged() { # extended regex
	grep -q -E -e "$1" "$VM_OUT/$kiosk_name.log"
}

# The last words about CAMERA: fine, no device, ...
is_situation() { # CAMERA SITUATION
	situation "$kiosk_name" "$1" "$2"
}

all_fine() {
	is_situation fisheye fine && is_situation background fine && is_situation scene fine
}

# A number of the statistics has reached a value: counts KEY VALUE
counts() {
	[ "$(stat "$kiosk_name" "$1")" -ge "$2" ]
}

# Five more pictures reach the screen than had when this was called.
pictures_go_on() {
	eventually counts frames $(($(stat "$kiosk_name" frames) + 5))
}

status() {
	"$INLAY" control --socket $control_socket status
}

act() {
	"$INLAY" control --socket $control_socket "$@"
}

of_status() { # KEY: a word or a number
	status | grep -o "\"$1\":\"*[-a-z0-9. ]*" | head -n 1 | sed 's/.*:"*//'
}

camera_control() { # instance control=value
	v4l2-ctl -d "$(video_node "vivid-00$1-vid-cap")" -c "$2"
}

# ---- cameras ----

# Pulled out: vivid comes back as soon as the program has let go of it.
unplugged_begin() { camera_control 0 disconnect=1; }
unplugged_end() { :; }

all_unplugged_begin() { echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind; }
all_unplugged_end() { echo vivid.0 >/sys/bus/platform/drivers/vivid/bind; }

silent_begin() { camera_control 1 percentage_of_dropped_buffers=100; }
silent_end() { camera_control 1 percentage_of_dropped_buffers=0; }

lossy_begin() { camera_control 1 percentage_of_dropped_buffers=40; }
lossy_end() { camera_control 1 percentage_of_dropped_buffers=0; }

corrupt_begin() { camera_control 0 inject_v4l2_buf_flag_error=1; }
corrupt_end() { :; } # one buffer's worth

no_signal_begin() { camera_control 2 dv_timings_signal_mode=1; }
no_signal_end() { camera_control 2 dv_timings_signal_mode=0; }

# ---- screen ----

plug() { # off|detect
	echo "$1" >"$(echo /sys/class/drm/card"$(card_of vkms)"-Virtual-*/status)"
}
screen_unplugged_begin() { plug off; }
screen_unplugged_end() { plug detect; }

# ---- buttons ----

gpio_gone_begin() { plug_panel 0; }
gpio_gone_end() {
	plug_panel 1
	release_button
}

release_button() { echo pull-up >"$panel/sim_gpio2/pull"; }

press_button() {
	echo pull-down >"$panel/sim_gpio2/pull"
	sleep 0.2 # as long as a finger holds it
	release_button
}

# ---- the system ----

disk_full_begin() { dd if=/dev/zero of=$state_folder/filler bs=4k 2>/dev/null || :; }
disk_full_end() { rm -f $state_folder/filler; }

wrong_conf_begin() {
	cp $kiosk_conf /run/right.conf
	sed -i 's/^threshold_step = .*/threshold_step = plenty/' $kiosk_conf
	kill -HUP "$running"
}
wrong_conf_end() {
	cp /run/right.conf $kiosk_conf
	kill -HUP "$running"
}

# No descriptor can be opened beyond those that are open.
no_descriptors_begin() {
	prlimit --pid "$running" --nofile="$(find "/proc/$running/fd" -mindepth 1 | wc -l):4096"
}
no_descriptors_end() { prlimit --pid "$running" --nofile=1024:4096; }

frozen_begin() { kill -STOP "$running"; }
frozen_end() { kill -CONT "$running"; }
