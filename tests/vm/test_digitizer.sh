#!/bin/bash
# SPDX-License-Identifier: MIT
# The V4L2 driver on vivid as a television digitizer: inputs and standards, every order of fields
# through every way to deinterlace, pairs that lose a field, signal that goes and changes, cameras
# found again, controls.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

# The value of NAME in the output of the last capture.
said() {
	awk -v name="$1" '$1 == name { sub(/^[^ ]* /, ""); print; exit }' "$VM_OUT/said"
}

# File for the last frame of capture; "-": none.
picture=-

# capture FRAMES name=value...
capture() {
	local frames=$1
	shift
	"$tools/capture" v4l2 "$frames" "$picture" "device=$in" "$@" >"$VM_OUT/said" 2>&1
}

# The same in the background, and a command once it streams.
capture_and() { # command..., --, then as capture
	local command=()
	while [ "$1" != -- ]; do
		command+=("$1")
		shift
	done
	shift
	: >"$VM_OUT/said"
	capture "$@" &
	local pid=$!
	eventually grep -q '^stride' "$VM_OUT/said"
	"${command[@]}" >"$VM_OUT/command" 2>&1
	wait $pid
}

# lines EVEN ODD: the last picture's lines of even number hold this grey everywhere, those of odd
# number the other. The top field holds the even ones. vivid truncates Y'CbCr: slack is 1 there.
slack=0
lines() {
	local low high expected=$1 parity
	for parity in even odd; do
		read -r low high <<<"$(said $parity)"
		if [ "${low:-999}" -lt $((expected - slack)) ] ||
			[ "$high" -gt $((expected + slack)) ]; then
			echo "$parity lines: expected $expected, are $low..$high"
			return 1
		fi
		expected=$2
	done
}

# In the pattern of alternating lines the bottom field is white, the top one black. In double
# precision: woven 0 and 255; the later field alone is all of one level; a quarter, a half and a
# quarter of 0 255 0 or 255 0 255 are 127.5, rounded up 128.
fields_come_right() { # standard, size, key, expected fields, level of the later field
	local standard=$1 size=$2 key=$3 fields=$4 later=$5 way even odd
	for way in weave:0:255 bob:$later:$later blend:128:128; do
		IFS=: read -r way even odd <<<"$way"
		case $key in top | bottom)
			even=$later
			odd=$later
			;;
		esac
		capture 2 input="S-Video 0" standard="$standard" field="$key" format=BGRX \
			deinterlace="$way"
		check "$standard, field = $key, $way: each line is where it belongs" \
			lines "$even" "$odd"
	done
	equal "$standard, field = $key: size and fields" "$size $fields" \
		"$(said size) $(said fields)"
}

# ---- inputs and standards ----
load vivid n_devs=1 num_inputs=2 input_types=0x9 num_outputs=1 output_types=0
in=$(video_node vivid-000-vid-cap)
control "$in" osd_text_mode=2

capture 2 input="s-video 0" standard=PAL
equal "PAL by its family's name" 720x576 "$(said size)"
capture 2 input=1 standard=ntsc-m
equal "NTSC by the device's name, the input by number" 720x480 "$(said size)"
capture 2 input=HDMI
matches "an input that is not there is refused with those that are" 'v4l2.input.*S-Video' \
	"$(said error)"
capture 2 input=1 standard=PAL-XYZ
matches "a standard that is not known is refused with those that are" 'v4l2.standard.*PAL' \
	"$(said error)"

# ---- fields ----
v4l2-ctl -d "$in" -i 1 >/dev/null
control "$in" test_pattern=15 osd_text_mode=2
fields_come_right PAL 720x576 driver interlaced 255
fields_come_right PAL 720x576 interlaced interlaced 255
fields_come_right PAL 720x576 sequential top-bottom 255
fields_come_right PAL 720x576 top top 0
fields_come_right PAL 720x576 bottom "bottom bottom-first" 255
fields_come_right NTSC 720x480 interlaced "interlaced bottom-first" 0
fields_come_right NTSC 720x480 sequential "bottom-top bottom-first" 0
fields_come_right NTSC 720x480 alternate "pair bottom-first" 0
fields_come_right NTSC 720x480 top top 0
fields_come_right NTSC 720x480 bottom "bottom bottom-first" 255

# A check that cannot fail is none: the picture of the last capture is white all over.
if lines 0 255 >/dev/null; then
	echo "a white picture passed for a woven one" | not_ok "a wrong line is noticed"
else
	ok "a wrong line is noticed"
fi

# The same lines in formats of other layouts.
slack=1
for format in YUYV NV12 RGB24; do
	for key in PAL:interlaced PAL:sequential NTSC:alternate; do
		capture 2 input=1 standard="${key%:*}" field="${key#*:}" format=$format
		check "$key, woven in $format" lines 0 255
	done
done

# ---- pictures of ours, played into the S-Video output, come in through the driver ----
# svideo_loop FIELD ROWS
svideo_loop() {
	local out format="width=720,height=$2,pixelformat=RGB3,field=$1"
	out=$(video_node vivid-000-vid-out)
	v4l2-ctl -d "$out" -s pal >/dev/null
	v4l2-ctl -d "$in" -s pal >/dev/null
	v4l2-ctl -d "$out" --set-fmt-video-out "$format" &&
		v4l2-ctl -d "$in" --set-fmt-video "$format" &&
		control "$in" loop_video=1 osd_text_mode=2
}
"$tools/picture" chart background 720 576 "$VM_OUT/chart.png"
"$tools/picture" raw RGB24 "$VM_OUT/chart.png" "$VM_OUT/chart.raw"
arrives() { # key
	capture 3 input=1 standard=PAL field="$1" format=RGB24 &&
		"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/frame.png" \
			within=0 >"$VM_OUT/compared"
}
picture=$VM_OUT/frame.png
svideo_loop interlaced 576 >/dev/null
play 0 "$VM_OUT/chart.raw"
if eventually arrives interlaced; then
	ok "S-Video: our picture, interlaced, arrives woven to the bit"
else
	cat "$VM_OUT/said" "$VM_OUT/compared" 2>/dev/null |
		not_ok "S-Video: our picture, interlaced, arrives woven to the bit"
fi
stop_playing
picture=-
control "$in" loop_video=0 test_pattern=15

# ---- faults ----
# At a hundred ticks a second, as here, vivid itself loses every second one of PAL's fields in turn.
in_turn() { # frames
	capture "$1" input=1 standard=NTSC format=YUYV field=alternate
}
control "$in" percentage_of_dropped_buffers=20
in_turn 25
equal "fields that are lost do not stop pairs" 25 "$(said taken)"
holds "a field without its other one is counted broken" "$(said broken) > 0"
check "no pair is made of two fields of one kind" lines 0 255
control "$in" percentage_of_dropped_buffers=0

capture_and control "$in" inject_v4l2_buf_flag_error=1 -- 25 input=1 standard=NTSC format=YUYV \
	field=alternate
equal "a field flagged corrupt does not stop pairs" 25 "$(said taken)"
holds "a pair with a field flagged corrupt is counted broken" "$(said broken) > 0"

for wrap in sequence_number:1 timestamp:1 timestamp:2; do
	control "$in" "wrap_${wrap%:*}=${wrap#*:}"
	in_turn 40
	equal "wrap_$wrap: frames go on" 40 "$(said taken)"
	# A busy host loses some; a wrap that is taken for a loss makes millions.
	holds "wrap_$wrap: no loss is made up" "$(said lost) + $(said broken) < 1000"
	equal "wrap_$wrap: time goes on" 0 "$(said backwards)"
	control "$in" "wrap_${wrap%:*}=0"
done

# ---- signal ----
v4l2-ctl -d "$in" -s pal >/dev/null
capture_and control "$in" standard_signal_mode=1 -- 500 input=1 format=YUYV
equal "a signal that goes is noticed while streaming" ESTALE "$(said code)"
capture 2 input=1 format=YUYV
equal "without a signal the camera says so" "no signal" "$(said situation)"
equal "and does not open" ENOLINK "$(said code)"
control "$in" standard_signal_mode=2
capture 2 input=1 format=YUYV
equal "a signal that is not stable is none" "ENOLCK no signal" "$(said code) $(said situation)"
control "$in" standard_signal_mode=0
capture 2 input=1 format=YUYV
equal "the signal is back" 720x576 "$(said size)"

ntsc_now() {
	control "$in" standard_signal_mode=4 && control "$in" standard=0 &&
		control "$in" standard_signal_mode=4
}
capture_and ntsc_now -- 500 input=1 format=YUYV
equal "another standard is noticed while streaming" ESTALE "$(said code)"
capture 2 input=1 format=YUYV
equal "and taken over at the next opening" 720x480 "$(said size)"
control "$in" standard_signal_mode=0

# ---- controls ----
v4l2-ctl -d "$in" -c brightness=200
capture 2 input=1 controls="brightness=140, contrast = 100"
equal "controls are set" "brightness: 140 contrast: 100" \
	"$(v4l2-ctl -d "$in" -C brightness,contrast | tr '\n' ' ' | sed 's/ $//')"
if grep -q controls "$VM_OUT/said"; then
	not_ok "what is taken is not remarked on" <"$VM_OUT/said"
else
	ok "what is taken is not remarked on"
fi
capture 2 input=1 controls="read_only_integer_32_bits=3"
matches "a control that can only be read is named" \
	'read_only_integer_32_bits=3 is refused: it can only be read' "$(cat "$VM_OUT/said")"
equal "and does not keep the camera from opening" 2 "$(said taken)"
capture 2 input=1 controls="contrast=999"
matches "a value out of range is named" 'contrast=999' "$(cat "$VM_OUT/said")"
capture 2 input=1 controls="menu=menu_item_3, boolean=no"
equal "a menu by its entry's name" "menu: 3 (Menu Item 3)" "$(v4l2-ctl -d "$in" -C menu)"
capture 2 input=1 controls="gain_automatic=yes, gain=77"
matches "a manual value while the automatic is on comes back as another" 'gain=77' \
	"$(cat "$VM_OUT/said")"
capture 2 input=1 controls="gain_automatic=no, gain=77"
equal "with the automatic off first it stays" "gain: 77" "$(v4l2-ctl -d "$in" -C gain)"
capture 2 input=1 controls="brihgtness=3"
matches "a misspelt control is named with the nearest" 'brihgtness.*perhaps "brightness"' \
	"$(cat "$VM_OUT/said")"
capture 2 input=1 controls="brightness"
matches "controls that cannot be read are refused" 'controls.*name=value' "$(said error)"
"$INLAY" devices >"$VM_OUT/devices" 2>&1
matches "devices lists controls as the configuration writes them" 'control gain_automatic 0..1' \
	"$(cat "$VM_OUT/devices")"
matches "devices lists the entries of menus" 'control menu=menu_item_3 \(3\)' \
	"$(cat "$VM_OUT/devices")"
matches "devices lists inputs with their standards" 'input 1 "S-Video 0" PAL NTSC SECAM' \
	"$(cat "$VM_OUT/devices")"
unload vivid

# ---- found again: two cameras of one name, unbound and bound in the other order ----
load vivid n_devs=2 num_inputs=1 input_types=0x0
driver=/sys/bus/platform/drivers/vivid
before=$(video_node vivid-001-vid-cap)
in=platform:vivid-001
capture 2 format=YUYV
equal "a camera by its bus" vivid "$(said name)"
matches "which node it is" "$before" "$(cat "$VM_OUT/said")"
mkdir -p /dev/v4l/by-id
ln -s "../../${before##*/}" /dev/v4l/by-id/usb-Test_Camera-video-index0
in=usb-Test_Camera-video-index0
capture 2 format=YUYV
equal "a camera by the name of its link" 2 "$(said taken)"
in=/dev/v4l/by-id/usb-Test_Camera-video-index0
capture 2 format=YUYV
equal "a camera by its link" 2 "$(said taken)"
"$INLAY" devices >"$VM_OUT/devices" 2>&1
matches "devices lists the link" 'link /dev/v4l/by-id/usb-Test_Camera' "$(cat "$VM_OUT/devices")"
in=vivid
capture 2 format=YUYV
matches "a name that two cameras have: the others are said" \
	'"vivid" is also the name of .*platform:vivid-00' "$(cat "$VM_OUT/said")"
in=platform:vivid-001
vivid_gone() {
	echo vivid.0 >$driver/unbind
}
if [ -e $driver/vivid.0 ]; then
	capture_and vivid_gone -- 500 format=YUYV
	equal "a camera that goes while it streams is named so" "no device" "$(said situation)"
	capture 2 format=YUYV
	equal "while it is away it is said" "no device ENODEV" "$(said situation) $(said code)"
	load vimc # takes the lowest numbers
	echo vivid.0 >$driver/bind
	after=$(video_node vivid-001-vid-cap)
	equal "it is back under another number" yes "$([ "$before" != "$after" ] && echo yes)"
	capture 2 format=YUYV
	equal "and is found again by its bus" "2 fine" "$(said taken) $(said situation)"
	matches "as the node that it is now" "$after:" "$(cat "$VM_OUT/said")"
	unload vimc
else
	echo "no $driver/vivid.0" | not_ok "vivid can be unbound"
fi
unload vivid
