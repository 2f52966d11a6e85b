#!/bin/bash
# Inside the simulated machine: runs each test, one after another, and writes their TAP to the job
# folder. A test that dies, hangs or says nothing is a failure; what it printed is kept beside.
#
#     guest.sh [FILTER]
set -u
results=/run/job/results.tap
count=0

result() { # ok|not ok, description
	count=$((count + 1))
	echo "$1 $count - $2" >>"$results"
}

dmesg -n 4 2>/dev/null
for test in tests/vm/test_*.sh; do
	name=$(basename "$test" .sh)
	name=${name#test_}
	case $name in *"$1"*) ;; *) continue ;; esac
	export VM_OUT=/run/job/$name
	mkdir -p "$VM_OUT"
	started=$SECONDS
	timeout 400 bash "$test" >"$VM_OUT/output" 2>&1 </dev/null
	code=$?
	while IFS= read -r line; do
		case $line in
		"ok "*) result "ok" "$name: ${line#ok }" ;;
		"not ok "*)
			result "not ok" "$name: ${line#not ok }"
			;;
		"# "*) echo "$line" >>"$results" ;;
		esac
	done <"$VM_OUT/output"
	if [ $code -eq 124 ]; then
		result "not ok" "$name: took more than 400 s"
	elif [ $code -ne 0 ]; then
		result "not ok" "$name: exit code $code"
		tail -n 15 "$VM_OUT/output" | sed 's/^/# /' >>"$results"
	elif ! grep -q -E '^(not )?ok ' "$VM_OUT/output"; then
		result "not ok" "$name: said nothing"
	fi
	echo "# $name took $((SECONDS - started)) s" >>"$results"
done
dmesg >/run/job/kernel.log
# Linux 6.1 itself forgets the interrupt of a line that is watched when its chip goes away.
if grep -E 'BUG:|Oops|Kernel panic|WARNING: ' /run/job/kernel.log |
	grep -v 'WARNING: .* remove_proc_entry' >/run/job/kernel-faults; then
	result "not ok" "kernel: reported faults"
	sed 's/^/# /' /run/job/kernel-faults >>"$results"
fi
exit 0
