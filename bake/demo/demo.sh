#!/bin/bash
# SPDX-License-Identifier: MIT
# The demo: bakes the toy cow, runs inlay on simulated cameras, leaves pictures. `make demo` calls it.
#     BUILD=build/x bake/demo/demo.sh [FOLDER [OPTION...]]
# Pictures go to FOLDER (demo/); options are for `inlay-bake render`. The bake is skipped while its
# basis file is newer than all it is made of.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
out=${1:-demo}
bake_options=("${@:2}")
rate=25
seconds=6
moment=4 # seconds into the run: both lamps stand well
walk_rate=15
walk_seconds=9

mkdir -p "$out"

# True when FILE is missing or older than one of the others.
stale() {
	local file=$1 other
	shift
	[ -e "$file" ] || return 0
	for other in "$@"; do
		[ "$file" -nt "$other" ] || return 0
	done
	return 1
}

prepare() {
	local file
	for file in cow.glb cow.scene background.ini; do
		cmp -s "bake/demo/$file" "$out/$file" || cp "bake/demo/$file" "$out/$file"
	done
}

bake() {
	if stale "$out/cow.inlay" "$out/cow.glb" "$out/cow.scene" "$out/background.ini" \
		"$build/inlay-bake"; then
		echo "demo: baking the scene (about a minute on two cores)"
		# 3: a tile is off by more than was asked for, which it has said; the demo shows that as well
		"$build/inlay-bake" render --no-preview "${bake_options[@]}" -o "$out/cow.inlay" "$out/cow.scene" ||
			[ $? -eq 3 ]
	fi
}

run() {
	"$build/inlay" run --config config/demo.conf --set "basis.file=$out/cow.inlay" "$@"
}

# What one view shows at the chosen moment: cameras that take one picture then, and one before.
picture() {
	local show=$1 file=$2 camera slow=()
	for camera in fisheye background overview; do
		slow+=(--set "camera.$camera.rate=$(awk "BEGIN { print 1 / $moment }")")
	done
	run "${slow[@]}" --set "screen.show=$show" --set "screen.device=$out/$file" --frames 2
}

# clip NAME RATE SECONDS OPTION...
clip() {
	local name=$1 rate=$2 seconds=$3
	shift 3
	run --set screen.show=composite --set "screen.device=$out/$name.y4m" --set "screen.rate=$rate" \
		--frames $((rate * seconds)) "$@"
	ffmpeg -y -loglevel error -i "$out/$name.y4m" -c:v libx264 -crf 18 -pix_fmt yuv420p \
		-movflags +faststart "$out/$name.part.mp4" </dev/null
	mv "$out/$name.part.mp4" "$out/$name.mp4"
	rm "$out/$name.y4m"
}

# One walks behind the cow, and one close before the camera. The place is learned without them first, and kept.
walkers() {
	local people=(--set people.occlude=yes --set "state.file=$out/walkers.state" --set scene.camera=)
	rm -f "$out/walkers.state"*
	run "${people[@]}" --set screen.driver=null --frames $((3 * rate))
	clip walkers $walk_rate $walk_seconds "${people[@]}" --set camera.background.sim.walkers=2 \
		--set camera.background.rate=$walk_rate --set camera.fisheye.rate=$walk_rate
	rm -f "$out/walkers.state"*
}

prepare
bake
echo "demo: running inlay in the studio"
picture before before.png
picture composite after.png
picture fisheye fisheye.png
picture quad quad.png
clip clip $rate $seconds
walkers
echo "$out/before.png   what the camera sees"
echo "$out/after.png    the same with the cow, lit by the studio's lamps"
echo "$out/fisheye.png  the fisheye's view of them, each light marked"
echo "$out/quad.png     the room from afar, the fisheye, before and after"
echo "$out/clip.mp4     $seconds s of moving lamps"
echo "$out/walkers.mp4  $walk_seconds s of people behind the cow and before it"
