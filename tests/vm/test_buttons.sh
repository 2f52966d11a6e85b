#!/bin/bash
# The GPIO buttons on gpio-sim: a press is an action, a bounce is not.
. tests/vm/tap.sh
. tests/vm/devices.sh

# A chip of its own: two buttons to ground on lines 2 and 3 of 8.
bank=/sys/kernel/config/gpio-sim/inlay/bank
make_chip() {
	mkdir -p $bank && echo 8 >$bank/num_lines && echo panel >$bank/label &&
		echo 1 >/sys/kernel/config/gpio-sim/inlay/live
}
remove_chip() {
	echo 0 >/sys/kernel/config/gpio-sim/inlay/live
	rmdir $bank /sys/kernel/config/gpio-sim/inlay
}
level() { # line, pull-up or pull-down; nothing is started here, because a bounce is fast
	echo "$2" >"$panel/sim_gpio$1/pull"
}
press() { # line; held as long as a finger would
	level "$1" pull-down
	sleep 0.1
	level "$1" pull-up
	sleep 0.1
}
# listen option=value...: until ignore; what comes is in $VM_OUT/said
listen() {
	: >"$VM_OUT/said"
	"$tools/presses" gpio 60 "$@" >"$VM_OUT/said" 2>&1 &
	listening=$!
	within_seconds 10 grep -q -E '^(ready|error)' "$VM_OUT/said"
}
ignore() {
	kill $listening 2>/dev/null
	wait $listening 2>/dev/null
	cat "$VM_OUT/said" >>"$VM_OUT/said-by-all"
}
heard() { # times, action
	[ "$(grep -c "^$2\$" "$VM_OUT/said")" = "$1" ]
}

load gpio-sim
check "a simulated chip with eight lines is made" make_chip
panel=/sys/devices/platform/$(cat "${bank%/bank}/dev_name")/$(cat $bank/chip_name)
level 2 pull-up
level 3 pull-up

listen chip=panel threshold_up=2 threshold_down=3
matches "the chip is found by its label" '^ready' "$(cat "$VM_OUT/said")"
press 2
press 2
press 3
check "two presses of one line, one of the other" within_seconds 5 heard 1 threshold-down
check "each is one action" heard 2 threshold-up
"$tools/presses" gpio 1 chip=panel threshold_up=2 >"$VM_OUT/second" 2>&1
matches "a line that another program holds is an error that names it" "line 2 of panel" \
	"$(cat "$VM_OUT/second")"
ignore

"$tools/presses" gpio 1 chip=panel threshold_up=8 >"$VM_OUT/second" 2>&1
matches "a line that the chip has not is an error that names it" '^error .*8' "$(cat "$VM_OUT/second")"
"$tools/presses" gpio 1 chip=gpiochip77 threshold_up=1 >"$VM_OUT/second" 2>&1
matches "a chip that there is not is an error that names it" gpiochip77 "$(cat "$VM_OUT/second")"

# Under emulation even a bounce takes its time, so the button is said to bounce for long.
listen chip=panel threshold_up=2 threshold_down=3 debounce_ms=800
sleep 1
for _ in 1 2 3 4 5 6; do
	level 2 pull-down
	level 2 pull-up
done
level 2 pull-down
sleep 1.5
level 2 pull-up
sleep 1.5
press 3
check "another button after it" within_seconds 5 heard 1 threshold-down
check "a bouncing press is one action" heard 1 threshold-up
ignore

listen chip=panel threshold_up=2 active_low=no bias=pull-down
level 2 pull-down
level 2 pull-up
sleep 0.1
level 2 pull-down
check "a button to the supply works as well" within_seconds 5 heard 1 threshold-up
ignore
check "the chip can be taken away" remove_chip
unload gpio-sim
