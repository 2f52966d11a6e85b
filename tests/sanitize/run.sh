#!/bin/bash
# SPDX-License-Identifier: MIT
# The unit tests and a real `inlay run`, under address + undefined behaviour and thread sanitizers,
# and a real run under valgrind. Each flavour is a build of its own.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/builds.sh
. tests/builds.sh
all_well=0

export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
export LSAN_OPTIONS=suppressions=tests/sanitize/leaks.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
export TSAN_OPTIONS=suppressions=tests/sanitize/races.supp:halt_on_error=1

# threaded PROGRAM...: those that can come to where a thread is started: what they cannot come to is not
# linked into them (--gc-sections). libcamera calls from threads of its own. Two only bake once on the way,
# as real_run.sh does, or go through OpenCV, which is not built to be watched. tests/accuracy and
# test_bake_energy measure, for minutes, what the unit tests of the compositor and test_bake_determinism do
# with as many threads.
threaded() {
	local program
	for program in "$@"; do
		case $program in
		*/test_camera_libcamera) echo "$program" ;;
		*/test_light_ground | */test_live_collect | */test_bake_energy | */tests/accuracy/*) ;;
		*) ! nm --undefined-only "$program" | grep -q ' pthread_create' || echo "$program" ;;
		esac
	done
}

for label in address-undefined thread; do
	flavour=build/sanitize-$label
	built "$label" programs-unit "$flavour/inlay" "$flavour/inlay-bake" \
		>"build/tests/logs/build-$label.log" 2>&1 || {
		tail -n 20 "build/tests/logs/build-$label.log"
		echo "fail sanitize/$label: does not build" >>build/tests/results
		all_well=1
		continue
	}
	programs=$(find "$flavour/tests/unit" "$flavour/tests/accuracy" -type f -perm -u+x -name 'test_*' \
		2>/dev/null | sort)
	# shellcheck disable=SC2086 # a list of paths below the project's root, which hold no blanks
	[ $label != thread ] || programs=$(threaded $programs)
	# The long ones first, so that none is left alone at the end: real_run.sh and what a person may do, then
	# tests/accuracy.
	# shellcheck disable=SC2086
	INLAY=$PWD/$flavour/inlay INLAY_BAKE=$PWD/$flavour/inlay-bake BUILD=$flavour \
		INLAY_ACTIONS=600 \
		tests/run.sh "$label" tests/sanitize/real_run.sh tests/cli/actions.sh $programs || all_well=1
done

INLAY="$PWD/${BUILD:-build}/inlay" INLAY_BAKE="$PWD/${BUILD:-build}/inlay-bake" \
	tests/run.sh valgrind tests/sanitize/valgrind.sh || all_well=1
exit $all_well
