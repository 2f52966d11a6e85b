#!/bin/bash
# SPDX-License-Identifier: MIT
# What each error that may be asked for of the encoder costs: bakes spot again and again, prints a
# Markdown table.
#     BUILD=build/x tests/bench/encoder.sh [SIZE [SAMPLES [ERROR CELL_ERROR COLUMN_CUT]...]]
# SIZE: 320x240, SAMPLES: 16; without a choice of one's own some are tried around the default.
# Needs $INLAY_SHARED_DATA (else ../shared/data). The last columns are what `inlay bench` says of
# the fast mode under its built-in lightings and under each panorama: the worst.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
data=${INLAY_SHARED_DATA:-../shared/data}
size=${1:-320x240}
samples=${2:-16}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cp tests/accuracy/spot.scene "$work/"
ln -s "$(realpath "$data/mesh/spot.obj")" "$work/spot.obj"
sky=()
for file in "$data"/hdri/*.hdr; do
	sky+=(--panorama "$file")
done

# row ERROR CELL_ERROR COLUMN_CUT
row() {
	echo "baking with $*" >&2
	"$build/inlay-bake" render --no-preview --frequency 9 --size "$size" --samples "$samples" --exact --quiet \
		--error "$1" --cell-error "$2" --column-cut "$3" -o "$work/is.inlay" "$work/spot.scene" ||
		[ $? -eq 3 ]
	"$build/inlay-bake" info --json "$work/is.inlay" >"$work/info.json"
	"$build/inlay" bench --basis "$work/is.inlay" --thesis no --kernel auto --repeat 1 --json \
		>"$work/own.json" 2>>"$work/log"
	"$build/inlay" bench --basis "$work/is.inlay" --thesis no --kernel auto --repeat 1 --json \
		"${sky[@]}" >"$work/sky.json" 2>>"$work/log"
	python3 - "$work" "$@" <<'END'
import json, sys

work, error, cell, cut = sys.argv[1:]
info = json.load(open(work + "/info.json"))
own, sky = (json.load(open("%s/%s.json" % (work, name)))["rows"] for name in ("own", "sky"))
shown, pixels = info["shown"], info["shown"]["all"]["pixels"]
def worst(rows, what):
    return max(row["max"] for row in rows if row["what"] == what)
def fast(rows):
    return [row for row in rows if row["what"] == "fast"]
print("| %s | %s | %s | %.0f | %.0f | 1/%.1f | %.1f | %.2f / %.1f | %.2f / %.1f | %.1f | %.1f | %.1f | %.1f |" % (
    error.replace(",", ", "), cell, cut,
    *(shown[kind]["bytes"] / shown[kind]["pixels"] for kind in "TV"),
    shown["all"]["dense_bytes"] / shown["all"]["bytes"],
    sum(row["basis_mb"] for row in fast(sky)) / len(fast(sky)) * 1e6 / pixels,
    info["sky_rms"], info["sky_max"], info["cell_rms"], info["cell_max"],
    max(row["max"] for row in fast(own) if row["lighting"] == "single cells"),
    worst(sky, "fast"), worst(sky + own, "whole frame"),
    min(row["psnr_db"] for row in fast(sky + own))))
END
}

echo "| error | cell_error | column_cut | T | V | all | a frame reads | skies | cells | single cells |" \
	"panoramas | whole frame | PSNR dB |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
shift $(($# < 2 ? $# : 2))
[ $# -gt 0 ] || set -- 0.6,1.2 1 0.001 0.6,1.2 1.4 0.001 0.6,1.2 2 0.001 1,2 4 0.001 \
	0.6,1.2 1.4 0.0005
while [ $# -ge 3 ]; do
	row "$1" "$2" "$3"
	shift 3
done
