#!/bin/bash
# SPDX-License-Identifier: MIT
# Every table of kernels against the specification.
#     tests/kernels/kernels.sh             the tables of this processor
#     tests/kernels/kernels.sh --emulated  those that it has not, and the choice among them, on emulated ones
set -u
cd "$(dirname "$0")/../.." || exit 1
: "${BUILD:?the folder of the build}"
arm=build/kernels-aarch64
count=0
failed=0

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# run NAME COMMAND...: as many at a time as there are processors; told in order at the end.
names=()
commands=()
run() {
	local output=$scratch/${#names[@]}
	names+=("$1")
	shift
	commands+=("$*")
	[ "$(jobs -rp | wc -l)" -lt "$(nproc)" ] || wait -n
	{
		"$@" >"$output" 2>&1
		echo $? >"$output.code"
	} &
}
# tell NUMBER: its tests are counted on as ours. One that ends early is a failure.
tell() {
	local name=${names[$1]} output=$scratch/$1 code
	code=$(cat "$output.code")
	echo "# $name: ${commands[$1]}"
	while IFS= read -r line; do
		case "$line" in
		"ok "* | "not ok "*)
			count=$((count + 1))
			echo "${line%%ok *}ok $count - $name: ${line#* - }"
			;;
		1..*) ;;
		*) echo "# ${line#\# }" ;;
		esac
	done <"$output"
	if ! grep -q '^1\.\.' "$output"; then
		count=$((count + 1))
		echo "not ok $count - $name: ended early, exit code $code"
	fi
	[ "$code" -eq 0 ] || failed=1
}
# present NAME PROGRAM PACKAGE: a machine that runs the tests has it.
present() {
	command -v "$2" >/dev/null && return
	count=$((count + 1))
	failed=1
	echo "# there is no $2, expected Debian's package $3 (board/deps.sh deep installs it)"
	echo "not ok $count - $1"
	return 1
}
# lists NAME: the system says that the processor has it.
lists() {
	grep -m1 -E '^(flags|Features)' /proc/cpuinfo | grep -qw "$1"
}

machine=$(uname -m)
emulated=${1:-}
program=$BUILD/tests/kernels/test_kernels
needed=()
case "$machine" in
x86_64)
	lists sse4_1 && needed+=(--need sse4.1)
	lists avx2 && needed+=(--need avx2)
	lists avx512_vnni && lists avx512bw && lists avx512dq && lists avx512vl &&
		needed+=(--need avx512-vnni)
	;;
aarch64)
	needed+=(--need neon)
	lists asimddp && needed+=(--need neon-dotprod)
	;;
esac
[ -n "$emulated" ] || run native "$program" "${needed[@]}"

# Fewer rounds where an emulator does the work; still every width, every length of a run.
rounds=300
if [ -n "$emulated" ] && [ "$machine" = x86_64 ] && present "older processors" qemu-x86_64-static qemu-user-static; then
	if readelf -lW "$program" | grep -q INTERP; then
		echo "# this build is not static (a sanitizer's): older processors are left out"
	else
		run "AVX2 (Haswell)" qemu-x86_64-static -cpu Haswell "$program" \
			--rounds $rounds --need avx2 --choose avx2
		run "SSE4.1 (Penryn)" qemu-x86_64-static -cpu Penryn "$program" \
			--rounds $rounds --need sse4.1 --choose sse4.1
		run "no SSE4.1 (Conroe)" qemu-x86_64-static -cpu Conroe "$program" \
			--rounds $rounds --choose c
	fi
fi
if [ -n "$emulated" ] && [ "$machine" = x86_64 ] && present "Arm" aarch64-linux-gnu-gcc gcc-aarch64-linux-gnu &&
	present "Arm" qemu-aarch64-static qemu-user-static; then
	if output=$(env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL -u SANITIZE -u CFLAGS make \
		--no-print-directory CC=aarch64-linux-gnu-gcc BUILD=$arm \
		$arm/tests/kernels/test_kernels 2>&1); then
		run "NEON (Cortex-A72)" qemu-aarch64-static -cpu cortex-a72 \
			$arm/tests/kernels/test_kernels --rounds $rounds \
			--need neon --choose neon
		run "NEON with dot products" qemu-aarch64-static -cpu max \
			$arm/tests/kernels/test_kernels --rounds $rounds \
			--need neon --need neon-dotprod --choose neon-dotprod
	else
		count=$((count + 1))
		failed=1
		sed 's/^/# /' <<<"$output"
		echo "not ok $count - Arm: the test builds"
	fi
fi
wait
for number in "${!names[@]}"; do
	tell "$number"
done
echo "1..$count"
exit $failed
