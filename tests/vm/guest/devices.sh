# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by the tests: brings simulated devices and takes them away again.

# shellcheck disable=SC2034 # the tests use it
tools=$BUILD/tests/vm/tools

load() { # module, parameters
	modprobe -d "$VM_KERNEL/modules" "$@"
}

unload() {
	modprobe -d "$VM_KERNEL/modules" -r "$@"
}

# The node whose name begins so: video_node vivid-000-vid-cap prints /dev/video2
video_node() {
	local name
	for name in /sys/class/video4linux/video*/name; do
		if grep -q "^$1" "$name" 2>/dev/null; then
			name=${name%/name}
			echo "/dev/${name##*/}"
			return
		fi
	done
	return 1
}

control() { # node, control=value...
	local node=$1
	shift
	v4l2-ctl -d "$node" -c "$(
		IFS=,
		echo "$*"
	)"
}

# A vivid with HDMI in and out joined: what is played into the output is what its camera sees.
# FOURCC is a V4L2 format. As few frames a second as its clock allows.
#     hdmi_loop INSTANCE FOURCC [WIDTHxHEIGHT, else 640x480]
hdmi_loop() {
	local in out size=${3:-640x480}
	local timings="cvt,width=${size%x*},height=${size#*x},fps=38"
	local format="width=${size%x*},height=${size#*x},pixelformat=$2"
	in=$(video_node "vivid-00$1-vid-cap")
	out=$(video_node "vivid-00$1-vid-out")
	v4l2-ctl -d "$out" --set-dv-bt-timings "$timings" &&
		v4l2-ctl -d "$in" --set-dv-bt-timings "$timings" &&
		v4l2-ctl -d "$out" --set-fmt-video-out "$format" &&
		v4l2-ctl -d "$in" --set-fmt-video "$format" &&
		control "$in" loop_video=1 osd_text_mode=2
}

# Plays one raw picture into an output until stop_playing.
#     play INSTANCE FILE.raw
players=()
play() {
	local out
	out=$(video_node "vivid-00$1-vid-out")
	v4l2-ctl -d "$out" --stream-out-mmap=3 --stream-from="$2" --stream-loop \
		</dev/null >"$VM_OUT/play-$1.log" 2>&1 &
	players+=($!)
	eventually test -s "$VM_OUT/play-$1.log" # a mark for each picture: the output has its format
}

stop_playing() {
	kill "${players[@]}" 2>/dev/null
	wait "${players[@]}" 2>/dev/null
	players=()
}

# A chip of its own for buttons to ground, "panel"; each line's level is in $panel/sim_gpioLINE/pull.
bank=/sys/kernel/config/gpio-sim/inlay/bank
make_panel() { # number of lines
	mkdir -p $bank && echo "$1" >$bank/num_lines && echo panel >$bank/label && plug_panel 1
}
plug_panel() { # 1 or 0
	echo "$1" >${bank%/bank}/live
	panel=/sys/devices/platform/$(cat ${bank%/bank}/dev_name)/$(cat $bank/chip_name)
}
remove_panel() {
	plug_panel 0
	rmdir $bank ${bank%/bank}
}

# Photographs the screen of QEMU's own device from outside.
#     screendump FILE.ppm [HEAD]     below /run/job; HEAD 1: the second screen of virtio-gpu
screendump() {
	local outside=$VM_JOB_OUTSIDE${1#/run/job}
	outside=${outside//\\/\\\\}
	monitor screendump "\"filename\": \"${outside//\"/\\\"}\", \"device\": \"gpu\", \"head\": ${2:-0}"
}

# One command to QEMU's monitor, waited for. A new greeting is asked for only once.
#     monitor COMMAND [ARGUMENTS]
monitor() {
	local log=/run/job/monitor.log id=$RANDOM$RANDOM
	[ -e /run/monitor-ready ] || echo '{"execute": "qmp_capabilities"}' >/dev/ttyS1
	: >/run/monitor-ready
	echo "{\"execute\": \"$1\", \"id\": \"$id\", \"arguments\": {${2:-}}}" >/dev/ttyS1
	eventually grep -q "\"id\": \"$id\"" $log && grep "\"id\": \"$id\"" $log | grep -q return
}

# Makes the screen of QEMU's own device another one: virtio-gpu names this size as the preferred mode
# from now on, and the kernel tells whoever listens. 0 0: it is pulled out. (What a VNC client says
# who has resized the window; version and an anonymous greeting once. The port is connected only when
# its terminal no longer echoes: the server would take its own greeting for its client's.)
#     resize_window WIDTH HEIGHT
resize_window() {
	local size
	size=$(printf '\\x%02x' $(($1 >> 8)) $(($1 & 255)) $(($2 >> 8)) $(($2 & 255)))
	if [ ! -e /run/window-ready ]; then
		stty -F /dev/ttyS3 raw -echo
		monitor chardev-change "\"id\": \"window\", \"backend\": {\"type\": \"socket\", \"data\": {
			\"server\": false, \"addr\": {\"type\": \"unix\", \"data\": {\"path\": \"$VM_WINDOW\"}}}}"
		printf 'RFB 003.008\n\x01\x01' >/dev/ttyS3
	fi
	: >/run/window-ready
	printf '\xfb\0%b\x01\0\0\0\0\0\0\0\0\0%b\0\0\0\0' "$size" "$size" >/dev/ttyS3
}

# The card that this driver drives: card_of vkms prints 1
card_of() {
	local device
	for device in /sys/class/drm/card?; do
		case $(readlink -f "$device/device/driver" 2>/dev/null || readlink -f "$device/device") in
		*"$1"*)
			echo "${device##*card}"
			return
			;;
		esac
	done
	return 1
}
