#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay-bake report: page and tables are there and say the same; how it fails. Figures that
# are times are not judged.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

report() {
	"$INLAY_BAKE" report --quiet --size 48x36 --samples 4 --truth-samples 32 --frequency 2 --repeat 3 "$@"
}

check "--help" "$INLAY_BAKE" report --help
check "--version" "$INLAY_BAKE" report --version

# ---- of a scene ----
out=$work/report
check "report of a scene" report "$work/box.scene" -o "$out"
for name in settings surroundings; do
	check "table $name" test -s "$out/$name.csv"
done
equal "each dome up to --frequency is tried" "1 2" "$(tail -n +2 "$out/settings.csv" |
	sed 's/^"[^"]*"//' | cut -d, -f3 | sort -nu | xargs)"
equal "a picture of each surrounding" 3 "$(find "$out" -name 'picture-*.png' | wc -l)"
equal "nothing else is left" "" "$(find "$out" -type f ! -name '*.csv' \
	! -name '*.png' ! -name report.html; find "$work" -maxdepth 1 -name 'report.part*')"

# Other domes that it tries have no finer parts: 6 is no multiple of the frequencies of all of them.
# The box is metal.
sed -e 's/^\[dome\].*/&\nfine = 0 40 1 6/' -e 's/^file = box.obj/&\nmaterial = paint/' \
	-e 's/^\[material paint\]/&\nkind = glossy\nroughness = 0/' "$work/box.scene" >"$work/finer.scene"
check "report of a dome that is finer in parts" report "$work/finer.scene" -o "$work/finer"
equal "which is in use" 1 "$(grep -c "^in use,$("$INLAY_BAKE" dome --frequency 2 --fine "0 40 1 6" --angles |
	grep -c '^[0-9]'),2,fast," "$work/finer/settings.csv")"
equal "the share that mirrors the fisheye's picture is said where there is one" "0 1" \
	"$(grep -c "In [0-9]* % of its pixels the object mirrors" "$out/report.html") $(
		grep -c "In [0-9]* % of its pixels the object mirrors" "$work/finer/report.html")"
rm -rf "$work/finer"

# Everything that is wrong about a report's folder; nothing is fine.
judged() { # FOLDER
	python3 - "$1" <<'END'
import csv, html.parser, math, os, re, sys

folder = sys.argv[1]
wrong = []
EMPTY = {"meta", "img", "br"}


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.tables, self.table, self.cell, self.images = [], {}, None, None, 0

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in EMPTY:
            self.open.append(tag)
        if tag == "table":
            self.table = self.tables.setdefault(attributes["id"], {"head": [], "rows": []})
        elif tag == "tr" and "tbody" in self.open:
            self.table["rows"].append([])
        elif tag in ("td", "th"):
            self.cell = ""
        elif tag == "img":
            self.images += 1
            if not os.path.exists(os.path.join(folder, attributes["src"])):
                wrong.append("no picture " + attributes["src"])
        elif tag == "a" and not os.path.exists(os.path.join(folder, attributes["href"])):
            wrong.append("a link to %s, which is not there" % attributes["href"])

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            wrong.append("</%s> closes nothing" % tag)
        if tag == "td":
            self.table["rows"][-1].append(self.cell)
        elif tag == "th":
            self.table["head"].append(self.cell)
        if tag in ("td", "th"):
            self.cell = None

    def handle_data(self, data):
        if self.cell is not None:
            self.cell += data


def is_number(text):
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def alike(shown, kept):
    if not is_number(shown) or not is_number(kept):
        return shown == kept
    return abs(float(shown) - float(kept)) <= max(0.06 * abs(float(kept)) if abs(float(kept)) < 0.1
                                                   else 0.006 * abs(float(kept)), 1e-9)


page = Page()
page.feed(open(os.path.join(folder, "report.html"), encoding="utf-8").read())
page.close()
if page.open:
    wrong.append("not closed: %s" % page.open)
tables = {name[:-4] for name in os.listdir(folder) if name.endswith(".csv")}
if set(page.tables) != tables:
    wrong.append("tables and CSVs: %s" % (set(page.tables) ^ tables))
pictures = [name for name in os.listdir(folder) if name.endswith(".png")]
if page.images != len(pictures):
    wrong.append("%d pictures in the page, %d in the folder" % (page.images, len(pictures)))
for name in set(page.tables) & tables:
    kept = list(csv.reader(open(os.path.join(folder, name + ".csv"), encoding="utf-8")))
    shown = page.tables[name]["rows"]
    if len(shown) != len(kept) - 1 or not shown:
        wrong.append("%s has %d rows, its CSV %d" % (name, len(shown), len(kept) - 1))
    for row, line in zip(shown, kept[1:]):
        if len(line) != len(kept[0]):
            wrong.append("%s.csv has a row of %d" % (name, len(line)))
        # shown columns are some of the CSV's, in their order
        at = 0
        for cell in row:
            while at < len(line) and not alike(cell, line[at]):
                at += 1
            if at == len(line):
                wrong.append("%s: %r is not in %s" % (name, cell, line))
                break
            at += 1
settings = list(csv.DictReader(open(os.path.join(folder, "settings.csv"), encoding="utf-8")))
for row in settings:
    if not float(row["low_ms"]) <= float(row["median_ms"]) <= float(row["high_ms"]):
        wrong.append("%s: its median is not between its quartiles" % row["setting"])


def faster(a, b):
    return (float(a["high_ms"]) < float(b["low_ms"])
            and float(a["median_ms"]) * 1.05 < float(b["median_ms"]))


def nearer(a, b):
    x, y = float(a["truth_rms_levels"]), float(b["truth_rms_levels"])
    return x * 1.01 < y and y * y - x * x > float(a["noise_levels"]) ** 2


for row in settings:
    beaten = any((faster(a, row) and not nearer(row, a)) or (nearer(a, row) and not faster(row, a))
                 for a in settings)
    if (row["front"] == "yes") == beaten:
        wrong.append("%s: on the front or not" % row["setting"])
print("; ".join(wrong[:10]))
END
}

if command -v python3 >/dev/null; then
	equal "the page is whole, and every figure in its CSV" "" "$(judged "$out" 2>&1)"
	# The judge has to see what is wrong.
	cp -r "$out" "$work/broken"
	sed -i '2s/^[^,]*,[^,]*/7,8/' "$work/broken/settings.csv"
	differ "another figure is noticed" <(judged "$work/broken" 2>&1) <(echo)
	cp "$out/settings.csv" "$work/broken/settings.csv"
	sed -i '0,/<\/table>/s///' "$work/broken/report.html"
	differ "a table without end is noticed" <(judged "$work/broken" 2>&1) <(echo)

	equal "the exact layer is rounded and no more" "" "$(python3 -c 'import csv, sys
for row in csv.DictReader(open(sys.argv[1])):
    if row["way"] == "exact" and float(row["double_max_levels"]) > 1.5:
        print(row["lights"], row["double_max_levels"])' "$out/settings.csv")"
fi

# ---- what a row names ----
# Settings are named as lines of the scene file and of the kiosk's configuration, which take them.
lines_of() { # KEY...: of the rows that name these keys, the first line of each
	for key in "$@"; do
		grep -om1 "^\"*$key = [^,;\"]*" "$out/settings.csv" | tr -d '"'
	done
}
sed '/^frequency/d; /^samples/d' "$work/box.scene" >"$work/pasted.scene"
{
	echo "[render]"
	lines_of samples error column_cut
	echo "[dome]"
	lines_of frequency
} >>"$work/pasted.scene"
equal "keys for the scene" 4 "$(tail -n 6 "$work/pasted.scene" | grep -c ' = ')"
check "the scene file takes its lines" "$INLAY_BAKE" render --quiet --size 16x12 --samples 1 \
	"$work/pasted.scene" -o "$work/pasted.inlay"
cp "$work/studio.conf" "$work/pasted.conf"
{
	echo "[lights]"
	lines_of threshold
} >>"$work/pasted.conf"
check "the configuration takes its lines" "$INLAY" check --config "$work/pasted.conf"
"$INLAY" check --config "$work/pasted.conf" --print-config >"$work/pasted.print"
check "as its threshold" grep -qx "$(lines_of threshold)" "$work/pasted.print"

# A panorama of 8 x 4 texels: white above, grey below (PFM: little-endian, from the bottom up).
{
	printf 'PF\n8 4\n-1.0\n'
	for _ in {1..48}; do printf '\x00\x00\x80\x3e'; done
	for _ in {1..48}; do printf '\x00\x00\x80\x3f'; done
} >"$work/sky.pfm"

# ---- again, into the same folder ----
echo mine >"$out/notes.txt"
check "an earlier report is replaced" report "$work/box.scene" -o "$out/" \
	--panorama "$work/sky.pfm"
check "by a whole one" test -s "$out/report.html"
equal "of one surrounding" 1 "$(find "$out" -name 'picture-*.png' | wc -l)"
check "what is not a report's is kept" grep -rqx mine "$work" --include=notes.txt

# ---- wrong ----
wrong() { # NAME CODE WORDS COMMAND...: one sentence on stderr, and no folder
	local name=$1 code=$2 words=$3 is
	shift 3
	"$@" >"$work/said" 2>"$work/stderr" </dev/null
	is=$?
	if [ $is -ne "$code" ] || ! grep -qF -- "$words" "$work/stderr" || [ -s "$work/said" ]; then
		fail "$name" < <(printf '%s\n' "exit code $is, expected $code with \"$words\"" \
			"$(cat "$work/stderr")")
	elif [ "$code" -eq 1 ] && [ "$(wc -l <"$work/stderr")" -ne 1 ]; then
		fail "$name" < <(echo "more than one line" && cat "$work/stderr")
	else
		pass "$name"
	fi
	absent "$name: nothing is left" "$work/none"
}
sed 's/^frequency/frequencies/' "$work/pasted.scene" >"$work/mistaken.scene"
wrong "a pasted line that is no key" 1 "frequencies" "$INLAY_BAKE" render --quiet \
	"$work/mistaken.scene" -o "$work/none"
wrong "no folder" 2 "-o DIR is missing" report "$work/box.scene"
wrong "no scene" 2 "expected one scene file" report -o "$work/none"
wrong "an unknown option" 2 "unknown option --fast" report --fast "$work/box.scene" -o "$work/none"
wrong "a size that is none" 2 "expected a size" report --size 9 "$work/box.scene" -o "$work/none"
wrong "a value for --quiet" 2 "--quiet" report --quiet=9 "$work/box.scene" -o "$work/none"
wrong "no repetition" 2 "--repeat" report --repeat 0 "$work/box.scene" -o "$work/none"
wrong "a scene that is not there" 1 "missing.scene" report "$work/missing.scene" -o "$work/none"
wrong "a panorama that is not there" 1 "missing.hdr" report --panorama "$work/missing.hdr" \
	"$work/box.scene" -o "$work/none"
wrong "a panorama of code values" 1 "expected linear light" report \
	--panorama "$out/picture-1.png" "$work/box.scene" -o "$work/none"
wrong "a folder that cannot be made" 1 "no/none" report "$work/box.scene" -o "$work/no/none"
mkdir "$work/full"
echo mine >"$work/full/file"
wrong "a folder of somebody else's" 1 "holds files and no report.html" report "$work/box.scene" \
	-o "$work/full"
equal "keeps what it holds" "file" "$(ls "$work/full")"
finish
