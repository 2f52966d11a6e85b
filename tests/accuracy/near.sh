#!/bin/bash
# SPDX-License-Identifier: MIT
# What it costs that all light is taken as coming from afar: a box of 0.3 m under a lamp at several distances, and fisheyes
# at several places, against path-traced truth.
#     BUILD=build/x tests/accuracy/near.sh [SIZE [SAMPLES]]     the table, in Markdown (make near)
# Pictures and table are left in build/accuracy/near. Nothing passes or fails.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/accuracy/method.sh
. tests/accuracy/method.sh
work=build/accuracy/near
log=$work/log.txt
size=${1:-160x120} samples=${2:-512}

# The lamp's direction from the foot of the object: from the left and the front, so that the shadow falls to the right.
height=47 azimuth=225
# Its angle is the same at each distance, and it gives white ground at the foot a radiance of 0.45; the even sky gives 0.15.
angle=0.03 light=0.45 sky=0.15

# place DISTANCE HEIGHT AZIMUTH
place() {
	awk -v d="$1" -v h="$2" -v a="$3" 'BEGIN { r = atan2(0, -1) / 180
		printf "%.5f,%.5f,%.5f", d * cos(h * r) * cos(a * r), d * cos(h * r) * sin(a * r), d * sin(h * r) }'
}

# named DISTANCE FISHEYE: the configuration that tells where lamp and fisheye are
named() {
	local radius
	radius=$(awk -v d="$1" -v a=$angle 'BEGIN { print a * d }')
	printf '[lamp key]\nposition = %s\nradius = %s\n[fisheye]\nposition = %s\n' \
		"$(place "$1" $height $azimuth | tr , ' ')" "$radius" "${2//,/ }"
}

# truth DISTANCE OPTION...
truth() {
	local lamp
	lamp=$(place "$1" $height $azimuth)$(awk -v d="$1" -v a=$angle -v e=$light -v h=$height 'BEGIN {
		l = e / (a * a * sin(h * atan2(0, -1) / 180)); printf ",%g,%g,%g,%g", a * d, l, l, l }')
	shift
	"$build/inlay-bake" truth --lamp "$lamp" --panorama "$work/even.pfm" --exposure $sky --size "$size" --quiet "$@" \
		"$work/spot.scene" >>"$log" 2>&1 || fail "inlay-bake truth --lamp $lamp failed"
}

# flat FILE WIDTH HEIGHT BYTES: a picture of one grey
flat() {
	local pixels
	mapfile -t pixels < <(seq $(($2 * $3)))
	printf 'Pf\n%d %d\n-1.0\n' "$2" "$3" >"$1"
	printf "$4%.0s" "${pixels[@]}" >>"$1"
}

rm -rf "$work"
mkdir -p "$work"
sed s/0[.]5/0.25/g bake/demo/box.obj >"$work/box.obj" # twice as tall as wide
cat >"$work/spot.scene" <<'SCENE'
[camera]
position = 0.55 -1.1 0.75
look_at = 0.12 0.06 0.1
field_deg = 45
[render]
bounces = 3
[ground]
[material clay]
colour = 0.72 0.62 0.50
[object box]
file = box.obj
material = clay
scale = 0.3
rotate = 0 0 10
stand = yes
SCENE
flat "$work/even.pfm" 8 4 '\x00\x00\x80\x3f'
flat "$work/black.pfm" "${size%x*}" "${size#*x}" '\x00\x00\x00\x00'
# 20 degrees hold the lamp as seen from each fisheye.
bake 9 --size "$size" --samples 128 --fine "$azimuth $height 20 36" --quiet
truth 1 --samples 16 --background "$work/black.pfm" -o "$work/object.pfm"
{
	echo "| lamp at | fisheye | lamp | PSNR dB | RMS | max | edge px | object % |"
	echo "|---|---|---|---|---|---|---|---|"
	for distance in 1 1.5 2.5 4 1000; do
		truth $distance --samples "$samples" --background-out "$work/$distance-background.pfm" \
			-o "$work/$distance-truth.pfm"
		while read -r name at; do
			eye=$work/$distance-$name
			truth $distance --samples 1 --background "$work/$distance-background.pfm" --fisheye="$at" \
				--fisheye-size 512 --fisheye-out "$eye-fisheye.pfm" --background-out "$eye-background.png" \
				-o "$work/none.pfm"
			named "$distance" "$at" >"$eye.conf"
			for way in afar named; do
				if [ $way = named ]; then
					composite "$distance-$name" 9 "$eye-$way.pfm" --config "$eye.conf"
				else
					composite "$distance-$name" 9 "$eye-$way.pfm"
				fi
				read -r psnr rms max < <(compare "$eye-$way.pfm" "$work/$distance-truth.pfm" \
					--difference "$eye-$way-difference.png")
				read -r edge object < <(python3 tests/accuracy/near.py "$work/$distance-truth.pfm" \
					"$eye-$way.pfm" "$work/$distance-background.pfm" "$work/object.pfm")
				echo "| $distance | $name | $way | $psnr | $rms | $max | $edge | $object |"
			done
		done <<-PLACES
			foot 0,0,0
			middle 0,0,0.15
			towards $(place 0.3 0 $azimuth)
			away $(place -0.3 0 $azimuth)
			left $(place 0.3 0 $((azimuth + 90)))
			right $(place -0.3 0 $((azimuth + 90)))
		PLACES
	done
} | tee "$work/table.md"
