#!/bin/bash
# SPDX-License-Identifier: MIT
# Each fuzz target reads its corpus, built like everything else: no compiler of its own is needed.
set -u
cd "$(dirname "$0")/../.." || exit 1
count=0
failed=0
for source in tests/fuzz/fuzz_*.c; do
	target=$(basename "$source" .c)
	count=$((count + 1))
	if output=$("${BUILD:?the folder of the build}/tests/fuzz/$target" tests/fuzz/corpus/"${target#fuzz_}"/* 2>&1); then
		echo "ok $count - ${target#fuzz_}: corpus replayed"
	else
		sed 's/^/# /' <<<"$output"
		echo "not ok $count - ${target#fuzz_}: corpus replayed"
		failed=1
	fi
done
echo "1..$count"
exit $failed
