#!/bin/bash
# SPDX-License-Identifier: MIT
# A low sun: domes that are finer around it beside whole domes, against path-traced truth.
#     BUILD=build/x tests/accuracy/low_sun.sh            the table, in Markdown: spot, the demo's cow, the demo's box
#     BUILD=build/x tests/accuracy/low_sun.sh --quick    a small one of its rows as a test, in TAP
# The panorama is made (low_sun.py). Pictures and table are left in build/accuracy/low_sun.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/accuracy/method.sh
. tests/accuracy/method.sh
work=build/accuracy/low_sun
height=8.5
azimuth=152
exposure=0.25 # a white ground has radiance 0.6 or so

# set_scene MESH SIZE SAMPLES_TRUE
set_scene() {
	sed -e "s/spot.obj/$1.obj/" tests/accuracy/spot.scene >"$work/spot.scene"
	[ "$1" = spot ] || sed -i -e 's/^rotate.*/rotate = 0 0 30/' -e 's/^stand.*/&\nscale = 0.9/' "$work/spot.scene"
	"$build/inlay-bake" truth --panorama "$work/sun.pfm" --exposure $exposure --size "$2" --samples "$3" --quiet \
		--background-out "$work/sun-background.png" --fisheye-out "$work/sun-fisheye.pfm" \
		-o "$work/sun-truth.pfm" "$work/spot.scene" >>"$log" 2>&1 ||
		fail "inlay-bake truth of $1 failed"
}

# Milliseconds of a frame in fast mode under the panorama, by one thread.
frame_ms() {
	"$build/inlay" bench --basis "$work/f$1.inlay" --panorama "$work/sun.pfm" --thesis no --kernel auto --threads 1 \
		--repeat 9 --json 2>>"$log" | python3 -c '
import json, sys
rows = [row for row in json.load(sys.stdin)["rows"] if row["what"] == "fast"]
print("%.3f" % min(row["median_ms"] for row in rows))'
}

# row MESH NAME OPTION...: one line of the table
row() {
	local mesh=$1 name=$2 psnr rms most begin=$SECONDS
	shift 2
	bake "$name" --samples 32 --size 192x144 "$@"
	composite sun "$name" cell "$work/$mesh-$name.png"
	read -r psnr rms most < <(compare "$work/$mesh-$name.png" "$work/sun-truth.pfm")
	echo "| $mesh | $name $* | $psnr | $rms | $most | $(frame_ms "$name") | $((SECONDS - begin)) |" \
		"$(du -k "$work/f$name.inlay" | awk '{ printf "%.1f", $1 / 1000 }') |"
}

table() {
	"$build/make-cow" "$work" >>"$log" 2>&1 || fail "make-cow failed"
	ln -sfn "$(realpath "$data/mesh/spot.obj")" "$work/spot.obj"
	echo "| mesh | dome | PSNR dB | RMS | max | frame ms | bake s | file MB |"
	echo "|---|---|---|---|---|---|---|---|"
	for mesh in spot cow box; do
		set_scene $mesh 192x144 2048
		row $mesh 9
		row $mesh 9:fine --fine "$azimuth $height 0.5 72"
		row $mesh 9:tents --lights tents --fine "$azimuth $height 0.5 72"
		row $mesh 18
		[ $mesh != spot ] || row $mesh 36
	done
}

quick() {
	local whole fine rest

	set_scene box 64x48 400
	bake 9 --samples 16 --size 64x48 --quiet
	bake 9:fine --samples 16 --size 64x48 --quiet --fine "$azimuth $height 0.5 72"
	composite sun 9 cell "$work/quick.png"
	read -r whole rest < <(compare "$work/quick.png" "$work/sun-truth.pfm")
	composite sun 9:fine cell "$work/quick.png"
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
	python3 tests/accuracy/low_sun.py $height $azimuth >"$work/sun.pfm" || fail "low_sun.py failed"
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
