#!/bin/bash
# SPDX-License-Identifier: MIT
# Soaks the kiosk in two simulated machines: as it is in user-mode Linux, and built with the address and
# undefined behaviour sanitizers in QEMU (they take more addresses than a process has in the former). Prints both tables; their files stay in $BUILD/tests/vm/soak-*.
# Meanwhile the sanitized one is given actions, reloads and damaged files at random on this machine.
#
#     run_soak.sh MINUTES [SEED]      (half of the time each)
#     run_soak.sh --check MINUTES [SEED]      only says whether these are such
set -uo pipefail

here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.." || exit 1

check=
if [ "${1:-}" = --check ]; then
	check=yes
	shift
fi
if ! [[ ${1:-10} =~ ^[0-9]*\.?[0-9]+$ && ${1:-10} == *[1-9]* ]]; then
	echo "soak: MINUTES is \"$1\", expected a number above 0" >&2
	exit 2
fi
if ! [[ ${2:-0} =~ ^[0-9]+$ ]]; then
	echo "soak: SEED is \"$2\", expected a whole number" >&2
	exit 2
fi
[ -z "$check" ] || exit 0
: "${BUILD:?is not set: expected the folder that holds inlay}"
: "${SANITIZED:?is not set: expected the folder of the sanitized build}"
minutes=$(awk "BEGIN { print ${1:-10} / 2 }")
seed=${2:-$RANDOM}
code=0

# soak MACHINE NAME PROGRAM SLACK_KB
soak() {
	local machine=$1 job=$BUILD/tests/vm/soak-$2
	shift
	rm -rf "$job"
	mkdir -p "$job/soak"
	echo "soak: $1, $minutes minutes of faults, seed $seed"
	INLAY=$2 "tests/vm/$machine.sh" --seconds "$(awk "BEGIN { print int($minutes * 180 + 600) }")" "$job" \
		env VM_OUT=/run/job/soak ASAN_OPTIONS=quarantine_size_mb=4:detect_leaks=1 \
		LSAN_OPTIONS=suppressions=tests/sanitize/leaks.supp:print_suppressions=0 \
		UBSAN_OPTIONS=print_stacktrace=1 bash -c \
		"tests/vm/soak.sh $minutes $seed $3 >/run/job/results.tap" || code=1
	grep -v '^#' "$job/results.tap"
	column -t "$job/soak/soak.txt"
	grep -q '^ok' "$job/results.tap" && ! grep -q '^not ok' "$job/results.tap" || code=1
}

actions=$BUILD/tests/vm/soak-actions.tap
INLAY=$PWD/$SANITIZED/inlay INLAY_BAKE=$PWD/$BUILD/inlay-bake INLAY_SEED=$seed \
	INLAY_ACTIONS=$(awk "BEGIN { print int($minutes * 4000) }") tests/cli/actions.sh >"$actions" 2>&1 &
random=$!
soak uml plain "$PWD/$BUILD/inlay" 1024
soak qemu sanitized "$PWD/$SANITIZED/inlay" 8192
wait $random || code=1
cat "$actions"
exit $code
