#!/bin/bash
# SPDX-License-Identifier: MIT
# How right the light of an 8-bit fisheye is, with one exposure, with what the ground tells, and with
# three: spot on a grey card in real panoramas and in the project's room.
#     BUILD=build/x tests/accuracy/exposures.sh    the table, in Markdown
# README.md says how to read it.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
data=${INLAY_SHARED_DATA:-../shared/data}
work=build/accuracy
mkdir -p "$work"
cp tests/accuracy/spot.scene "$work/spot.scene"
ln -sfn "$(realpath "$data/mesh/spot.obj")" "$work/spot.obj"
"$build/inlay-bake" render --no-preview --frequency 9 --size 160x120 --samples 32 --quiet \
	-o "$work/exposures.inlay" "$work/spot.scene" || [ $? -eq 3 ]
"$build/tests/accuracy/exposures" "$work/exposures.inlay" "$work/spot.scene" "$data/hdri"
