#!/bin/bash
# SPDX-License-Identifier: MIT
# The demo, with a bake as coarse as can be: what it leaves, and that it is not baked twice.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
build=$(dirname "$INLAY")
out=$work/pictures

demo() {
	BUILD=$build bake/demo/demo.sh "$out" --frequency 1 --samples 1 --quiet \
		>"$work/demo.log" 2>&1 || {
		cat "$work/demo.log"
		return 1
	}
}
videos_frames() {
	ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "$1"
}

check "inlay check takes its configuration" "$INLAY" check --config config/demo.conf \
	--set "basis.file=$work/box.inlay"
check "the demo" demo
for file in before.png after.png fisheye.png quad.png clip.mp4 walkers.mp4; do
	check "leaves $file" test -s "$out/$file"
	check "and says so" grep -qF "$out/$file" "$work/demo.log"
done
absent "no raw video is left" "$out/clip.y4m" "$out/clip.part" "$out/walkers.y4m" "$out/walkers.part"
differ "the cow is seen" "$out/before.png" "$out/after.png"
equal "the clip's frames" 150 "$(videos_frames "$out/clip.mp4")"
equal "those of the walkers" 135 "$(videos_frames "$out/walkers.mp4")"
check "who come into a place that is known" grep -q "the place is known from $out/walkers.state.place" "$work/demo.log"
check "it bakes at first" grep -q baking "$work/demo.log"
# Its fisheye's picture with the marks on it is light like any other.
# Fast mode leaves columns out that the file lets it; where there are none, integers are all that is
# left between it and double precision.
farthest() { # BASIS
	local mode
	for mode in fast reference; do
		"$INLAY" still --config config/demo.conf --basis "$1" --background "$out/before.png" \
			--fisheye "$out/fisheye.png" --mode $mode -o "$work/$mode.pfm" || return
	done
	"$build/tests/accuracy/compare" "$work/fast.pfm" "$work/reference.pfm" | awk '{ print $3 }'
}
check "the cow, every column used" "$INLAY_BAKE" render --no-preview --frequency 1 --samples 1 --column-cut 0 --quiet \
	-o "$work/all.inlay" "$out/cow.scene"
worst=$(farthest "$work/all.inlay")
check "integers keep within a level of double precision ($worst)" \
	awk "BEGIN { exit !(\"$worst\" != \"\" && $worst <= 1) }"
worst=$(farthest "$out/cow.inlay")
declared=$("$INLAY_BAKE" info --json "$out/cow.inlay" | sed -n 's/.*"sky_max": *\([0-9.]*\).*/\1/p')
check "and fast mode to what the file declares of skies ($worst, declared $declared)" \
	awk "BEGIN { exit !(\"$worst\" != \"\" && $worst <= $declared + 1) }"
cp "$out/after.png" "$work/after.png"
check "once more" demo
check "is not baked again" bash -c "! grep -q baking '$work/demo.log'"
same "shows the same" "$work/after.png" "$out/after.png"
finish
