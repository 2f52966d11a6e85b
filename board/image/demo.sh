#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes what every image shows as it is delivered, in build/image/demo: the toy cow baked small and
# for few lights, and six seconds of the simulated studio as its two cameras saw them. Recorded,
# because an emulated processor takes seconds to compute one picture of the studio; small, because
# the machine is to be in the picture within seconds of its start.
#     BUILD=build/x board/image/demo.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
out=build/image/demo
rate=10
width=400
height=300
frames=60

key=$(cat "$0" bake/demo/{cow.glb,cow.scene,background.ini} config/demo.conf \
	hal/basis/basis_format.h | sha256sum)
[ "$(cat "$out/key" 2>/dev/null)" != "$key" ] || exit 0

echo "  DEMO    $out"
rm -rf "$out"
mkdir -p "$out"
staging=$(mktemp -d "$out/.staging.XXXXXX")
trap 'rm -rf "$staging"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

cp bake/demo/cow.{glb,scene} "$staging/"
# The demo's camera with fewer and larger pixels.
awk -v width=$width -v height=$height '
	$1 == "width" { scale = $3 / width; $3 = width }
	$1 == "height" { $3 = height }
	$1 == "centre" || $1 == "pixel" { factor = $1 == "pixel" ? scale : 1 / scale
		$3 *= factor; $4 *= factor }
	{ print }' bake/demo/background.ini >"$staging/background.ini"
"$build/inlay-bake" render --no-preview --quiet --frequency 2 --samples 24 -o "$staging/cow.inlay" \
	"$staging/cow.scene" || [ $? -eq 3 ]

# record CAMERA FILE [OPTION...]: what a camera of config/demo.conf sees, as the background is shown.
record() {
	"$build/inlay" run --config config/demo.conf --set "basis.file=$staging/cow.inlay" \
		--set "background.camera=$1" --set "camera.$1.width=$width" --set "camera.$1.height=$height" \
		--set "camera.$1.rate=$rate" --set screen.show=before \
		--set screen.driver=file --set "screen.device=$staging/$2" --set "screen.rate=$rate" \
		--frames $frames "${@:3}" 2>"$staging/log" || {
		cat "$staging/log" >&2
		exit 1
	}
}
record background background.y4m --set "camera.background.sim.camera=$PWD/$staging/background.ini"
# As large as the background, which shows it: the circle, of 150 pixels, is in the middle.
record fisheye fisheye.y4m --set "camera.fisheye.sim.focal=47.7465 47.7465"

mv "$staging"/{cow.inlay,background.y4m,fisheye.y4m} "$out/"
echo "$key" >"$out/key"
