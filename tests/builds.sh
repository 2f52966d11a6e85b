# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced where tests need another build than the one under test. Building takes longer than much of what
# is tried, so each is made once: what lint compiles to see whether a compiler warns is what the fuzzers
# and the thread sanitizer run.

# built thread|address-undefined|fuzz TARGET...: in build/sanitize-thread, build/sanitize-address-undefined
# and build/fuzz. -g1 is for the lines that a report names; nobody debugs these.
built() {
	local kind=$1 folder flags=()
	shift
	case $kind in
	thread) # what a program cannot come to is left out of it: see sanitize/run.sh
		folder=build/sanitize-thread
		flags=(CC=gcc CXX=g++ SANITIZE=thread OPTIMIZE="-O1 -g1 -ffunction-sections"
			CFLAGS=-Werror CXXFLAGS=-Werror "LDFLAGS=-Wl,--gc-sections")
		;;
	address-undefined)
		folder=build/sanitize-address-undefined
		flags=("SANITIZE=address,undefined" OPTIMIZE="-O1 -g1")
		;;
	fuzz)
		folder=build/fuzz
		# nothing inlined: coverage.sh asks by name which functions are reached
		flags=(CC=clang CXX=clang++ FUZZER=1 "SANITIZE=address,undefined" OPTIMIZE="-O1 -g1 -fno-inline"
			CFLAGS=-Werror CXXFLAGS=-Werror)
		;;
	*)
		echo "tests/builds.sh: there is no build \"$kind\"" >&2
		return 1
		;;
	esac
	make --no-print-directory -j"$(nproc)" "${flags[@]}" BUILD=$folder "$@"
}
