#!/bin/bash
# SPDX-License-Identifier: MIT
# Keyboards, made by uinput: plugged in late, held, grabbed, unplugged, chosen by name and path.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

# plug NAME [touch]: a keyboard that types what type_at tells it, or a touch screen. unplug NAME takes it away.
declare -A typing feeder
plug() {
	mkfifo "/run/$1.keys"
	"$tools/keys" "inlay $1" "${@:2}" <"/run/$1.keys" >"$VM_OUT/$1.node" 2>&1 &
	feeder[$1]=$!
	local fd
	exec {fd}>"/run/$1.keys"
	typing[$1]=$fd
}
plugged() {
	eventually grep -q ^ready "$VM_OUT/$1.node"
}
unplug() {
	type_at "$1" unplug
	wait "${feeder[$1]}"
	rm "/run/$1.keys"
}
type_at() { # keyboard, command...
	local keyboard=$1
	shift
	echo "$*" >&"${typing[$keyboard]}"
}
node_of() {
	sed 's/^ready //' "$VM_OUT/$1.node"
}
# listen NAME option=value...: what comes is in $VM_OUT/said-NAME
declare -A listener
listen() {
	local name=$1
	shift
	: >"$VM_OUT/said-$name"
	"$tools/presses" keyboard 400 "$@" >"$VM_OUT/said-$name" 2>&1 &
	listener[$name]=$!
	eventually grep -q -E '^(ready|error)' "$VM_OUT/said-$name"
}
ignore() {
	kill "${listener[$1]}" 2>/dev/null
	wait "${listener[$1]}" 2>/dev/null
	cat "$VM_OUT/said-$1" >>"$VM_OUT/said-by-all"
}
count() { # listener, action
	grep -c "^$2\$" "$VM_OUT/said-$1"
}
heard() { # listener, times, action
	[ "$(count "$1" "$3")" = "$2" ]
}
heard_least() {
	[ "$(count "$1" "$3")" -ge "$2" ]
}

# ---- plugged in late ----
mkdir -p /dev/input # a machine without any device has none; others have a power button at least
listen all
matches "no keyboard of ours is needed at the start" '^ready' "$(cat "$VM_OUT/said-all")"
plug one
check "a keyboard is plugged in" plugged one
type_at one press v
check "and its keys are heard" eventually heard all 1 view-next
plug two
check "a second one" plugged two
type_at two press f
check "is heard, too" eventually heard all 1 freeze
type_at two press a
type_at two press equal
type_at one press minus
check "plus and minus step" eventually heard all 1 threshold-down
check "one step each" eventually heard all 1 threshold-up

# ---- held ----
type_at one down p
type_at one down right # the kernel repeats the last one
check "a key that is held for a step goes on" eventually heard_least all 4 split-right
type_at one up right
type_at one up p
type_at one press o
check "until it is let go" eventually heard all 1 object
steps=$(count all split-right)
type_at one down i
sleep 1
type_at one up i
type_at one press o
check "nothing more comes of it" eventually heard all 2 object
equal "of the step" "$steps" "$(count all split-right)"
check "one that toggles does not repeat" heard all 1 information
check "nor does the pose" heard all 1 pose-next

# ---- grabbed ----
listen other grab=no device="inlay one"
type_at one press t
check "a press comes to whoever has grabbed the keyboard" eventually heard all 1 threshold-next
check "and to nobody else" heard other 0 threshold-next
ignore all
type_at one press t
check "who has it when it was let go" eventually heard other 1 threshold-next
type_at two press t
type_at one press v
check "a keyboard is chosen by name" eventually heard other 1 view-next
check "and no other is heard" heard other 1 threshold-next

# ---- unplugged ----
listen path device="$(node_of two)" view_next=5 object= threshold_down="left btn_trigger" split_left=
type_at two press 5
check "or by its path, with keys of one's own" eventually heard path 1 view-next
type_at two press left
check "and several for one" eventually heard path 1 threshold-down
type_at two press o
unplug two
check "gone, it is an error that names it" eventually grep -q "^error .*$(node_of two).* not connected" \
	"$VM_OUT/said-path"
check "an empty mapping is no key" heard path 0 object
type_at one press v
check "the other keyboard stays" eventually heard other 2 view-next
ignore other
ignore path

listen all
unplug one
check "a keyboard goes while all are heard" test ! -e "$(node_of one)"
plug one
check "and comes back" plugged one
type_at one press v
check "and is heard again" eventually heard all 1 view-next

# ---- more than the kernel keeps ----
kill -STOP "${listener[all]}"
type_at one flood 2000 o
type_at one down v
kill -CONT "${listener[all]}"
check "a key that went down among dropped events is found" eventually heard all 2 view-next
type_at one up v
type_at one press f
check "and the keyboard goes on" eventually heard all 1 freeze
holds "after some of the flood ($(count all object))" "$(count all object) < 2000"

# ---- a key that is down at the start ----
ignore all
type_at one down up
sleep 0.5
listen all
sleep 1
type_at one press o
check "a key that was down at the start" eventually heard all 1 object
check "is no press, however long" heard all 0 threshold-up
type_at one up up
type_at one press up
check "until it was let go" eventually heard all 1 threshold-up
listen other grab=no device="inlay one"
type_at one press v
check "by then it is grabbed" eventually heard all 1 view-next
check "so that nobody else hears it" heard other 0 view-next
ignore all
ignore other

# ---- a touch screen without a key ----
listen touched threshold_next=btn_touch
plug screen touch
check "a touch screen is plugged in that tells of fingers alone" plugged screen
type_at screen tap
type_at screen tap
check "and each tap is heard" eventually heard touched 2 threshold-next
unplug screen
ignore touched

# ---- a dial, as the kernel makes of a rotary encoder ----
listen dialled pose_next=dial_right pose_prev=dial_left
plug dial dial
check "a dial is plugged in" plugged dial
type_at dial turn 1
type_at dial turn 1
type_at dial turn -1
check "a step back is the pose before" eventually heard dialled 1 pose-prev
check "two steps forwards are two poses" heard dialled 2 pose-next
unplug dial
ignore dialled

# ---- refusals ----
said() { # option=value...
	"$tools/presses" keyboard 1 "$@" 2>&1
}
matches "a device that is not there is an error that names it" 'error .*"Acme" is not connected' \
	"$(said device=Acme)"
matches "a misspelt key is one with the nearest" 'unknown key "spcae", did you mean "space"' \
	"$(said freeze=spcae)"
matches "a key for two actions is one" '"v" is taken by view-next' "$(said pose_next=v)"
"$INLAY" devices >"$VM_OUT/devices" 2>&1
check "inlay devices lists it" grep -q "$(node_of one) \[inlay one\]" "$VM_OUT/devices"
unplug one
