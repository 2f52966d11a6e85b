#!/bin/bash
# SPDX-License-Identifier: MIT
# The same frame by inlay and by other ways, in turns on one thread, of the demo's cow under 86 lights at 320x240.
#     BUILD=build/x tests/bench/peers.sh [--record]     (make peers)
# Prints the table in Markdown, and leaves it in build/bench/peers.md; --record: also in the README beside this file.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
panorama=${INLAY_SHARED_DATA:-../shared/data}/hdri/st_fagans_interior_1k.hdr
work=build/bench/peers
readme=tests/bench/README.md

[ -e "$panorama" ] || {
	echo "peers: $panorama is missing: expected a panorama; INLAY_SHARED_DATA names the folder" >&2
	exit 1
}
mkdir -p "$work"
cp bake/demo/{cow.glb,background.ini} "$work/"
# All ways show the lights; mirrors of the fisheye's picture are inlay's alone.
sed 's/^\[render\]/&\nreflect = cells/' bake/demo/cow.scene >"$work/cow.scene"
"$build/inlay-bake" render --no-preview --quiet --exact --frequency 4 --size 320x240 --samples 16 "$work/cow.scene" \
	-o "$work/cow.inlay" || [ $? -eq 3 ] # 3: a tile is off by more than was asked for
"$build/tests/bench/peers" "$work/cow.inlay" "$panorama" | tee build/bench/peers.md
[ "${1:-}" = --record ] || exit 0
# The table after the line that names the command.
awk 'FNR == NR { table = table $0 "\n"; next }
	/^`make peers`/ { named = 1 }
	named && /^\|/ { if (!done) printf "%s", table; done = 1; next }
	done && !/^\|/ { named = 0 }
	{ print }' build/bench/peers.md "$readme" >"$work/README.md"
cat "$work/README.md" >"$readme"
