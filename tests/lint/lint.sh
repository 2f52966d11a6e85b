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
	sources | xargs -P "$(nproc)" -n 100 clang-format --dry-run -Werror
}
analysed() {
	cppcheck --quiet --error-exitcode=1 --std=c11 --inline-suppr -j "$(nproc)" -I. \
		--enable=warning,portability --suppress=missingIncludeSystem \
		--suppress=missingInclude --suppress=normalCheckLevelMaxBranches \
		-DWITH_KMS=1 -DWITH_SDL=1 -DWITH_GPIO=1 -DWITH_EXR=1 -DWITH_WEBP=1 -DWITH_LIBCAMERA=1 -DWITH_FFMPEG=1 -DWITH_CAIRO=1 \
		-DWITH_SYSTEMD=1 -DGPIOD_MAJOR=1 -D__linux__ -D__x86_64__ -D__GNUC__=12 \
		hal drivers config app bake
}
# A comment is a sentence: none begins as the rest of one.
worded() {
	! sources | xargs awk '
		FNR == 1 { open = 0 }
		open && match($0, /[^ \t*]/) { text = substr($0, RSTART); open = 0; judge() }
		/\/\*[ \t*]*$/ { open = 1; next }
		match($0, /(\/\*+|\/\/)[ \t]*[^ \t*]/) { text = substr($0, RSTART + RLENGTH - 1); judge() }
		function judge() {
			if (text ~ /^(Of|Which|Whose|To what|To which|By what|By which|For which|In which|With which|From which) /)
				print FILENAME ":" FNR ": begins in mid-sentence: " text
		}' | grep .
}
# What seeds have to reach has not been renamed: FILE:FUNCTION behind "reaches:" (tests/fuzz/coverage.sh).
named() {
	local file function missing=0
	while IFS=: read -r file function; do
		git ls-files -z "*/$file" | xargs -0 grep -qE "(^|[ *:])$function\(" && continue
		echo "tests/fuzz: there is no $function() in $file"
		missing=1
	done < <(sed -n '/reaches:/,/\*\//p' tests/fuzz/fuzz_*.c | grep -oE '[a-z0-9_]+\.[a-z]+:[A-Za-z0-9_]+' | sort -u)
	return $missing
}
uncircled() { # BUILD
	tests/lint/circles.sh "$1" hal drivers config app bake
}
parsed() {
	scripts | xargs -n 1 bash -n
}
scripted() {
	scripts | xargs -P "$(nproc)" -n 10 shellcheck -x -S warning
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
check "rooms: who includes whom, READMEs, files in a folder" tests/lint/rooms.sh
check "comments are sentences" worded
check "structs, comments and strings: their members, columns, lines" tests/lint/house.sh
check "folders within the lines that tests/lint/size gives them" tests/lint/size.sh
check "READMEs: their words, and where links lead" tests/lint/words.sh
check "bash reads every script" parsed
check "make help lists what the README names" helped
check "fuzz targets name functions that exist" named
if [ "${1:-}" != --quick ]; then
	check "shellcheck" scripted
	check "gcc, warnings as errors" built thread objects
	check "clang, warnings as errors" built fuzz objects
	check "cppcheck" analysed
	check "no files that call each other" uncircled build/sanitize-thread
else
	check "no files that call each other" uncircled "${BUILD:?is not set: expected the folder of the objects}"
fi
echo "1..$count"
exit $failed
