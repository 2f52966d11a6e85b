#!/bin/bash
# Inside the simulated machine: runs one test and writes its TAP to the job folder. A test that dies,
# hangs or says nothing is a failure; what it printed is kept beside.
#
#     guest.sh NAME           tests/vm/test_NAME.sh
set -u
name=$1
results=/run/job/results.tap
export VM_OUT=/run/job/out
limit=900 # a busy host's minute is long

result() { # ok|not ok, description
	echo "$1 - $name: $2" >>"$results"
}

dmesg -n 4 2>/dev/null
mkdir -p "$VM_OUT"
timeout $limit bash "tests/vm/test_$name.sh" >"$VM_OUT/output" 2>&1 </dev/null
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
elif [ $code -ne 0 ]; then
	result "not ok" "exit code $code"
	tail -n 15 "$VM_OUT/output" | sed 's/^/# /' >>"$results"
elif ! grep -q -E '^(not )?ok ' "$VM_OUT/output"; then
	result "not ok" "said nothing"
fi
dmesg >/run/job/kernel.log
# Linux 6.1 itself forgets the interrupt of a line that is watched when its chip goes away.
if grep -E 'BUG:|Oops|Kernel panic|WARNING: ' /run/job/kernel.log |
	grep -v 'WARNING: .* remove_proc_entry' >/run/job/kernel-faults; then
	result "not ok" "the kernel reported faults"
	sed 's/^/# /' /run/job/kernel-faults >>"$results"
fi
exit 0
