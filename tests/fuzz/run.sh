#!/bin/bash
# Every reader's fuzz target: its corpus replayed by the plain gcc build, then some seconds of real
# fuzzing by clang's libFuzzer with the address and undefined behaviour sanitizers.
#     FUZZ_SECONDS=600 tests/fuzz/run.sh [target...]      for a longer look
# A crash leaves its input in build/tests/crashes/ and prints how to repeat it.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/builds.sh
. tests/builds.sh
seconds=${FUZZ_SECONDS:-8}
plain=${BUILD:?the folder of the plain build}
fuzzing=build/fuzz
crashes=build/tests/crashes
log=build/tests/logs/fuzz-build.log
mkdir -p "$crashes" build/tests/logs

built fuzz programs-fuzz >"$log" 2>&1 || {
	tail -n 20 "$log"
	echo "not ok 1 - fuzz targets build with clang"
	exit 1
}

targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
	for source in tests/fuzz/fuzz_*.c; do
		source=${source##*/fuzz_}
		targets+=("${source%.c}")
	done
fi
echo "1..$((2 * ${#targets[@]}))"
count=0
failed=0
verdict() { # code, name
	if [ "$1" = 0 ]; then
		echo "ok - $2"
	else
		echo "not ok - $2"
	fi
}
# one TARGET: both of its tests, not numbered.
one() {
	local target=$1 corpus=tests/fuzz/corpus/$1 grown code
	"$plain/tests/fuzz/fuzz_$target" "$corpus"/* 2>&1 | sed 's/^/# /'
	verdict "${PIPESTATUS[0]}" "$target: corpus replayed"
	grown=$(mktemp -d)
	ASAN_OPTIONS=allocator_may_return_null=1 "$fuzzing/tests/fuzz/fuzz_$target" -max_total_time="$seconds" \
		-rss_limit_mb=2048 -timeout=10 -artifact_prefix="$crashes/$target-" -print_final_stats=1 \
		"$grown" "$corpus" >"build/tests/logs/fuzz-$target.log" 2>&1
	code=$?
	[ $code = 0 ] || tail -n 30 "build/tests/logs/fuzz-$target.log" | sed 's/^/# /'
	grep -E 'number_of_executed_units' "build/tests/logs/fuzz-$target.log" | sed 's/^/# /'
	verdict $code "$target: $seconds s of fuzzing"
	rm -rf "$grown"
}
# As many at a time as there are processors; told in order at the end.
for target in "${targets[@]}"; do
	[ "$(jobs -rp | wc -l)" -lt "$(nproc)" ] || wait -n
	one "$target" >"build/tests/logs/fuzz-$target.tap" &
done
wait
for target in "${targets[@]}"; do
	while IFS= read -r line; do
		case $line in
		"ok - "*) echo "ok $((++count)) ${line#ok }" ;;
		"not ok - "*)
			echo "not ok $((++count)) ${line#not ok }"
			failed=1
			;;
		*) echo "$line" ;;
		esac
	done <"build/tests/logs/fuzz-$target.tap"
	rm "build/tests/logs/fuzz-$target.tap"
done
exit $failed
