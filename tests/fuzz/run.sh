#!/bin/bash
# SPDX-License-Identifier: MIT
# Whether every reader's corpus reaches what it is there for (coverage.sh), then some seconds of fuzzing of each by
# clang's libFuzzer with the address and undefined behaviour sanitizers.
#     FUZZ_SECONDS=600 tests/fuzz/run.sh [target...]      for a longer look
# A crash leaves its input in build/tests/crashes/ and prints how to repeat it.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/builds.sh
. tests/builds.sh
seconds=${FUZZ_SECONDS:-8}
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
echo "1..$((1 + ${#targets[@]}))"
count=0
failed=0
# verdict CODE NAME
verdict() {
	count=$((count + 1))
	if [ "$1" = 0 ]; then
		echo "ok $count - $2"
	else
		echo "not ok $count - $2"
		failed=1
	fi
}
missing=$(FUZZ_BUILT=1 tests/fuzz/coverage.sh "${targets[@]}")
code=$?
[ -z "$missing" ] || echo "# ${missing//$'\n'/$'\n'# }"
verdict $code "the seeds reach what their targets name"

# fuzzed TARGET: leaves its log; the exit code is libFuzzer's.
fuzzed() {
	local corpus=tests/fuzz/corpus/$1 grown code
	grown=$(mktemp -d)
	ASAN_OPTIONS=allocator_may_return_null=1 "$fuzzing/tests/fuzz/fuzz_$1" -max_total_time="$seconds" \
		-rss_limit_mb=2048 -timeout=10 -artifact_prefix="$crashes/$1-" -print_final_stats=1 \
		"$grown" "$corpus" >"build/tests/logs/fuzz-$1.log" 2>&1
	code=$?
	rm -rf "$grown"
	return $code
}
# As many at a time as there are processors; results are printed in order at the end.
declare -A process
for target in "${targets[@]}"; do
	while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do sleep 0.2; done
	fuzzed "$target" &
	process[$target]=$!
done
for target in "${targets[@]}"; do
	wait "${process[$target]}"
	code=$?
	log=build/tests/logs/fuzz-$target.log
	[ $code = 0 ] || tail -n 30 "$log" | sed 's/^/# /'
	grep -aE 'number_of_executed_units' "$log" | sed 's/^/# /'
	verdict $code "$target: $seconds s of fuzzing"
done
exit $failed
