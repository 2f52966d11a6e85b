#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs tests/vm/test_*.sh or tests/vm/qemu/test_*.sh, each in a simulated machine of its own, as many at a time as there are
# processors (VM_MACHINES=n: so many), and prints their results as TAP when each ends.
# Everything they leave is kept in $BUILD/tests/vm/job/NAME/NAME.
#
#     tests/vm/run.sh quick            the few that show the whole way, in one machine
#     tests/vm/run.sh uml [FILTER]     those in user-mode Linux, whose names contain FILTER
#     tests/vm/run.sh qemu [FILTER]    those in QEMU
set -uo pipefail

here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.." || exit 1
export BUILD=${BUILD:-build}
export INLAY=${INLAY:-$PWD/$BUILD/inlay} INLAY_BAKE=${INLAY_BAKE:-$PWD/$BUILD/inlay-bake}
INLAY_SHARED_DATA=$(realpath "${INLAY_SHARED_DATA:-../shared/data}" 2>/dev/null)
export INLAY_SHARED_DATA
which=$1 filter=${2:-}
quick='live thesis'
jobs=$BUILD/tests/vm/job
rm -rf "$jobs"
mkdir -p "$jobs"
if [ "$(uname -m)" != x86_64 ]; then
	printf '1..1\nok 1 - simulated hardware # SKIP its kernel needs an x86_64, this is a %s\n' "$(uname -m)"
	exit 0
fi
tests/vm/bake.sh $([ "$which" = uml ] || echo --quick) || exit 1

# one NAME...: boots a machine for them, in this order.
one() {
	local job begun=$SECONDS code=0
	job=$jobs/$(IFS=-; echo "$*")
	mkdir -p "$job"
	: >"$job/results.tap"
	"tests/vm/${which/quick/uml}.sh" --seconds $((1200 * $#)) "$job" tests/vm/guest/guest.sh "$@" || code=$?
	if [ $code -ne 0 ]; then
		echo "not ok - $*: the machine stopped with exit code $code" >>"$job/results.tap"
		tail -n 20 "$job/console.log" 2>/dev/null | sed 's/^/# /' >>"$job/results.tap"
	fi
	echo "# $* took $((SECONDS - begun)) s" >>"$job/results.tap"
	mv "$job/results.tap" "$job/done.tap"
}

# Prints the results that have arrived since the last call, numbered on.
count=0
failed=0
report() {
	local results line
	for results in "$jobs"/*/done.tap; do
		[ -e "$results" ] || continue
		while IFS= read -r line; do
			case $line in
			"ok "*) echo "ok $((++count)) ${line#ok }" ;;
			"not ok "*)
				echo "not ok $((++count)) ${line#not ok }"
				failed=1
				;;
			*) echo "$line" ;;
			esac
		done <"$results"
		mv "$results" "${results%done.tap}results.tap"
	done
}

# The longest to read first, so that none is left alone at the end.
machines=() # a line of names each
if [ "$which" = quick ]; then
	machines=("$quick")
else
	folder=tests/vm
	[ "$which" = uml ] || folder=tests/vm/qemu
	for name in $(wc -l $folder/test_*.sh | sort -rn | sed -n 's|.*/test_\(.*\)\.sh$|\1|p'); do
		[[ $name != *"$filter"* ]] || machines+=("$name")
	done
fi
running=0
for machine in "${machines[@]}"; do
	while [ $running -ge "${VM_MACHINES:-$(nproc)}" ]; do
		wait -n
		running=$((running - 1))
		report
	done
	# shellcheck disable=SC2086 # a list of names
	one $machine &
	running=$((running + 1))
done
while [ $running -gt 0 ]; do
	wait -n
	running=$((running - 1))
	report
done
echo "1..$count"
[ $count -gt 0 ] && [ $failed -eq 0 ]
