# SPDX-License-Identifier: MIT
# Sourced by the tests of the libcamera driver on vimc: what was captured, the sensor, udev, a run.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # tools and basis are set by devices.sh and runs.sh, running is read there
config=tests/vm/scenes/libcamera.conf

# The value of NAME in the output of the last capture.
said() {
	awk -v name="$1" '$1 == name { sub(/^[^ ]* /, ""); print; exit }' "$VM_OUT/said"
}

# capture FRAMES name=value...: the last frame goes to $VM_OUT/frame.png.
capture() {
	local frames=$1
	shift
	rm -f "$VM_OUT/frame.png"
	"$tools/capture" libcamera "$frames" "$VM_OUT/frame.png" "$@" >"$VM_OUT/said" 2>&1
}

# The simulated sensor's own node, where what libcamera set can be read.
sensor_node() {
	local name
	for name in /sys/class/video4linux/v4l-subdev*/name; do
		if grep -q "^Sensor B" "$name"; then
			name=${name%/name}
			echo "/dev/${name##*/}"
			return
		fi
	done
	return 1
}

brightness_is() {
	[ "$(v4l2-ctl -d "$(sensor_node)" -C brightness)" = "brightness: $1" ]
}

# udev has seen what is there.
settle() {
	udevadm trigger --subsystem-match=media --subsystem-match=video4linux &&
		udevadm settle --timeout=30
}

# It tells of all devices once more, as when they were plugged in.
tell_again() {
	udevadm trigger --action=add --subsystem-match=media --subsystem-match=video4linux &&
		udevadm settle --timeout=30
}

driver=/sys/bus/platform/drivers/vimc
unbind() {
	echo vimc.0 >$driver/unbind
}
bind_untold() {
	echo vimc.0 >$driver/bind
	v4l2-ctl -d "$(sensor_node)" -c show_information=2 # no running clock in the picture
}
bind() {
	bind_untold
	settle
}

start_udev() {
	export SYSTEMD_IGNORE_CHROOT=1
	/lib/systemd/systemd-udevd --daemon 2>"$VM_OUT/udevd.log"
	check "udev runs" settle
	v4l2-ctl -d "$(sensor_node)" -c show_information=2
}
stop_udev() {
	udevadm control --exit
	rm -rf /run/udev
}

as=() # the command that starts the program
run_libcamera() { # NAME option...: onto vkms
	local name=$1
	shift
	"${as[@]}" "$INLAY" run --config $config --set basis.file="$basis" \
		--set "screen.device=/dev/dri/card$(card_of vkms)" \
		--stats "$VM_OUT/$name.jsonl" "$@" >"$VM_OUT/$name.log" 2>&1 &
	running=$!
}
