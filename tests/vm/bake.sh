#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes what the guest's tests show: bakes the small basis files, and takes pictures of a real
# panorama where there is one. On the host, once for all machines.
#
#     bake.sh          into $BUILD/tests/vm/live, .../thesis and, when $INLAY_SHARED_DATA is there, .../spot
#     bake.sh --quick  without the last, for what does not need it
set -euo pipefail
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build}
out=$BUILD/tests/vm
tools=$out/tools
data=${INLAY_SHARED_DATA:-../shared/data}

# bake NAME: $out/NAME/NAME.inlay, when it is not newer than what it is made from.
bake() {
	local folder=$out/$1
	if [ "$folder/$1.inlay" -nt "$BUILD/inlay-bake" ] &&
		[ "$folder/$1.inlay" -nt "tests/vm/scenes/$1.scene" ]; then
		return
	fi
	echo "  BAKE    $folder/$1.inlay"
	cp "tests/vm/scenes/$1.scene" "$folder/"
	"$BUILD/inlay-bake" render --no-preview "$folder/$1.scene" -o "$folder/$1.inlay" >"$folder/bake.log" 2>&1 || [ $? -eq 3 ] || {
		cat "$folder/bake.log" >&2
		exit 1
	}
}

mkdir -p "$out/live" "$out/thesis"
cp bake/demo/cow.glb "$out/live/"
ln -sfn ../live/cow.glb "$out/thesis/"
bake live
bake thesis

if [ "${1:-}" != --quick ] && [ -r "$data/mesh/spot.obj" ]; then
	mkdir -p "$out/spot"
	ln -sfn "$(realpath "$data/mesh/spot.obj")" "$out/spot/spot.obj"
	bake spot
	panorama=("source=panorama" "file=$(realpath "$data/hdri/st_fagans_interior_1k.hdr")"
		"exposure=0.6" format=BGRX width=640 height=480 clock=frames)
	"$tools/capture" sim 1 "$out/spot/fisheye.png" "${panorama[@]}" view=fisheye >/dev/null
	"$tools/capture" sim 1 "$out/spot/background.png" "${panorama[@]}" view=perspective \
		"eye=0.9 -1.5 0.8" "target=0 0 0.2" angle=66.0338 >/dev/null
fi
