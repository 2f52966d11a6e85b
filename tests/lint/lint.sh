#!/bin/bash
# SPDX-License-Identifier: MIT
# What can be said about the sources without running them; one TAP line a check.
#     tests/lint/lint.sh           everything, with two builds of their own for the compilers' warnings
#     tests/lint/lint.sh --quick   what takes seconds
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/builds.sh
. tests/builds.sh
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
count=0
failed=0
check() { # name, command...
	local name=$1
	shift
	count=$((count + 1))
	if "$@" >"$scratch/log" 2>&1; then
		echo "ok $count - $name"
	else
		tail -n 40 "$scratch/log" | sed 's/^/# /'
		echo "not ok $count - $name"
		failed=1
	fi
}

sources() {
	git ls-files -co --exclude-standard -- '*.c' '*.h' '*.cpp' '*.hpp'
}
scripts() {
	git ls-files -co --exclude-standard -- '*.sh' .ci/run
}

formatted() {
	sources | xargs clang-format --dry-run -Werror
}
analysed() {
	cppcheck --quiet --error-exitcode=1 --std=c11 --inline-suppr -j "$(nproc)" -I. \
		--enable=warning,portability --suppress=missingIncludeSystem \
		--suppress=missingInclude --suppress=normalCheckLevelMaxBranches \
		-DWITH_KMS=1 -DWITH_SDL=1 -DWITH_GPIO=1 -DWITH_EXR=1 -DWITH_LIBCAMERA=1 -DWITH_CAIRO=1 \
		-DWITH_SYSTEMD=1 -DGPIOD_MAJOR=1 -D__linux__ -D__x86_64__ -D__GNUC__=12 \
		hal drivers config app bake
}
scripted() {
	scripts | xargs shellcheck -x -S warning
}
helped() { # every target with a comment is listed, and the ones that the README names exist
	make --no-print-directory help >"$scratch/help" &&
		grep -oE '`make [a-z-]+`' README.md | tr -d '`' | awk '{ print $2 }' | sort -u |
		while read -r target; do
			grep -q "^  $target " "$scratch/help" || {
				echo "README.md names make $target, which make help does not list"
				exit 1
			}
		done
}

check "formatted as .clang-format says" formatted
check "include rules" tests/lint/includes.sh
check "shellcheck" scripted
check "make help lists what the README names" helped
if [ "${1:-}" != --quick ]; then
	check "gcc, warnings as errors" built thread objects
	check "clang, warnings as errors" built fuzz objects
	check "cppcheck" analysed
fi
echo "1..$count"
exit $failed
