#!/bin/bash
# SPDX-License-Identifier: MIT
# Stands the demo's cow among the people of a real film and plays it through inlay. `make film` calls it.
#     BUILD=build/x tests/film/film.sh [FOLDER [OPTION...]]
# Leaves film.mp4, crossings.png and film.html in FOLDER (film/); options are for `inlay run`.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
out=${1:-film}
options=("${@:2}")
work=$out/work
film=/usr/share/doc/opencv-doc/examples/data/vtest.avi
boxes=${INLAY_SHARED_DATA:-../shared/data}/film/PETS2009-S2L1.xml.gz
mkdir -p "$work"

for file in tests/film/cow.scene tests/film/campus.ini bake/demo/cow.glb; do
	cmp -s "$file" "$work/$(basename "$file")" || cp "$file" "$work/"
done
if [ ! "$work/cow.inlay" -nt "$work/cow.scene" ] || [ ! "$work/cow.inlay" -nt "$work/campus.ini" ]; then
	echo "film: baking the cow on the campus (two minutes on two cores)"
	"$build/inlay-bake" render --quiet --no-preview -o "$work/cow.inlay" "$work/cow.scene"
fi
if [ ! -e "$work/film.y4m" ]; then
	[ -e "$film" ] || gunzip -c "$film.gz" >"$work/vtest.avi"
	[ -e "$film" ] || film=$work/vtest.avi
	ffmpeg -y -loglevel error -i "$film" -f yuv4mpegpipe "$work/film.part" </dev/null
	mv "$work/film.part" "$work/film.y4m"
	ffmpeg -y -loglevel error -f lavfi -i color=0xbcbcbc:size=128x128 -frames:v 1 "$work/sky.png" </dev/null
fi
frames=$(ffprobe -v error -count_packets -show_entries stream=nb_read_packets -of csv=p=0 "$work/film.y4m")

run() {
	"$build/inlay" run --config tests/film/film.conf --set "basis.file=$work/cow.inlay" \
		--set "camera.background.sim.file=$work/film.y4m" --set "camera.fisheye.sim.file=$work/sky.png" \
		"$@" "${options[@]}"
}
echo "film: playing $frames frames through inlay"
run --set "screen.device=$work/shown.y4m" --frames "$frames"
run --set "screen.device=$work/empty.y4m" --frames 1 --set people.occlude=no
ffmpeg -y -loglevel error -i "$work/shown.y4m" -c:v libx264 -crf 18 -pix_fmt yuv420p -movflags +faststart \
	"$out/film.part.mp4" </dev/null
mv "$out/film.part.mp4" "$out/film.mp4"
if [ -e "$boxes" ]; then
	gunzip -c "$boxes" >"$work/boxes.xml"
	"$build/tests/film/measure" "$work/cow.inlay" "$work/film.y4m" "$work/shown.y4m" "$work/empty.y4m" \
		"$work/boxes.xml" "$out/crossings.png" >"$work/figures.txt"
else
	rm -f "$out/crossings.png"
	echo "$boxes is missing, so nothing was measured; INLAY_SHARED_DATA names the folder above film/" >"$work/figures.txt"
fi
tail -3 "$work/figures.txt"
sed "/^FIGURES$/ {
	r $work/figures.txt
	d
}" tests/film/film.html >"$out/film.html"
echo "$out/film.html   the film, what was measured in it, and what was assumed"
