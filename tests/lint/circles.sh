#!/bin/bash
# SPDX-License-Identifier: MIT
# No two files call each other, directly or through others: a file can then be read with those below it alone.
# Read from objects: an edge goes from the file that uses a symbol to the file that defines it.
#
#     tests/lint/circles.sh BUILD FOLDER...
# BUILD/FOLDER holds the objects of FOLDER's sources, below the current folder. Objects whose source has gone are left out.
set -u
build=$1
shift
objects=()
while IFS= read -r object; do
	source=${object#"$build"/}
	source=${source%.o}
	[ -e "$source.c" ] || [ -e "$source.cpp" ] || continue
	objects+=("$object")
done < <(cd "$build" 2>/dev/null && find "$@" -name '*.o' -printf "$build/%p\n" 2>/dev/null)
[ ${#objects[@]} -gt 0 ] || {
	echo "$build: no objects of $*; build first" >&2
	exit 1
}
# Weak symbols are C++'s inline functions, of which every file has its own.
circles=$(nm -A -P "${objects[@]}" 2>/dev/null | sed "s|^$build/||; s/: / /" | awk '
	$3 == "U" { uses[++count] = $1 " " $2; next }
	$3 ~ /^[TDBRC]$/ { defined[$2] = $1 }
	END {
		for (i = 1; i <= count; i++) {
			split(uses[i], use, " ")
			if (use[2] in defined && defined[use[2]] != use[1]) print use[1], defined[use[2]]
		}
	}' | sort -u | tsort 2>&1 >/dev/null | sed 's/^tsort: //; s/^-: input contains a loop:/circle of calls:/')
[ -z "$circles" ] || {
	echo "$circles" >&2
	exit 1
}
