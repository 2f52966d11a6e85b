# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced after devices.sh by the tests that run the whole program: two vivids are its cameras.
# shellcheck disable=SC2154 # tools is set there

basis=$BUILD/tests/vm/live/live.inlay
config=tests/vm/scenes/live.conf
width=160 height=120 # of the basis

# run NAME option...: starts inlay run on both cameras; ended by stop_run.
run() {
	local name=$1
	shift
	"$INLAY" run --config $config --set basis.file="$basis" \
		--set camera.fisheye.device="$(video_node vivid-000-vid-cap)" \
		--set camera.background.device="$(video_node vivid-001-vid-cap)" \
		--stats "$VM_OUT/$name.jsonl" "$@" >"$VM_OUT/$name.log" 2>&1 &
	running=$!
}

# Its exit code; a run that does not end within 10 s is killed.
stop_run() {
	kill $running 2>/dev/null
	eventually ended || kill -KILL $running
	wait $running
}

ended() {
	! kill -0 $running
}

# stat NAME KEY: a number of the last line of statistics, not of a camera.
stat() {
	tail -n 1 "$VM_OUT/$1.jsonl" | grep -o "\"$2\":[-0-9.]*" | head -n 1 | cut -d : -f 2
}

# The last line says that this camera's situation is so.
#     situation NAME CAMERA SITUATION
situation() {
	tail -n 1 "$VM_OUT/$1.jsonl" | grep -q "\"name\":\"$2\",\"situation\":\"$3\""
}

# The picture that both commands must make of two pictures of 640x480.
#     expect FISHEYE.png BACKGROUND.png OUT.png [option...]
expect() {
	local fisheye=$1 background=$2 out=$3
	shift 3
	"$INLAY" still --config $config --basis "$basis" --fisheye "$fisheye" \
		--background "$background" "$@" -o "$out"
}

# Whether the middle of the screen equals the expected picture.
#     shown_on vkms|virtio EXPECTED.png within=LEVELS
shown_on() {
	local screen=1024x768 picture=$VM_OUT/vkms.png
	if [ "$1" = vkms ]; then
		"$tools/scanout" picture "$(card_of vkms)" "$picture" >/dev/null
	else
		screen=1280x800 picture=$VM_OUT/virtio.ppm
		screendump "$picture"
	fi || return
	"$tools/picture" compare "$2" "$picture" "x=$(((${screen%x*} - width) / 2))" \
		"y=$(((${screen#*x} - height) / 2))" "$3" >"$VM_OUT/compared" 2>&1
}

# shows DESCRIPTION then as above; the pictures of a failure are kept.
shows() {
	local description=$1
	shift
	if eventually shown_on "$@"; then
		ok "$description: $(sed 's/ at .*;/,/; s/;.*//' "$VM_OUT/compared")"
	else
		mkdir -p "$VM_OUT/failed/${description//[^a-z0-9]/-}"
		cp "$2" "$VM_OUT/vkms.png" "$VM_OUT/virtio.ppm" \
			"$VM_OUT/failed/${description//[^a-z0-9]/-}" 2>/dev/null
		not_ok "$description" <"$VM_OUT/compared"
	fi
}

# feed FOURCC FORMAT FISHEYE.png BACKGROUND.png: the cameras deliver these pictures, so encoded.
feed() {
	local fourcc=$1 format=$2 i
	shift 2
	for i in 0 1; do
		hdmi_loop $i "$fourcc" >/dev/null
		"$tools/picture" raw "$format" "$1" "$VM_OUT/$i.raw"
		play $i "$VM_OUT/$i.raw"
		shift
	done
}

# Two cameras that see charts of ours without loss, and what still makes of them.
# shellcheck disable=SC2034 # the tests use sets
live_load() {
	load vivid n_devs=2 num_inputs=1,1 input_types=3,3 num_outputs=1,1 output_types=1,1
	"$tools/picture" chart fisheye 640 480 "$VM_OUT/fisheye.png"
	"$tools/picture" chart background 640 480 "$VM_OUT/background.png"
	check "still makes the expected picture" \
		expect "$VM_OUT/fisheye.png" "$VM_OUT/background.png" "$VM_OUT/expected.png"
	feed XR24 BGRX "$VM_OUT/fisheye.png" "$VM_OUT/background.png"
	sets=(--set camera.fisheye.format=BGRX --set camera.background.format=BGRX)
}
