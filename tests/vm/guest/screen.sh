# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by the tests of the KMS driver after devices.sh.
# shellcheck disable=SC2154 # tools is set there

said() {
	awk -v name="$1" '$1 == name { sub(/^[^ ]* /, ""); print; exit }' "$VM_OUT/said"
}

# show FRAMES name=value...: a picture stays on the screen until hide.
show() {
	local frames=$1
	shift
	: >"$VM_OUT/said"
	"$tools/show" kms "$VM_OUT/chart.png" "$frames" "$@" >"$VM_OUT/said" 2>&1 &
	showing=$!
	eventually grep -q -E '^(ready|error)' "$VM_OUT/said"
}

hide() {
	kill "$showing" 2>/dev/null
	wait "$showing"
}

# saw COUNT REGEX: so many lines of it, sooner or later.
saw_by_now() {
	[ "$(grep -c -E "$2" "$VM_OUT/said")" -ge "$1" ]
}
saw() {
	eventually saw_by_now "$@"
}
plug() { # card number; off, on or detect
	local status
	for status in "/sys/class/drm/card$1"-*/status; do
		echo "$2" >"$status"
	done
}
# A screen that is plugged in later, pulled out, and back.
comes_and_goes() { # card, where the chart lies
	local card=$1
	: >"$VM_OUT/said"
	"$tools/show" kms "$VM_OUT/chart.png" 3 patient "device=/dev/dri/card$card" \
		>"$VM_OUT/said" 2>&1 &
	showing=$!
	check "card$card: a screen that is absent at the start is waited for" \
		saw 1 '^waiting no screen: .*connected'
	plug "$card" detect
	check "card$card: and used when it is plugged in" saw 1 '^ready'
	for round in 1 2; do
		plug "$card" off
		check "card$card: pulled out, it is missed ($round)" \
			saw $round '^lost no screen: .*unplugged'
		plug "$card" detect
		check "card$card: and used again when it is back ($round)" saw $((round + 1)) '^ready'
	done
	check "card$card: its picture can be read back" \
		"$tools/scanout" picture "$card" "$VM_OUT/back.png"
	check "card$card: and is what was drawn" \
		"$tools/picture" compare "$VM_OUT/chart.png" "$VM_OUT/back.png" x=$2 y=$3
	# The kernel says so when something about a card changes; most of it changes nothing.
	for _ in 1 2 3; do
		echo change >"/sys/class/drm/card$card/uevent"
	done
	plug "$card" off
	echo change >"/sys/class/drm/card$card/uevent"
	check "card$card: a message of the kernel is heeded" saw 3 '^lost no screen'
	equal "card$card: and those before it have changed nothing" 3 "$(grep -c '^ready' "$VM_OUT/said")"
	plug "$card" detect
	saw 4 '^ready'
	hide
	equal "card$card: it closes well after all this" 0 $?
}
