#!/bin/bash
# SPDX-License-Identifier: MIT
# The report of spot in real panoramas where those are, else of the demo's cow in surroundings of
# the project's own. `make report` calls it.
#     BUILD=build/x tests/accuracy/report.sh FOLDER [OPTION...]
# Options are for `inlay-bake report`.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
out=${1:?expected the folder that the report goes to}
data=${INLAY_SHARED_DATA:-../shared/data}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

options=("${@:2}")
if [ -e "$data/mesh/spot.obj" ]; then
	scene=$work/spot.scene
	cp tests/accuracy/spot.scene "$scene"
	ln -s "$(realpath "$data/mesh/spot.obj")" "$work/spot.obj"
	for panorama in "$data"/hdri/*.hdr; do
		[ ! -e "$panorama" ] || options+=(--panorama "$panorama")
	done
else
	scene=$work/cow.scene
	cp bake/demo/{cow.glb,cow.scene,background.ini} "$work"
fi
mkdir -p "$(dirname "$out")"
"$build/inlay-bake" report "${options[@]}" "$scene" -o "$out"
