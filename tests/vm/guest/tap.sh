# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by the tests: says what holds and what does not, and goes on either way.

ok() {
	echo "ok $*"
}

not_ok() { # description; what went wrong on stdin
	echo "not ok $1"
	sed 's/^/# /'
}

# check DESCRIPTION COMMAND...: the command succeeds; what it prints is shown when it does not.
check() {
	local description=$1 output
	shift
	if output=$("$@" 2>&1); then
		ok "$description"
	else
		printf '%s\n' "exit code $? of: $*" "$output" | not_ok "$description"
	fi
}

# equal DESCRIPTION EXPECTED ACTUAL
equal() {
	if [ "$2" = "$3" ]; then
		ok "$1"
	else
		printf '%s\n' "expected: $2" "is: $3" | not_ok "$1"
	fi
}

# holds DESCRIPTION AWK-CONDITION: over numbers, as in holds "rate" "24 < $r && $r < 26"
holds() {
	if awk "BEGIN { exit !($2) }" </dev/null; then
		ok "$1"
	else
		echo "not so: $2" | not_ok "$1"
	fi
}

# matches DESCRIPTION EXTENDED-REGEX TEXT
matches() {
	if grep -q -E -e "$2" <<<"$3"; then
		ok "$1"
	else
		printf '%s\n' "no match for: $2" "in: $3" | not_ok "$1"
	fi
}

# eventually COMMAND...: tries until the command succeeds; fails after four minutes, in simulated time one.
# The pauses grow, and none of them is a process: one costs more than what it waits for.
exec {never}<> <(:)
eventually() {
	local limit=$((SECONDS + ${VM_PATIENCE:-240})) pauses=(0.02 0.05 0.1 0.2 0.5 1) i=0
	until "$@" >/dev/null 2>&1; do
		[ $SECONDS -lt $limit ] || return 1
		read -rt "${pauses[i]}" -u "$never"
		[ $i -eq 5 ] || i=$((i + 1))
	done
}
