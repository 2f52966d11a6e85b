#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs all of `make test` where a test that depends on the clock, on load or on luck would fail: beside eight
# busy loops, on one processor, and TIMES times in a row from new seeds. `make test-stress` calls it.
#     tests/stress.sh TIMES [busy|one|seeds]...      all three unless some are named
# A line for each run: its seconds by the clock, what it counted. Its whole output is kept in build/tests/stress.
set -u
cd "$(dirname "$0")/.." || exit 1
times=${1:-}
if ! [[ $times =~ ^[1-9][0-9]*$ ]]; then
	echo "usage: tests/stress.sh TIMES [busy|one|seeds]... (make test-stress TIMES=10)" >&2
	exit 2
fi
shift
logs=build/tests/stress
mkdir -p "$logs"
failed=0

# run NAME COMMAND...: COMMAND starts make.
run() {
	local name=$1 began=$SECONDS
	shift
	"$@" "${MAKE:-make}" --no-print-directory -j"$(nproc)" test-installed >"$logs/$name.log" 2>&1 </dev/null || failed=1
	printf '%-24s %5d s  %s\n' "$name" $((SECONDS - began)) "$(grep -E '^[0-9]+ passed, ' "$logs/$name.log" || echo "no end, see $logs/$name.log")"
	grep '^FAILED:' "$logs/$name.log" | sed 's/^/    /'
}

loops=()
trap 'kill "${loops[@]}" 2>/dev/null' EXIT
[ $# -gt 0 ] || set -- busy one seeds
for way; do
	case $way in
	busy)
		for _ in {1..8}; do
			while :; do :; done &
			loops+=($!)
		done
		run beside-eight-loops env
		kill "${loops[@]}"
		wait "${loops[@]}" 2>/dev/null
		loops=()
		;;
	one) run on-one-processor taskset -c 0 ;;
	seeds)
		first=$(date +%s)
		for ((seed = first; seed < first + times; seed++)); do
			run "seed-$seed" env INLAY_SEED=$seed
		done
		;;
	*)
		echo "tests/stress.sh: \"$way\", expected busy, one or seeds" >&2
		exit 2
		;;
	esac
done
exit $failed
