#!/bin/bash
# SPDX-License-Identifier: MIT
# The GPIO buttons on gpio-sim: a press is an action, a bounce is not.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

# Two buttons to ground on lines 2 and 3 of 8.
level() { # line, pull-up or pull-down; nothing is started here, because a bounce is fast
	echo "$2" >"$panel/sim_gpio$1/pull"
}
press() { # line; held as long as a finger would
	level "$1" pull-down
	sleep 0.1
	level "$1" pull-up
	sleep 0.1
}
# listen option=value...: until ignore; what comes is in $VM_OUT/said. Of the driver gpio, or $driver
listen() {
	: >"$VM_OUT/said"
	"$tools/presses" "${driver:-gpio}" 400 "$@" >"$VM_OUT/said" 2>&1 &
	listening=$!
	eventually grep -q -E '^(ready|error)' "$VM_OUT/said"
}
ignore() {
	kill $listening 2>/dev/null
	wait $listening 2>/dev/null
	cat "$VM_OUT/said" >>"$VM_OUT/said-by-all"
}
count() { # action
	grep -c "^$1\$" "$VM_OUT/said"
}
heard() { # times, action
	[ "$(count "$2")" = "$1" ]
}
heard_least() { # times, action
	[ "$(count "$2")" -ge "$1" ]
}

load gpio-sim
make_panel 8
equal "a simulated chip with eight lines is made" 0 $?
level 2 pull-up
level 3 pull-up

listen chip=panel threshold_up=2 threshold_down=3 repeat_after_ms=0
matches "the chip is found by its label" '^ready' "$(cat "$VM_OUT/said")"
press 2
press 2
press 3
check "two presses of one line, one of the other" eventually heard 1 threshold-down
check "each is one action" heard 2 threshold-up
"$tools/presses" gpio 1 chip=panel threshold_up=2 >"$VM_OUT/second" 2>&1
matches "a line that another program holds is an error that names it" "line 2 of panel" \
	"$(cat "$VM_OUT/second")"
"$INLAY" devices >"$VM_OUT/devices" 2>&1
check "inlay devices lists the chip" grep -q "\[panel\], 8 lines" "$VM_OUT/devices"
check "and whose its lines are" grep -q "line 2: input, used by inlay" "$VM_OUT/devices"
ignore

"$tools/presses" gpio 1 chip=panel threshold_up=8 >"$VM_OUT/second" 2>&1
matches "a line that the chip has not is an error that names it" '^error .*8' "$(cat "$VM_OUT/second")"
"$tools/presses" gpio 1 chip=gpiochip77 threshold_up=1 >"$VM_OUT/second" 2>&1
matches "a chip that there is not is an error that names it" gpiochip77 "$(cat "$VM_OUT/second")"

# This button is said to bounce for long.
listen chip=panel threshold_up=2 threshold_down=3 debounce_ms=800 repeat_after_ms=0
level 3 pull-down
level 3 pull-up
sleep 1
for _ in 1 2 3 4 5 6; do
	level 2 pull-down
	level 2 pull-up
done
level 2 pull-down
sleep 1.5
level 2 pull-up
sleep 1.5
check "a bouncing press is one action" heard 1 threshold-up
check "a spike is none" heard 0 threshold-down
level 3 pull-down
check "another button after it" eventually heard 1 threshold-down
level 3 pull-up
ignore

# ---- held ----
listen chip=panel threshold_up=2 view_next=3 repeat_after_ms=400 repeat_every_ms=50
level 2 pull-down
level 3 pull-down
check "a step that is held goes on" eventually heard_least 4 threshold-up
level 2 pull-up
level 3 pull-up
sleep 1
held=$(count threshold-up)
press 3
check "and stops when it is let go" eventually heard 2 view-next
equal "at once" "$held" "$(count threshold-up)"
ignore
level 2 pull-down
listen chip=panel threshold_up=2 view_next=3 repeat_after_ms=100 repeat_every_ms=50
sleep 1
press 3
check "a line that is pressed at the start" eventually heard 1 view-next
check "is no press, however long" heard 0 threshold-up
level 2 pull-up
sleep 0.1
press 2
check "until it was let go" eventually heard_least 1 threshold-up
ignore
listen chip=panel threshold_up=2 view_next=3 repeat_after_ms=0
level 2 pull-down
sleep 1
level 2 pull-up
press 3
check "no repetition when none is wanted" eventually heard 1 view-next
check "but the press" heard 1 threshold-up

# ---- a program that did not look for a while: more edges than the kernel keeps ----
kill -STOP $listening
for _ in {1..40}; do
	level 3 pull-down
	sleep 0.03
	level 3 pull-up
	sleep 0.03
done
level 2 pull-down
kill -CONT $listening
check "an edge that was not kept is found" eventually heard 2 threshold-up
many=$(count view-next)
holds "as many presses as were kept ($many)" "2 <= $many && $many <= 41"
level 2 pull-up
sleep 0.1
press 3
check "and the next press counts" eventually heard $((many + 1)) view-next
ignore

listen chip=panel threshold_up=2 active_low=no bias=pull-down repeat_after_ms=0
level 2 pull-down
level 2 pull-up
sleep 0.1
level 2 pull-down
check "a button to the supply works as well" eventually heard 1 threshold-up
ignore

# ---- a rotary encoder between lines 2 and 3 ----
# A hand takes as long, and an edge's level is read when the kernel's thread runs.
quarter() { # line, pull
	level "$1" "$2"
	sleep 0.05
}
turn() { # first and second line: one step
	quarter "$1" pull-down
	quarter "$2" pull-down
	quarter "$1" pull-up
	quarter "$2" pull-up
}
level 2 pull-up
driver=encoder listen chip=panel a=2 b=3
turn 2 3
turn 2 3
turn 3 2
check "a step back is the pose before" eventually heard 1 pose-prev
check "two steps forwards are two poses" heard 2 pose-next
for _ in 1 2 3; do # its first contact bounces, and it falls back
	level 2 pull-down
	level 2 pull-up
done
turn 2 3
check "a bounce is no step" eventually heard 3 pose-next
check "to neither side" heard 1 pose-prev
ignore
driver=encoder listen chip=panel a=2
matches "a contact that is not named is asked for" '^error .*encoder.b' "$(cat "$VM_OUT/said")"
ignore

# ---- the chip goes and comes back ----
level 2 pull-up
listen chip=panel threshold_up=2
check "the chip can be taken away" remove_panel
check "which is said" eventually grep -q '^error .*chip is gone' "$VM_OUT/said"
"$tools/presses" gpio 1 chip=panel threshold_up=2 >"$VM_OUT/second" 2>&1
matches "while it is away it is missing by name" 'there is no chip "panel"' "$(cat "$VM_OUT/second")"
ignore
make_panel 8
equal "it comes back" 0 $?
level 2 pull-up
listen chip=panel threshold_up=2 repeat_after_ms=0
press 2
check "and is pressed" eventually heard 1 threshold-up
ignore
check "and is taken away for good" remove_panel
# The module stays: this kernel goes on counting the line that was held when its chip went.
