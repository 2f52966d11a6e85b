#!/bin/bash
# SPDX-License-Identifier: MIT
# The V4L2 driver on vivid's webcam: every format, single- and multi-planar, colours against what
# the test pattern is defined to be, strides, rates, timestamps, faults.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

# The value of NAME in the output of the last capture.
said() {
	awk -v name="$1" '$1 == name { sub(/^[^ ]* /, ""); print; exit }' "$VM_OUT/said"
}

# capture FRAMES name=value...: from $in, 640x480; the last frame goes to $VM_OUT/frame.png.
capture() {
	local frames=$1
	shift
	rm -f "$VM_OUT/frame.png"
	"$tools/capture" v4l2 "$frames" "$VM_OUT/frame.png" "device=$in" width=640 height=480 \
		rate=25 "$@" >"$VM_OUT/said" 2>&1
}

# The same, and a control of the device is pressed once it streams.
capture_and_press() { # control, then as above
	local control=$1
	shift
	: >"$VM_OUT/said"
	capture "$@" &
	eventually grep -q '^stride' "$VM_OUT/said"
	v4l2-ctl -d "$in" -c "$control=1"
	wait $!
}

# The middle of bar 0..7 holds one colour. In R'G'B' it is exact; vivid truncates Y'CbCr, which costs
# up to 1.164 + 1.8556 * 255 / 224 = 3.3 levels, and rounding 0.5.
#     bar N R G B
slack=4
bar() {
	local low_r low_g low_b high_r high_g high_b
	read -r low_r low_g low_b high_r high_g high_b < <(
		"$tools/picture" colour "$VM_OUT/frame.png" $(($1 * 80 + 20)) 240 40 40)
	[ "${low_r:-999}" -ge $(($2 - slack)) ] && [ "$high_r" -le $(($2 + slack)) ] &&
		[ "$low_g" -ge $(($3 - slack)) ] && [ "$high_g" -le $(($3 + slack)) ] &&
		[ "$low_b" -ge $(($4 - slack)) ] && [ "$high_b" -le $(($4 + slack)) ] && return
	echo "bar $1: expected $2 $3 $4, is $low_r..$high_r $low_g..$high_g $low_b..$high_b"
	return 1
}

# The 75 % colour bars: 191 and 0 in every combination.
colour_bars() {
	local failed=0
	bar 0 191 191 191 || failed=1
	bar 1 191 191 0 || failed=1
	bar 2 0 191 191 || failed=1
	bar 3 0 191 0 || failed=1
	bar 4 191 0 191 || failed=1
	bar 5 191 0 0 || failed=1
	bar 6 0 0 191 || failed=1
	bar 7 0 0 0 || failed=1
	return $failed
}

# The same as vivid's grey: the luma of Rec. 709. It is of full range, though vivid does not say so.
grey_bars() {
	local failed=0
	bar 0 191 191 191 || failed=1
	bar 3 137 137 137 || failed=1
	bar 5 41 41 41 || failed=1
	bar 6 14 14 14 || failed=1
	bar 7 0 0 0 || failed=1
	return $failed
}

colours_of_formats() { # how it was loaded
	local format bars range
	in=$(video_node vivid-000-vid-cap)
	control "$in" test_pattern=0 osd_text_mode=2
	for format in YUYV UYVY NV12 RGB24 BGR24 BGRX GREY; do
		bars=colour_bars
		range=auto
		slack=4
		case $format in
		RGB24 | BGR24 | BGRX) slack=0 ;;
		GREY)
			bars=grey_bars
			range=full
			slack=1
			;;
		esac
		if capture 2 "format=$format" range=$range && [ "$(said format)" = $format ]; then
			check "$1: $format holds the test pattern's colours" $bars
		else
			not_ok "$1: $format" <"$VM_OUT/said"
		fi
	done
	slack=4
}

# ---- single-planar ----
load vivid n_devs=1 input_types=0xe4
colours_of_formats "single-planar"
equal "a wanted size is taken" 640x480 "$(said size)"

for encoding in 1:bt601 2:bt709; do
	for quantization in 1:full 2:limited; do
		control "$in" "y_cbcr_encoding=${encoding%:*}" "quantization=${quantization%:*}"
		what="${encoding#*:}, ${quantization#*:} range"
		capture 2 format=YUYV
		equal "$what is read from the device" "${encoding#*:} ${quantization#*:}" \
			"$(said matrix) $(said range)"
		check "$what gives the same colours" colour_bars
	done
done
# R'G'B' has a range too; widening it rounds by half a level and the sender by half of a wider one.
slack=1
for format in RGB24 BGR24 BGRX; do
	control "$in" y_cbcr_encoding=0 quantization=2
	capture 2 format=$format
	equal "limited range of $format is read from the device" limited "$(said range)"
	check "limited range of $format gives the same colours" colour_bars
done
slack=4

# A device that lies is overruled by the settings: bt709 full said to be bt709 limited is wrong.
control "$in" y_cbcr_encoding=2 quantization=1
capture 2 format=YUYV range=limited
if colour_bars >/dev/null; then
	echo "the wrong range went unnoticed" | not_ok "a range that is set overrules the device's"
else
	ok "a range that is set overrules the device's"
fi
control "$in" y_cbcr_encoding=0 quantization=0

# A test pattern turned by the device itself must come out turned: our own code flips nothing.
control "$in" sensor_flipped_horizontally=1
capture 2 format=BGRX
check "a mirrored sensor gives a mirrored picture" bar 7 191 191 191
control "$in" sensor_flipped_horizontally=0

# ---- a control is changed while frames come, which calibrations do ----
capture 12 format=BGRX
check "the black bar is black" bar 7 0 0 0
capture 12 format=BGRX change=brightness=200
equal "a control that is changed on the way stops nothing" 12 "$(said taken)"
equal "the device has its value" "brightness: 200" "$(v4l2-ctl -d "$in" --get-ctrl=brightness)"
if bar 7 0 0 0 >/dev/null; then
	not_ok "it shows in the picture" <"$VM_OUT/said"
else
	ok "it shows in the picture"
fi
capture 12 format=BGRX change=no_such_control=1
equal "a control that the device has not ends nothing but the program" "fine" "$(said situation)"
matches "and is named" no_such_control "$(said error)"
capture 12 format=BGRX change=brightness=bright
matches "so is a value that is none" brightness "$(said error)"
control "$in" brightness=128

for rate in 10 25; do
	capture 12 format=YUYV rate=$rate
	holds "rate $rate is set and read back" "$(said rate) == $rate"
	holds "rate $rate is measured" \
		"$(said measured_rate) > $rate * 0.9 && $(said measured_rate) < $rate * 1.1"
	equal "timestamps rise at rate $rate" 0 "$(said backwards)"
done

capture 5 format=YUYV hold=300
holds "a slow reader gets the newest frame, the older are counted lost" "$(said lost) > 5"

"$tools/capture" v4l2 2 "$VM_OUT/frame.png" "device=$in" >"$VM_OUT/said" 2>&1
matches "without wishes the device's own choice is taken" '^[0-9]+x[0-9]+$' "$(said size)"

# ---- faults ----
control "$in" percentage_of_dropped_buffers=30
capture 40 format=YUYV
equal "a device that drops frames goes on" 40 "$(said taken)"
holds "dropped frames are counted lost" "$(said lost) > 0"
control "$in" percentage_of_dropped_buffers=0

control "$in" wrap_sequence_number=1
capture 140 format=YUYV rate=60
holds "a sequence number that wraps around is no loss" "$(said lost) < 1000"
holds "it did wrap" "$(said frames) > 128"
control "$in" wrap_sequence_number=0

capture_and_press inject_v4l2_buf_flag_error 40 format=YUYV
equal "a frame flagged corrupt does not stop the stream" 40 "$(said taken)"
equal "a frame flagged corrupt is counted broken" 1 "$(said broken)"

capture_and_press inject_fatal_streaming_error 100 format=YUYV
matches "a fatal error ends the stream and is said" '.' "$(said error)"
check "the camera can be opened again after it" capture 2 format=YUYV

capture_and_press disconnect 100 format=YUYV
equal "an unplugged camera is named so" "no device" "$(said situation)"
check "the camera can be opened after it is plugged in again" capture 2 format=YUYV

v4l2-ctl -d "$in" -c inject_vidioc_streamon_error=1
if capture 2 format=YUYV; then
	not_ok "a stream that does not start is an error" <"$VM_OUT/said"
else
	matches "a stream that does not start is an error" "$in" "$(said error)"
fi

v4l2-ctl -d "$in" --stream-mmap=3 --stream-count=1000 --stream-to=/dev/null >/dev/null 2>&1 &
other=$!
eventually sh -c "! v4l2-ctl -d $in --set-fmt-video=width=320,height=180"
v4l2-ctl -d "$in" -c brightness=111
capture 2 format=YUYV controls=brightness=77
equal "a camera that another program uses is named so" busy "$(said situation)"
equal "and left as it is" "brightness: 111" "$(v4l2-ctl -d "$in" --get-ctrl=brightness)"
kill $other
wait $other 2>/dev/null

"$tools/capture" v4l2 1 "$VM_OUT/frame.png" device=/dev/video99 >"$VM_OUT/said" 2>&1
equal "a camera that is not there is named so" "no device" "$(said situation)"
"$tools/capture" v4l2 1 "$VM_OUT/frame.png" device=/dev/null >"$VM_OUT/said" 2>&1
matches "a file that is no camera is refused in words" /dev/null "$(said error)"
unload vivid

# ---- multi-planar: YUYV starts 128 bytes into its plane there ----
load vivid n_devs=1 input_types=0xe4 multiplanar=2
colours_of_formats "multi-planar"
unload vivid

# ---- HDMI: pictures of ours, played into the output, come in through the driver ----
load vivid n_devs=1 num_inputs=1 input_types=3 num_outputs=1 output_types=1
in=$(video_node vivid-000-vid-cap)
"$tools/picture" chart background 640 480 "$VM_OUT/chart.png"
# Y'CbCr: rounded once when the chart is made, by up to half a step of each: 0.5 * 1.164 +
# 0.5 * 1.772 * 255 / 224 = 1.6 levels, and once when it is decoded.
for format in RGB24:RGB3:0 BGR24:BGR3:0 BGRX:XR24:0 YUYV:YUYV:2 UYVY:UYVY:2 NV12:NV12:2; do
	IFS=: read -r ours theirs within <<<"$format"
	hdmi_loop 0 "$theirs" >/dev/null
	"$tools/picture" raw "$ours" "$VM_OUT/chart.png" "$VM_OUT/chart.raw"
	play 0 "$VM_OUT/chart.raw"
	arrives() {
		"$tools/capture" v4l2 2 "$VM_OUT/frame.png" "device=$in" "format=$ours" \
			matrix=bt601 $range &&
			"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/frame.png" \
				"within=$within" >"$VM_OUT/compared"
	}
	range=""
	case $ours in YUYV | UYVY | NV12) range=range=limited ;; esac
	if eventually arrives; then
		ok "HDMI: a picture arrives in $ours within $within levels"
	else
		not_ok "HDMI: a picture arrives in $ours within $within levels" <"$VM_OUT/compared"
	fi
	stop_playing
done
control "$in" dv_timings_signal_mode=1
capture 2
equal "HDMI: a cable that is not plugged in is named so" "no signal" "$(said situation)"
control "$in" dv_timings_signal_mode=0
unload vivid

# ---- renumbered: another camera takes the first numbers ----
load vimc
load vivid n_devs=1 input_types=0xe4
in=$(video_node vivid-000-vid-cap)
[ "$in" != /dev/video0 ] || echo "vivid is still /dev/video0" | not_ok "vimc takes the first number"
control "$in" test_pattern=0 osd_text_mode=2
capture 2 format=YUYV
check "vivid behind vimc, by its new number" colour_bars
bus=$(v4l2-ctl -d "$in" --info | sed -n 's/.*Bus info *: //p' | head -n 1)
in=$bus
capture 2 format=YUYV
check "vivid behind vimc, by its place ($bus)" colour_bars
unload vivid
unload vimc
