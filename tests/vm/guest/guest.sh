#!/bin/bash
# SPDX-License-Identifier: MIT
# Inside the simulated machine: runs tests and writes their TAP to the job folder. A test that dies,
# hangs or says nothing is a failure; what it printed is kept beside.
#
#     guest.sh NAME...           test_NAME.sh in tests/vm or tests/vm/qemu
set -u
results=/run/job/results.tap
limit=900 # a busy host's minute is long

result() { # ok|not ok, description
	echo "$1 - $name: $2" >>"$results"
}

# The programs, each of their threads, and where in the kernel it waits. Without one more program:
# what hangs may be the machine.
running() {
	local task words where
	for task in /proc/[0-9]*/task/[0-9]*; do
		mapfile -d '' words <"${task%/task/*}/cmdline"
		[ ${#words[@]} -gt 0 ] || continue # the kernel's own
		where=
		read -r where <"$task/wchan" # it has no end of line
		echo "${task#/proc/} ${words[*]:0:3}: $where"
	done
}

# one NAME
one() {
	local code line script
	name=$1
	export VM_OUT=/run/job/$name
	mkdir -p "$VM_OUT"
	# A test that hangs is looked at before its end takes away what it hung on.
	(sleep $((limit - 10)) && running) >"$VM_OUT/running" 2>/dev/null &
	script=tests/vm/test_$name.sh
	[ -e "$script" ] || script=tests/vm/qemu/test_$name.sh
	timeout $limit bash "$script" >"$VM_OUT/output" 2>&1 </dev/null
	code=$?
	while IFS= read -r line; do
		case $line in
		"ok "*) result "ok" "${line#ok }" ;;
		"not ok "*) result "not ok" "${line#not ok }" ;;
		"# "*) echo "$line" >>"$results" ;;
		esac
	done <"$VM_OUT/output"
	if [ $code -eq 124 ]; then
		result "not ok" "took more than $limit s"
		tail -n 3 "$VM_OUT/output" | cat - "$VM_OUT/running" | sed 's/^/# /' >>"$results"
	elif [ $code -ne 0 ]; then
		result "not ok" "exit code $code"
		tail -n 15 "$VM_OUT/output" | sed 's/^/# /' >>"$results"
	elif ! grep -q -E '^(not )?ok ' "$VM_OUT/output"; then
		result "not ok" "said nothing"
	fi
}

dmesg -n 4 2>/dev/null
for test; do
	one "$test"
done
dmesg >/run/job/kernel.log
# Linux 6.1 itself forgets the interrupt of a line that is watched when its chip goes away.
if grep -E 'BUG:|Oops|Kernel panic|WARNING: ' /run/job/kernel.log |
	grep -v 'WARNING: .* remove_proc_entry' >/run/job/kernel-faults; then
	result "not ok" "the kernel reported faults"
	sed 's/^/# /' /run/job/kernel-faults >>"$results"
fi
exit 0
