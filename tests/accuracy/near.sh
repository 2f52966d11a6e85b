#!/bin/bash
# SPDX-License-Identifier: MIT
# What it costs that all light is taken as coming from afar: a box of 0.3 m under a lamp at several distances, and fisheyes
# at several places, against path-traced truth.
#     BUILD=build/x tests/accuracy/near.sh [box|spot [SIZE [SAMPLES]]]     the table, in Markdown (make near)
# spot is a scene that nothing was chosen on: a cow with the lamp behind it, so that the sides that one sees are lit by
# what bounces.
# Pictures and table are left in build/accuracy/near. Nothing passes or fails.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/accuracy/method.sh
. tests/accuracy/method.sh
scene=${1:-box} size=${2:-160x120} samples=${3:-512}
work=build/accuracy/near-$scene
log=$work/log.txt

# The lamp's direction from the foot of the object; 225: from the left and the front, so that the shadow falls to the right.
case $scene in
box) height=47 azimuth=225 mesh=bake/demo/box.obj scale=0.3 turn=10 distances='1 1.5 2.5 4 1000' ;;
spot) height=62 azimuth=110 mesh=../shared/data/mesh/spot.obj scale=0.18 turn=40 distances='1.2 2' ;;
*) fail "$scene: expected box or spot" ;;
esac
[ -e "$mesh" ] || fail "$mesh is missing"
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
case $scene in
box) sed s/0[.]5/0.25/g "$mesh" >"$work/object.obj" ;; # twice as tall as wide
*) cp "$mesh" "$work/object.obj" ;;
esac
cat >"$work/spot.scene" <<SCENE
[camera]
position = 0.55 -1.1 0.75
look_at = 0.12 0.06 0.1
field_deg = 45
[render]
bounces = 3
[ground]
[material clay]
colour = 0.72 0.62 0.50
[object it]
file = object.obj
material = clay
scale = $scale
rotate = 0 0 $turn
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
	for distance in $distances; do
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
