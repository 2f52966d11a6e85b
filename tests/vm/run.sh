#!/bin/bash
# Runs tests/vm/test_*.sh (those whose name contains FILTER) in one boot of the simulated machine
# and prints their results as TAP while they come. Everything they leave is kept in
# $BUILD/tests/vm/job.
#
#     tests/vm/run.sh [FILTER]        (or FILTER in the environment)
set -uo pipefail

here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.." || exit 1
export BUILD=${BUILD:-build}
export INLAY=${INLAY:-$PWD/$BUILD/inlay} INLAY_BAKE=${INLAY_BAKE:-$PWD/$BUILD/inlay-bake}
INLAY_SHARED_DATA=$(realpath "${INLAY_SHARED_DATA:-../shared/data}" 2>/dev/null)
export INLAY_SHARED_DATA

job=$BUILD/tests/vm/job
rm -rf "$job"
mkdir -p "$job"
: >"$job/results.tap"

tests/vm/boot.sh "$job" tests/vm/guest.sh "${1:-${FILTER:-}}" &
boot=$!
tail -s 0.2 -f --pid=$boot "$job/results.tap" 2>/dev/null
wait $boot
code=$?

count=$(grep -c -E '^(not )?ok ' "$job/results.tap")
if [ $code -ne 0 ]; then
	echo "not ok $((count + 1)) - machine: stopped with exit code $code"
	tail -n 20 "$job/console.log" 2>/dev/null | sed 's/^/# /'
	count=$((count + 1))
fi
echo "1..$count"
[ $code -eq 0 ] && [ "$count" -gt 0 ] && ! grep -q '^not ok' "$job/results.tap"
