#!/bin/bash
# SPDX-License-Identifier: MIT
# The simulated machine in user-mode Linux: a kernel that is a process of this host, at the processor's
# speed. Its time is simulated: it stands still while a program computes, and jumps to the next event
# when all of them wait, so that nothing in it depends on how busy the host is, and a wait costs
# nothing. VM_CLOCK=host in the environment: the host's time instead. boot.sh says how it is called.
# shellcheck source=tests/vm/boot.sh
. "$(dirname "$0")/boot.sh"

kernel=$("$source_dir/board/build-kernel.sh" uml)
VM_PATIENCE=60 write_start "$@" >"$job/start"
install -m 755 "$here/guest/init" "$scratch/init"
echo "$job" >"$scratch/job"

time=(time-travel=inf-cpu)
[ "${VM_CLOCK:-}" != host ] || time=()
console=null,fd:1
[ "$shell" = 0 ] || console=fd:0,fd:1

# Its memory is a file, which has to lie where programs may be run.
for folder in /dev/shm "$scratch"; do
	if install -m 755 /bin/true "$folder/inlay-vm-$$" 2>/dev/null && "$folder/inlay-vm-$$" 2>/dev/null; then
		rm "$folder/inlay-vm-$$"
		break
	fi
	rm -f "$folder/inlay-vm-$$"
done
TMPDIR=$folder boot "$kernel/linux" mem=1024M "${time[@]}" con=null "con0=$console" quiet panic=-1 \
	root=host rootfstype=hostfs rootflags=/ ro "init=$scratch/init" -- uml
