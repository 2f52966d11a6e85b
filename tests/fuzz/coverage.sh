#!/bin/bash
# SPDX-License-Identifier: MIT
# Whether the seeds of each fuzz target reach the functions that it is there for. A target names them, FILE:FUNCTION
# each, behind "reaches:" in the comment at its beginning. One whose seeds are all refused at the first check would
# pass every other test.
#     tests/fuzz/coverage.sh [target...]
# FUZZ_BUILT=1: the fuzzers are there already. Fails for what is not reached, and for what there is no function of.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/builds.sh
. tests/builds.sh
fuzzing=build/fuzz/tests/fuzz
log=build/tests/logs/fuzz-coverage.log
mkdir -p build/tests/logs build/tests/crashes
[ "${FUZZ_BUILT:-}" ] || built fuzz programs-fuzz >&2 || exit 1

# wanted SOURCE: FILE:FUNCTION, a line each.
wanted() {
	sed -n '/reaches:/,/\*\//p' "$1" | grep -oE '[a-z0-9_]+\.[a-z]+:[A-Za-z0-9_]+'
}
# functions TARGET: COVERED or UNCOVERED, FILE:FUNCTION; of C++ without namespace, class and arguments. Fails if a seed does.
functions() {
	"$fuzzing/fuzz_$1" -print_coverage=1 -runs=0 -artifact_prefix="build/tests/crashes/$1-" \
		"tests/fuzz/corpus/$1" >"$log" 2>&1 || return
	sed -nE 's|^(UN)?(COVERED)_FUNC: .* edges: [0-9/]+ (\(?[A-Za-z0-9_ ]+\)?::)*([A-Za-z0-9_]+)(\(.*)? '\
'.*/([^/:]+):[0-9]+$|\1\2 \6:\4|p' "$log"
}
# one TARGET: 0, or what is missing.
one() {
	local found names name missing=0
	found=$(functions "$1") || {
		echo "$1: fails with its seeds:"
		grep -aE 'Running:|ERROR|runtime error|SUMMARY' "$log"
		return 1
	}
	names=$(wanted "tests/fuzz/fuzz_$1.c")
	[ "$names" ] || {
		echo "$1: names no function that its seeds reach"
		return 1
	}
	for name in $names; do
		case $'\n'$found$'\n' in
		*$'\nCOVERED '"$name"$'\n'*) ;;
		*$'\nUNCOVERED '"$name"$'\n'*)
			echo "$1: no seed reaches $name"
			missing=1
			;;
		*)
			echo "$1: there is no function $name, or the compiler has put it into another"
			missing=1
			;;
		esac
	done
	return $missing
}

targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
	for source in tests/fuzz/fuzz_*.c; do
		source=${source##*/fuzz_}
		targets+=("${source%.c}")
	done
fi
failed=0
for target in "${targets[@]}"; do
	one "$target" || failed=1
done
exit $failed
