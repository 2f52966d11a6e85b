#!/bin/bash
# The unit tests and a real `inlay run`, under address + undefined behaviour and thread sanitizers,
# and a real run under valgrind. Each flavour is a build of its own.
set -u
cd "$(dirname "$0")/../.." || exit 1
all_well=0

export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
export LSAN_OPTIONS=suppressions=tests/sanitize/leaks.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
export TSAN_OPTIONS=suppressions=tests/sanitize/races.supp:halt_on_error=1

for sanitize in address,undefined thread; do
	label=${sanitize//,/-}
	flavour=build/sanitize-$label
	make --no-print-directory -j"$(nproc)" SANITIZE=$sanitize BUILD="$flavour" OPTIMIZE="-O1 -g" \
		programs-unit "$flavour/inlay" "$flavour/inlay-bake" >"build/tests/logs/build-$label.log" 2>&1 || {
		tail -n 20 "build/tests/logs/build-$label.log"
		echo "fail sanitize/$label: does not build" >>build/tests/results
		all_well=1
		continue
	}
	programs=$(find "$flavour/tests/unit" "$flavour/tests/accuracy" -type f -perm -u+x -name 'test_*' \
		2>/dev/null | sort)
	# shellcheck disable=SC2086 # a list of paths below the project's root, which hold no blanks
	INLAY=$PWD/$flavour/inlay INLAY_BAKE=$PWD/$flavour/inlay-bake BUILD=$flavour \
		tests/run.sh "$label" $programs tests/sanitize/real_run.sh || all_well=1
done

INLAY="$PWD/${BUILD:-build}/inlay" INLAY_BAKE="$PWD/${BUILD:-build}/inlay-bake" \
	tests/run.sh valgrind tests/sanitize/valgrind.sh || all_well=1
exit $all_well
