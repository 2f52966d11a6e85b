#!/bin/bash
# SPDX-License-Identifier: MIT
# Holds the lines of each folder of sources against the table tests/lint/size, so that growth is decided and not found.
#     tests/lint/size.sh [ROOT]           complains of folders that are larger than their limit, or have none
#     tests/lint/size.sh --table [ROOT]   prints lines and limit of each, and the sums of product, tests and Markdown
#     tests/lint/size.sh --record [ROOT]  writes the table anew: each limit is the next hundred above
# A change that needs more raises the limit in a commit of its own, which says what the lines are for.
set -u
what=
[[ ${1:-} != --* ]] || { what=$1 && shift; }
cd "${1:-$(dirname "$0")/../..}" || exit 1
limits=tests/lint/size

# A line for each folder: lines, folder; for all shell scripts and all Markdown one each, "words" counting words.
measured() {
	find app drivers hal config bake tests -name '*.[ch]' -o -name '*.cpp' -o -name '*.hpp' | sort | xargs wc -l |
		awk '$2 ~ /\// { sub(/\/[^\/]*$/, "", $2); n[$2] += $1 } END { for (f in n) print n[f], f }' | sort -k2
}
case $what in
--record)
	measured | awk '{ print int(($1 + 99) / 100) * 100, $2 }' >"$limits"
	;;
--table)
	awk 'NR == FNR { limit[$2] = $1; next } { printf "%7d of %6d  %s\n", $1, limit[$2], $2 }' "$limits" <(measured)
	measured | awk '{ n[$2 ~ /^tests/] += $1 } END { printf "%7d lines of C in the product\n%7d in the tests\n", n[0], n[1] }'
	find board tests config -name '*.sh' -print0 | xargs -0 cat | wc -l | awk '{ printf "%7d of shell\n", $1 }'
	find . -path ./build -prune -o -name '*.md' -print0 | xargs -0 cat | wc -w | awk '{ printf "%7d words of Markdown\n", $1 }'
	;;
*)
	! awk 'NR == FNR { limit[$2] = $1; next }
		!($2 in limit) { print $2 ": has no limit in tests/lint/size"; next }
		$1 > limit[$2] { print $2 ": " $1 " lines, at most " limit[$2] " (tests/lint/size)" }' "$limits" <(measured) | grep .
	;;
esac
