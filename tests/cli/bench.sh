#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay bench: every row is there, in each form the same figures, errors that can be; how it fails.
# Times are not judged.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

basis=$work/exact.inlay
check "a basis with its exact layer" "$INLAY_BAKE" render --quiet --exact "$work/box.scene" -o "$basis"

# ---- every figure, in three forms ----
check "bench" "$INLAY" bench --basis "$basis" --repeat 2 --cells 3
"$INLAY" bench --basis "$basis" --repeat 2 --cells 3 --json --csv "$work/bench.csv" \
	>"$work/bench.json" 2>"$work/said"
equal "in JSON and CSV" 0 $?
"$INLAY" bench --basis "$basis" --repeat 1 --cells 2 --kernel c --threads 2 >"$work/bench.txt" 2>"$work/said"
equal "as a table" 0 $?
for words in "overcast" "sun" "random" "single cells" "thesis, double precision" "whole frame" \
	"memcpy of the picture"; do
	check "that has: $words" grep -q "^$words" "$work/bench.txt"
done
equal "by the one kernel that was asked for" "c" \
	"$(sed -nE 's/^(exact|fast)  +([^ ]*).*/\2/p' "$work/bench.txt" | sort -u)"

# The middle one of three cells is the only one of one, and the worst of three counts.
"$INLAY" bench --basis "$basis" --repeat 1 --cells 1 --kernel c --thesis no --csv "$work/one.csv" \
	>"$work/bench.txt" 2>"$work/said"
for what in "fast" "whole frame"; do
	check "of three cells the worst counts: $what" awk -F, -v what="$what" '
		FNR == 1 { for (k = 1; k <= NF; k++) of[$k] = k }
		$1 == "single cells" && $2 == what && $3 == "c" {
			rms[FILENAME] = $of["rms"]; max[FILENAME] = $of["max"]
			contrast[FILENAME] = $of["contrast"]
		}
		END {
			three = ARGV[1]; one = ARGV[2]
			exit !(rms[one] > 0 && rms[three] >= rms[one] && max[three] >= max[one] &&
				contrast[three] >= contrast[one])
		}' "$work/bench.csv" "$work/one.csv"
done

if command -v python3 >/dev/null; then
	# Prints all that is wrong; an empty list is right.
	judged() {
		python3 - "$work/bench.json" "$work/bench.csv" "$work/info.json" <<'END'
import csv, json, math, sys

bench = json.load(open(sys.argv[1]))
table = list(csv.DictReader(open(sys.argv[2])))
info = json.load(open(sys.argv[3]))
rows = bench["rows"]
wrong = []
if len(rows) != len(table):
    wrong.append("rows")
for row, line in zip(rows, table):
    for key in set(row) | set(line):
        text = "" if row.get(key) is None else row[key]
        same = (text == line.get(key) if isinstance(text, str)
                else math.isclose(float(line[key]), text, rel_tol=1e-6))  # 7 digits
        if not same:
            wrong.append("%s of %s: %r, %r" % (key, row["what"], row.get(key), line.get(key)))
ways = ["exact", "fast", "whole frame", "whole frame, four lamps"]
kernels = {row["kernel"] for row in rows} - {""}
if "c" not in kernels:
    wrong.append("no kernel c")
for lighting in ["overcast", "sun", "random", "single cells"]:
    there = {(row["what"], row["kernel"]): row for row in rows if row["lighting"] == lighting}
    wanted = {(way, kernel) for way in ways for kernel in kernels}
    wanted |= {("thesis, double precision", ""), ("memcpy of the picture", ""),
               ("light from its camera", ""), ("background from its camera", "")}
    if set(there) != wanted:
        wrong.append("%s has not, or has too many: %s" % (lighting, set(there) ^ wanted))
        continue
    for (way, kernel), row in there.items():
        if not 0 < row["least_ms"] <= row["median_ms"]:
            wrong.append("times of %s" % way)
        if way.startswith("exact") and not row["max"] <= 1:
            wrong.append("exact is off by %g" % row["max"])
        if way.startswith("fast") and lighting == "overcast":
            # 0.3 is what rounding to 8 bits does
            declared = 20 * math.log10(255 / math.hypot(info["sky_rms"], 0.3))
            if row["psnr_db"] < declared - 1:
                wrong.append("%s: %g dB, declared %g" % (way, row["psnr_db"], declared))
        if row["psnr_db"] is not None and abs(
                row["psnr_db"] - 20 * math.log10(255 / row["rms"])) > 0.01:
            wrong.append("PSNR of %s is not its RMS's" % way)
    if not there["exact", "c"]["basis_mb"] > 0:
        wrong.append("exact reads nothing")
print("; ".join(wrong))
END
	}
	"$INLAY_BAKE" info --json "$basis" >"$work/info.json"
	equal "all rows are there, with errors that can be" "" "$(judged 2>&1)"
	# The judge has to see what is wrong.
	cp "$work/bench.json" "$work/kept.json"
	sed -i '0,/"max": [0-9.e-]*/s//"max": 77/' "$work/bench.json"
	check "figures that differ are noticed" test -n "$(judged 2>&1)"
	sed 's/"what": "exact"/"what": "exakt"/' "$work/kept.json" >"$work/bench.json"
	check "a row that is missing is noticed" test -n "$(judged 2>&1)"
fi

# ---- lightings ----
for _ in {1..26}; do echo "0.5 0.4 0.3"; done >"$work/even.txt"
# A panorama of 8 x 4 texels of one colour.
{
	printf 'PF\n8 4\n-1.0\n'
	for _ in {1..96}; do printf '\0\0\200\77'; done
} >"$work/grey.pfm"
"$INLAY" bench --basis "$basis" --repeat 1 --kernel c --lights "$work/even.txt" \
	--panorama "$work/grey.pfm" --thesis no >"$work/bench.txt" 2>"$work/said"
equal "lights from a file and a panorama" 0 $?
equal "and no others" "even grey" "$(grep -A1 '^$' "$work/bench.txt" | grep -v '^-*$' | tr '\n' ' ' | sed 's/ $//')"
equal "without the thesis's algorithm" 0 "$(grep -c '^thesis' "$work/bench.txt")"
check "a basis without its exact layer" "$INLAY" bench --basis "$work/box.inlay" --repeat 1 --cells 1
equal "is said" 1 "$("$INLAY" bench --basis "$work/box.inlay" --repeat 1 --cells 1 --kernel c 2>"$work/said" |
	grep -c "against the shown layer")"
equal "a threshold leaves lights out" 1 "$("$INLAY" bench --basis "$basis" --repeat 1 --kernel c \
	--lights "$work/even.txt" --threshold 255 2>"$work/said" | grep -cE '^thesis, double precision +0 ')"

# ---- wrong usage ----
refused "no basis" 2 "--basis FILE is missing" "$INLAY" bench
refused "an unknown kernel" 2 "--kernel: \"mmx\"" "$INLAY" bench --basis "$basis" --kernel mmx
refused "no repeats" 2 "--repeat: \"0\"" "$INLAY" bench --basis "$basis" --repeat 0
refused "too many threads" 2 "--threads: \"9999\"" "$INLAY" bench --basis "$basis" --threads 9999
refused "neither yes nor no" 2 "--thesis: \"maybe\"" "$INLAY" bench --basis "$basis" --thesis maybe
check "a budget of white too" "$INLAY" bench --basis "$basis" --repeat 1 --kernel c --thesis no \
	--lights "$work/even.txt" --threshold 1%
refused "more than all of it" 2 "--threshold: \"101%\", expected a grey level 0..255 or a percentage" \
	"$INLAY" bench --basis "$basis" --threshold 101%
refused "a level beyond white" 2 "--threshold: \"256\"" "$INLAY" bench --basis "$basis" --threshold 256
refused "a misspelt option" 2 "did you mean --panorama?" "$INLAY" bench --panoramas x
refused "a word that is no option" 2 "is one argument too many" "$INLAY" bench "$basis"

# ---- what is missing or damaged ----
refused "no such basis" 1 "none.inlay" "$INLAY" bench --basis "$work/none.inlay"
refused "no such lights" 1 "none.txt" "$INLAY" bench --basis "$basis" --lights "$work/none.txt"
refused "too few lights" 1 "box.scene" "$INLAY" bench --basis "$basis" --lights "$work/box.scene"
refused "no such panorama" 1 "none.hdr" "$INLAY" bench --basis "$basis" --panorama "$work/none.hdr"
refused "no folder for the CSV" 1 "nowhere" "$INLAY" bench --basis "$basis" --repeat 1 \
	--csv "$work/nowhere/a.csv"
rm -f "$work/left.csv"
refused "a failure" 1 "none.txt" "$INLAY" bench --basis "$basis" --lights "$work/none.txt" \
	--csv "$work/left.csv"
absent "leaves no CSV" "$work/left.csv"
head -c 9000 "$basis" >"$work/cut.inlay"
refused "half a basis" 1 "cut.inlay" "$INLAY" bench --basis "$work/cut.inlay"
if [ -w /dev/full ]; then
	check "a full disk behind standard output is a failure" sh -c \
		"! \"\$INLAY\" bench --basis \"$work/box.inlay\" --repeat 1 --cells 1 --kernel c >/dev/full"
fi
finish
