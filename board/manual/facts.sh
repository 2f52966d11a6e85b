#!/bin/bash
# SPDX-License-Identifier: MIT
# What a program says of itself, as lines for other programs to read.
#     board/manual/facts.sh PROGRAM NAME [RUNNER]
# RUNNER is put before PROGRAM where it is built for another machine (qemu-aarch64).
#
# Reads PROGRAM --help, and --help of each command that it lists. Fields are separated by tabs:
#     command NAME        what follows is of this command; empty: of the program itself
#     usage LINE          one line of the usage, without "usage:"; the first ends what stands alone
#     break               a paragraph ends
#     head TEXT           a heading, without its colon
#     item TERM TEXT      an option with its argument, or a word, and what it means
#     code LINE           an indented line that is no item
#     text LINE           one line of a paragraph
set -euo pipefail
program=$1 name=$2 runner=${3:-}

facts() { # COMMAND
	# shellcheck disable=SC2086 # no command and no runner are no words
	$runner "$program" $1 --help | awk -v command="$1" -v name="$name" -f "${0%/*}/facts.awk"
}

own=$(facts "")
printf '%s\n' "$own"
commands=$(printf '%s\n' "$own" | awk -F'\t' '$1 == "item" && $2 ~ /^[a-z][a-z-]*$/ { print $2 }')
[ -n "$commands" ] || {
	echo "facts: $program --help lists no command" >&2
	exit 1
}
for command in $commands; do
	facts "$command"
done
