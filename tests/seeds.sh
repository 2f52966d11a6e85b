#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs every program of tests that draws random numbers again and again, each time from a seed that it
# has not had, and names the seeds that failed. `make test` keeps to one seed, so that what it says goes by
# what changed and not by luck; this is where luck is looked for.
#     tests/seeds.sh TIMES PROGRAM...
set -u
cd "$(dirname "$0")/.." || exit 1
times=${1:-}
if ! [[ $times =~ ^[1-9][0-9]*$ ]] || [ $# -lt 2 ]; then
	echo "usage: tests/seeds.sh TIMES PROGRAM... (make test-seeds TIMES=20)" >&2
	exit 2
fi
shift
logs=build/tests/seeds
rm -rf "$logs"
mkdir -p "$logs"
first=$(date +%s)

# one PROGRAM: as often as asked; a log is left for each seed that failed.
one() {
	local name seed log
	name=$(basename "$1")
	for ((seed = first; seed < first + times; seed++)); do
		log=$logs/$name-$seed.log
		if INLAY_SEED=$seed CMOCKA_MESSAGE_OUTPUT=TAP "$1" >"$log" 2>&1 </dev/null; then
			# One that draws nothing says no seed, and would only be the same again.
			grep -q 'INLAY_SEED=' "$log" || seed=$((first + times))
			rm "$log"
		else
			echo "$name: INLAY_SEED=$seed fails: $log"
			grep -A 3 '^not ok' "$log" | head -n 8 | sed 's/^/    /'
		fi
	done
}

running=0
for program in "$@"; do
	if [ $running -ge "${TEST_JOBS:-$(nproc)}" ]; then
		wait -n
		running=$((running - 1))
	fi
	one "$program" &
	running=$((running + 1))
done
wait
failed=$(find "$logs" -name '*.log' | wc -l)
echo "$times seeds from $first: $failed failed"
[ "$failed" -eq 0 ]
