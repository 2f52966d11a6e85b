#!/bin/bash
# SPDX-License-Identifier: MIT
# What shines, against path-traced truth: metal that mirrors cells or the fisheye's picture; a box on a polished floor,
# with what its bake costs beside a diffuse floor's and beside a stand-in of the floor.
#     BUILD=build/x tests/accuracy/shine.sh [SIZE [SAMPLES [metal|floor]]]     the tables, in Markdown (make shine)
# Pictures and table are left in build/accuracy/shine. Nothing passes or fails.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/accuracy/method.sh
. tests/accuracy/method.sh
work=build/accuracy/shine
log=$work/log.txt
what=${3:-both}

# scene FLOOR: of the ground's materials, or a stand-in of the polished one
scene() {
	cat <<-SCENE
		[camera]
		position = 0.9 -1.6 0.8
		look_at = 0 0 0.12
		field_deg = 45
		[render]
		bounces = 3
		[material diffuse]
		colour = 0.4 0.38 0.35
		[material polished]
		kind = glossy
		colour = 0.4 0.38 0.35
		specular = 0.3 0.3 0.3
		roughness = 0.05
		[material clay]
		colour = 0.72 0.42 0.30
		[object box]
		file = box.obj
		material = clay
		scale = 0.5
		rotate = 0 0 20
		stand = yes
	SCENE
	case $1 in
	standin) printf '[standin floor]\nfile = plane.obj\nmaterial = polished\n' ;;
	*) printf '[ground]\nmaterial = %s\n' "$1" ;;
	esac
}

# truth NAME FILE EXPOSURE OPTION...
truth() {
	local name=$1 file=$2 exposure=$3
	shift 3
	"$build/inlay-bake" truth --panorama "$data/hdri/$file.hdr" --exposure "$exposure" --size "$size" --quiet "$@" \
		"$work/polished.scene" >>"$log" 2>&1 || fail "inlay-bake truth of $name failed"
}

# metal SHAPE ROUGHNESS cells|live
metal() {
	local camera="position = 0.9 -1.6 0.8
		look_at = 0 0 0.2
		field_deg = 40"

	[ "$1" != horn ] || camera="position = -1.1 -0.9 1.1
		look_at = 0 0 0.25
		field_deg = 38"
	cat <<-SCENE
		[camera]
		$camera
		[render]
		bounces = 3
		reflect = $3
		[ground]
		material = grey
		[material grey]
		colour = 0.4 0.38 0.35
		[material metal]
		kind = glossy
		colour = 0 0 0
		specular = 0.9 0.87 0.8
		roughness = $2
		[object thing]
		file = $1.obj
		material = metal
		scale = 0.6
		crease_deg = 40
		rotate = 0 0 30
		stand = yes
	SCENE
}

# psnr NAME COMPOSITE TRUTH [BACKGROUND]
psnr() {
	local found
	read -r found _ < <(python3 tests/accuracy/shine.py "$2" "$3"1.pfm "$3"2.pfm "${@:4}")
	printf ' %s |' "$found"
}

table_of_metal() {
	echo "| metal, roughness | museum, cells | live | sunset, cells | live | studio, cells | live |"
	echo "|---|---|---|---|---|---|---|"
	for shape in ball pot horn; do
		python3 tests/accuracy/shine_mesh.py $shape "$work/$shape.obj"
		for roughness in 0 0.1; do
			for reflect in cells live; do
				metal $shape $roughness $reflect >"$work/spot.scene"
				bake 9:$reflect --size "$size" --samples 64 --quiet
			done
			cp "$work/spot.scene" "$work/polished.scene"
			printf '| %s, %s |' $shape $roughness
			while read -r name file exposure; do
				for seed in 1 2; do
					truth "$name" "$file" "$exposure" --samples "$samples" --seed $seed \
						--background-out "$work/$name-background.png" --fisheye-out "$work/$name-fisheye.pfm" \
						-o "$work/$name-truth$seed.pfm"
				done
				for reflect in cells live; do
					composite "$name" 9:$reflect "$work/$name-$reflect.pfm"
					psnr "$name" "$work/$name-$reflect.pfm" "$work/$name-truth"
				done
			done <<<"$panoramas"
			echo
		done
	done
}

rm -rf "$work"
mkdir -p "$work"
size=${1:-96x72} samples=${2:-576}
[ "$what" = floor ] || table_of_metal | tee "$work/metal.md"
[ "$what" = metal ] && exit
size=${1:-160x120} samples=${2:-256}
cp bake/demo/box.obj "$work/box.obj"
printf 'v -30 0 -30\nv 30 0 -30\nv 30 0 30\nv -30 0 30\nf 4 3 2 1\n' >"$work/plane.obj"
floors="diffuse polished standin"
for floor in $floors; do
	scene "$floor" >"$work/$floor.scene"
done
{
	echo "| floor | bake, processor s | file, MB | museum, dB | studio, dB |"
	echo "|---|---|---|---|---|"
	while read -r name file exposure; do
		case $name in museum | studio) ;; *) continue ;; esac
		for seed in 1 2; do
			# A lamp without light has the background show the real scene.
			[ $seed = 1 ] && truth "$name" "$file" "$exposure" --samples "$samples" --lamp 0,0,1000,0.001,0,0,0 \
				--background-out "$work/$name-background.pfm" -o "$work/none.pfm"
			truth "$name" "$file" "$exposure" --samples "$samples" --seed $seed \
				--background "$work/$name-background.pfm" --background-out "$work/$name-background.png" \
				--fisheye-out "$work/$name-fisheye.pfm" -o "$work/$name-truth$seed.pfm"
		done
	done <<<"$panoramas"
	for floor in $floors; do
		cp "$work/$floor.scene" "$work/spot.scene"
		TIMEFORMAT=%U
		seconds=$( { time bake 9 --size "$size" --samples 64 --quiet; } 2>&1)
		printf '| %s | %s | %s |' "$floor" "$seconds" "$(stat -c %s "$work/f9.inlay" | awk '{ printf "%.1f", $1 / 1e6 }')"
		for name in museum studio; do
			composite "$name" 9 "$work/$name-$floor.pfm"
			psnr "$name" "$work/$name-$floor.pfm" "$work/$name-truth" "$work/$name-background.pfm"
		done
		echo
	done
} | tee "$work/table.md"
