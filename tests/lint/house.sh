#!/bin/bash
# SPDX-License-Identifier: MIT
# What keeps a source readable and can be counted, of the files named, else of all:
# - no struct of the product has more than 25 members, but those whose members are a table of keys;
# - no comment is wider than 100 columns;
# - no string literal is torn whose line of text has at most 160 characters, but where bytes are
#   written as escapes, which would swallow what follows.
set -u
root=$(dirname "$0")/../..
[ $# -gt 0 ] || { cd "$root" && mapfile -t all < <(git ls-files -co --exclude-standard -- '*.c' '*.h' '*.cpp' '*.hpp') && set -- "${all[@]}"; }
# sim_options is the simulated camera's keys; hal/people is to be rebuilt in parts.
! LC_ALL=C awk -v tables=" sim_options people " '
	function columns(s,  i, n) {
		gsub(/[\200-\277]/, "", s) # what follows the first byte of a character
		for (i = 1; i <= length(s); i++)
			n += substr(s, i, 1) == "\t" ? 8 - n % 8 : 1
		return n
	}
	# Removes what may hold a comma or a semicolon that separates no members.
	function members(text) {
		while (gsub(/\([^()]*\)/, "", text) || gsub(/\[[^][]*\]/, "", text)) {}
		gsub(/enum [^;{]*\{[^}]*\}/, "enum ", text)
		return gsub(/[;,]/, "", text)
	}
	FNR == 1 { inside = comment = torn = 0 }
	{
		line = $0
		within = comment
		if (line ~ /\/\*/) within = 1
		if (within && line !~ /\/\*.*"|".*\/\*/ && columns(line) > 100)
			print FILENAME ":" FNR ": a comment is wider than 100 columns"
		if (torn > 0 && match(line, /^[ \t]*"([^"\\]|\\.)*"/)) {
			text = substr(line, RSTART, RLENGTH)
			sub(/\\n.*/, "", text)
			torn += length(text) - 2
			if ((line !~ /"$/ || line ~ /\\n/) && torn <= 160 && (before line) !~ /\\[x0-7]/)
				print FILENAME ":" FNR ": the string of the line before goes on here"
		}
		before = line
		if (within || line !~ /"$/ || line ~ /\\n"$/ || line ~ /^#/)
			torn = 0
		else if (torn == 0 || line ~ /\\n/) {
			match(line, /"([^"\\]|\\.)*"$/)
			text = substr(line, RSTART, RLENGTH)
			sub(/.*\\n/, "", text)
			torn = length(text)
		}
		# comments out
		if (comment) {
			if (line !~ /\*\//) next
			sub(/^.*\*\//, "", line)
			comment = 0
		}
		while (match(line, /\/\*[^*]*\*+([^\/*][^*]*\*+)*\//)) line = substr(line, 1, RSTART - 1) substr(line, RSTART + RLENGTH)
		if (line ~ /\/\*/) { sub(/\/\*.*/, "", line); comment = 1 }
	}
	FILENAME !~ /(^|\/)tests\// && !inside && line ~ /^(static |typedef )?struct [a-z_0-9]+ \{$/ {
		name = line; sub(/.*struct /, "", name); sub(/ .*/, "", name)
		inside = depth = 1; text = ""; start = FNR; next
	}
	inside {
		text = text line
		depth += gsub(/\{/, "{", line) - gsub(/\}/, "}", line)
		if (depth == 0) {
			inside = 0
			count = members(text) - 1
			if (count > 25 && index(tables, " " name " ") == 0)
				print FILENAME ":" start ": struct " name " has " count " members, at most 25"
		}
	}' "$@" | grep .
