#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs tests/vm/test_*.sh, each in a simulated machine of its own, as many at a time as there are
# processors, and prints their results as TAP when each ends.
# Everything they leave is kept in $BUILD/tests/vm/job/NAME/NAME.
#
#     tests/vm/run.sh [FILTER]   those whose name contains FILTER (or FILTER in the environment)
#     tests/vm/run.sh --quick    the few that show the whole way, in as few machines as may be
#     tests/vm/run.sh --rest     the others
# VM_MACHINES=n: so many at a time.
set -uo pipefail

here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.." || exit 1
export BUILD=${BUILD:-build}
export INLAY=${INLAY:-$PWD/$BUILD/inlay} INLAY_BAKE=${INLAY_BAKE:-$PWD/$BUILD/inlay-bake}
INLAY_SHARED_DATA=$(realpath "${INLAY_SHARED_DATA:-../shared/data}" 2>/dev/null)
export INLAY_SHARED_DATA
which=${1:-${FILTER:-}}
quick=('live thesis' libcamera) # machines; libcamera takes devices away below udevd, so it has one of its own
jobs=$BUILD/tests/vm/job
rm -rf "$jobs"
mkdir -p "$jobs"

# one NAME...: boots a machine for them, in this order.
one() {
	local job begun=$SECONDS code=0
	job=$jobs/$(IFS=-; echo "$*")
	mkdir -p "$job"
	: >"$job/results.tap"
	tests/vm/uml.sh --seconds $((1200 * $#)) "$job" tests/vm/guest/guest.sh "$@" || code=$?
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

# chosen NAME
chosen() {
	case $which in
	--rest) [[ " ${quick[*]} " != *" $1 "* ]] ;;
	*) [[ $1 == *"$which"* ]] ;;
	esac
}

# The longest first, so that none is left alone at the end: two that last more than a minute however
# short they are to read, then by length.
names=$(wc -l tests/vm/test_*.sh | sort -rn | sed -n 's|.*tests/vm/test_\(.*\)\.sh$|\1|p')
lasting='soak faults_late'
machines=() # a line of names each
if [ "$which" = --quick ]; then
	machines=("${quick[@]}")
else
	for name in $lasting $(grep -vxF "${lasting// /$'\n'}" <<<"$names"); do
		! chosen "$name" || machines+=("$name")
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
