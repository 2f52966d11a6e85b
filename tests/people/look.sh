#!/bin/bash
# SPDX-License-Identifier: MIT
# Judges the camera's look: bakes the object sharp and with the camera's edge spread. `make look` calls it.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
place=$build/tests/people
for spread in 0 0.8; do
	scene=$place/look-$spread.scene
	sed -e "s|^\[camera\]|&\nedge_spread = $spread|" -e "s|\.\./\.\./bake/|$PWD/bake/|" \
		tests/people/people.scene >"$scene.new"
	if ! cmp -s "$scene.new" "$scene" || [ ! -e "$place/look-$spread.inlay" ]; then
		"$build/inlay-bake" render --quiet --no-preview --samples 64 -o "$place/look-$spread.inlay" "$scene.new"
		mv "$scene.new" "$scene"
	fi
done
exec "$place/look" "$place/look-0.inlay" "$place/look-0.8.inlay"
