#!/bin/bash
# SPDX-License-Identifier: MIT
# Documentation stays short: the top README has at most 900 words, a room's 300 words of prose, more where a line
# below says why. Prose is what stands outside of tables, headings and code. Relative links lead to what exists.
#
#     tests/lint/words.sh [ROOT]
set -u
cd "${1:-$(dirname "$0")/../..}" || exit 1
# FILE WORDS REASON. Growth is no reason.
more="
CHANGELOG.md 3000 a list that only grows
CONTRIBUTING.md 400 the way through all rooms
app/kiosk/README.md 750 the manual of whoever runs a kiosk
bake/README.md 700 the manual of whoever bakes
bake/calibrate/README.md 750 the manual of whoever calibrates, step by step
bake/encode/README.md 750 specifies how blocks are chosen
hal/basis/README.md 850 specifies what a reader accepts
hal/compositor/README.md 1800 specifies the integer arithmetic, with its proofs
hal/optics/README.md 560 specifies lights and lenses
tests/accuracy/README.md 760 says how to read twelve measurements
"
mapfile -t files < <(find app bake board config drivers hal tests ./*.md -name '*.md' | sed 's|^\./||' | sort)

bad=0
words=$(wc -w <README.md)
[ "$words" -le 900 ] || {
	echo "README.md: $words words; expected at most 900" >&2
	bad=1
}
awk -v more="$more" '
	function judge() {
		if (file != "" && file != "README.md" && words > limit[file])
			printf "%s: %d words of prose; expected at most %d\n", file, words, limit[file]
	}
	BEGIN {
		count = split(more, line, "\n")
		for (i = 1; i <= count; i++) if (split(line[i], field, " ") > 2) limit[field[1]] = field[2]
	}
	FNR == 1 {
		judge()
		file = FILENAME
		if (!(file in limit)) limit[file] = 300
		words = 0
	}
	!/^(\||#|    )/ { words += NF }
	END { judge() }' "${files[@]}" | grep . >&2 && bad=1
for file in "${files[@]}"; do
	while read -r target; do
		[ -e "$(dirname "$file")/$target" ] || {
			echo "$file: the link to \"$target\" leads nowhere" >&2
			bad=1
		}
	done < <(grep -oE '\]\([^)#]+' "$file" | cut -c3- | grep -vE '^[a-z]+:')
done
exit $bad
