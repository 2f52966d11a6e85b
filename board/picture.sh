#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes the picture of the README: the demo's kiosk in full, with its line of figures.
#     BUILD=build/x board/picture.sh OUT.png
# The demo's cameras are played from a picture each, at their rate, as real ones would deliver: the
# picture is the same each time, but for the figures of speed, which are this machine's.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
out=${1:?is missing: expected the name of a PNG file}
moment=4 # seconds into the demo: both lamps stand well
rate=25
seconds=3 # figures are those of the second before

[ -e demo/cow.inlay ] || bake/demo/demo.sh demo
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

run() {
	"$build/inlay" run --config config/demo.conf --set basis.file=demo/cow.inlay "$@"
}

# What one camera sees at that moment: it takes one picture then, and one before.
still() {
	run --set "background.camera=$1" --set "fisheye.camera=$1" --set scene.camera= \
		--set "camera.$1.rate=$(awk "BEGIN { print 1 / $moment }")" --set screen.show=before \
		--set screen.trouble=no --set "screen.device=$scratch/$1.png" --frames 2
}

played=()
for camera in fisheye background overview; do
	still "$camera"
	played+=(--set "camera.$camera.sim.source=files" --set "camera.$camera.sim.clock=real"
		--set "camera.$camera.sim.file=$scratch/$camera.png"
		--set "camera.$camera.rate=$rate")
done
run "${played[@]}" --set screen.show=quad --set screen.information=yes --set lights.threshold=24 \
	--set "screen.device=$scratch/kiosk.y4m" --frames $((rate * seconds))
ffmpeg -y -loglevel error -sseof -1 -i "$scratch/kiosk.y4m" -update 1 \
	-vf scale=in_color_matrix=bt601:in_range=limited -pix_fmt rgb24 "$out" </dev/null
echo "$out"
