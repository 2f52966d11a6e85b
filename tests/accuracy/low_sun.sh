#!/bin/bash
# SPDX-License-Identifier: MIT
# Small lights: domes that are finer around a low sun and the lamps of a studio beside whole domes, against
# path-traced truth.
#     BUILD=build/x tests/accuracy/low_sun.sh            the table, in Markdown: spot, the demo's cow, the demo's box
#     BUILD=build/x tests/accuracy/low_sun.sh --quick    a small one of its rows as a test, in TAP
# The sun's panorama is made (low_sun.py). Pictures and table are left in build/accuracy/low_sun.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/accuracy/method.sh
. tests/accuracy/method.sh
work=build/accuracy/low_sun

# set_mesh FILE [SCALE]
set_mesh() {
	sed -e "s/spot.obj/$1/" -e "s/^stand.*/&\nscale = ${2:-1}/" tests/accuracy/spot.scene >"$work/spot.scene"
}

# set_sky PANORAMA EXPOSURE SIZE SAMPLES: a white ground has radiance 0.6 or so
set_sky() {
	sky=$1
	"$build/inlay-bake" truth --panorama "$1" --exposure "$2" --size "$3" --samples "$4" --quiet \
		--background-out "$work/sun-background.png" --fisheye-out "$work/sun-fisheye.pfm" \
		-o "$work/sun-truth.pfm" "$work/spot.scene" >>"$log" 2>&1 ||
		fail "inlay-bake truth under $1 failed"
}

# set_sun HEIGHT AZIMUTH SIZE SAMPLES
set_sun() {
	python3 tests/accuracy/low_sun.py "$1" "$2" >"$work/sun.pfm" || fail "low_sun.py failed"
	set_sky "$work/sun.pfm" 0.25 "$3" "$4"
}

# Milliseconds of a frame in fast mode under the panorama, by one thread.
frame_ms() {
	"$build/inlay" bench --basis "$work/f$1.inlay" --panorama "$sky" --thesis no --kernel auto --threads 1 \
		--repeat 9 --json 2>>"$log" | python3 -c '
import json, sys
rows = [row for row in json.load(sys.stdin)["rows"] if row["what"] == "fast"]
print("%.3f" % min(row["least_ms"] for row in rows))'
}

# row LIGHTING NAME OPTION...: one line of the table
row() {
	local lighting=$1 name=$2 psnr rms most lights begin=$SECONDS seconds
	shift 2
	bake "$name" --samples 32 --size 192x144 "$@"
	seconds=$((SECONDS - begin))
	lights=$("$build/inlay-bake" info --json "$work/f$name.inlay" | sed -n 's/.*"lights": \([0-9]*\).*/\1/p')
	composite sun "$name" "$work/$lighting-$name.png"
	read -r psnr rms most < <(compare "$work/$lighting-$name.png" "$work/sun-truth.pfm")
	echo "| $lighting | $name | $lights | $psnr | $rms | $most | $(frame_ms "$name") | $seconds |" \
		"$(du -k "$work/f$name.inlay" | awk '{ printf "%.1f", $1 * 1.024 / 1000 }') |"
}

table() {
	local sun height azimuth mesh scale

	cp bake/demo/cow.glb "$work"
	ln -sfn "$(realpath "$data/mesh/spot.obj")" "$work/spot.obj"
	echo "| lighting | dome | lights | PSNR dB | RMS | max | frame ms | bake s | file MB |"
	echo "|---|---|---|---|---|---|---|---|---|"
	set_mesh spot.obj
	for sun in "15 30" "8.5 152"; do
		read -r height azimuth <<<"$sun"
		set_sun "$height" "$azimuth" 192x144 2048
		row "sun-$height" 9
		row "sun-$height" 9:18-within-3 --fine "$azimuth $height 3 18"
		row "sun-$height" 9:36-within-3 --fine "$azimuth $height 3 36"
		row "sun-$height" 9:72-within-0.5 --fine "$azimuth $height 0.5 72"
		row "sun-$height" 18
	done
	for mesh in "cow.glb 4.5" "box.obj 0.9"; do
		read -r mesh scale <<<"$mesh"
		set_mesh "$mesh" "$scale"
		set_sun 8.5 152 192x144 2048
		row "sun-8.5-${mesh%.*}" 9
		row "sun-8.5-${mesh%.*}" 9:72-within-0.5 --fine "152 8.5 0.5 72"
	done
	set_mesh spot.obj
	set_sky "$data/hdri/studio_small_03_1k.hdr" 0.136 192x144 2048
	"$build/inlay-bake" sky "$sky" -o "$work/studio.fine" >>"$log" 2>&1 || fail "inlay-bake sky failed"
	row studio 9
	row studio 9:sky --fine "$work/studio.fine"
	row studio 18
}

quick() {
	local whole fine rest

	set_mesh box.obj 0.9
	set_sun 8.5 152 64x48 400
	bake 9 --samples 16 --size 64x48 --quiet
	bake 9:fine --samples 16 --size 64x48 --quiet --fine "152 8.5 0.5 72"
	composite sun 9 "$work/quick.png"
	read -r whole rest < <(compare "$work/quick.png" "$work/sun-truth.pfm")
	composite sun 9:fine "$work/quick.png"
	read -r fine rest < <(compare "$work/quick.png" "$work/sun-truth.pfm")
	if awk "BEGIN { exit !($fine >= 40 && $fine >= $whole + 6) }"; then
		echo "ok 1 - finer lights around a low sun: $fine dB, $whole without"
	else
		echo "not ok 1 - finer lights around a low sun: $fine dB, expected 40 and 6 more than $whole without"
	fi
	echo "1..1"
}

prepare_made() {
	rm -rf "$work"
	log=$work/log.txt
	mkdir -p "$work"
	: >"$log"
	cp bake/demo/box.obj "$work/box.obj"
}

case ${1:-} in
'')
	prepare_made
	table | tee "$work/table.md"
	;;
--quick)
	quick=yes
	prepare_made
	quick
	;;
*)
	echo "usage: low_sun.sh [--quick]" >&2
	exit 2
	;;
esac
