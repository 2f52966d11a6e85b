#!/bin/bash
# SPDX-License-Identifier: MIT
# The whole program on devices, beyond test_live.sh: a second run, hours of rest, what cannot work, a script of
# buttons, Y'CbCr.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
# shellcheck disable=SC2154 # sets is set there

load vkms
vkms="screen.device=/dev/dri/card$(card_of vkms)"
live_load

# ---- a second run ----
run first --set "$vkms" "${sets[@]}"
eventually test -s "$VM_OUT/first.jsonl"
"$INLAY" run --config $config --set basis.file="$basis" --set "$vkms" \
	--set camera.fisheye.driver=sim --set camera.fisheye.sim.source=files \
	--set camera.fisheye.sim.file="$VM_OUT/fisheye.png" --set background.camera=fisheye >"$VM_OUT/second.log" 2>&1
equal "a second run while the first holds the screen fails" 1 $?
equal "with one line, but for the camera left out" 1 \
	"$(grep -vc 'camera background: no view names it' "$VM_OUT/second.log")"
matches "that says so" 'inlay: .*another program' "$(cat "$VM_OUT/second.log")"
stop_run

# ---- outside of its hours the screen is off by DPMS, and no camera streams ----
crtc_is() { # active=0 or active=1
	grep -q "^[[:space:]]*$1" "/sys/kernel/debug/dri/$(card_of vkms)/state"
}
later=$(date -d '+3 hours' +%H:%M)-$(date -d '+4 hours' +%H:%M)
run rest --set "$vkms" "${sets[@]}" --set "screen.hours=$later" --set control.socket=/run/inlay.socket
check "outside of its hours a kiosk answers" eventually "$INLAY" control --socket /run/inlay.socket status
check "vkms is switched off" eventually crtc_is active=0
cameras_held() {
	find "/proc/$running/fd" -lname '/dev/video*' | grep -q .
}
check "and no camera is open" test -z "$(find "/proc/$running/fd" -lname '/dev/video*')"
equal "it is woken" ok "$("$INLAY" control --socket /run/inlay.socket wake)"
check "and vkms is switched on" eventually crtc_is active=1
check "with the cameras" eventually cameras_held
shows "which shows what still makes" vkms "$VM_OUT/expected.png" within=0
stop_run
equal "and ends well" 0 $?

# ---- what cannot work ends at once with one line and exit code 1 ----
# refused DESCRIPTION REGEX option...
refused() {
	local description=$1 regex=$2
	shift 2
	run refused "${sets[@]}" "$@"
	eventually ended
	stop_run
	equal "$description is refused" 1 $?
	equal "$description: one line, besides what cameras send" 1 \
		"$(grep -c -v '" sends ' "$VM_OUT/refused.log")"
	matches "$description: that says so" "^inlay: .*$regex" "$(tail -n 1 "$VM_OUT/refused.log")"
}
refused "a screen that is none" /dev/null --set screen.device=/dev/null
refused "a camera that is none" /dev/null --set "$vkms" --set camera.fisheye.device=/dev/null

# ---- a script of buttons ----
printf '0.1 threshold-set 100\n' >"$VM_OUT/script"
expect "$VM_OUT/fisheye.png" "$VM_OUT/background.png" "$VM_OUT/expected-100.png" --threshold 100
run script --set "$vkms" "${sets[@]}" --set buttons.driver=script \
	--set buttons.script.file="$VM_OUT/script"
shows "a scripted button sets the threshold" vkms "$VM_OUT/expected-100.png" within=0
stop_run
holds "fewer lights are used then" "$(stat script lights_used) < $(stat first lights_used)"

# ---- Y'CbCr in: chroma by pairs, one rounding (charts lose nothing else) ----
stop_playing
feed YUYV YUYV "$VM_OUT/fisheye.png" "$VM_OUT/background.png"
run yuyv --set "$vkms" --set camera.fisheye.format=YUYV --set camera.background.format=YUYV \
	--set camera.fisheye.matrix=bt601 --set camera.fisheye.range=limited \
	--set camera.background.matrix=bt601 --set camera.background.range=limited
shows "the same from YUYV" vkms "$VM_OUT/expected.png" within=4
stop_run
stop_playing

unload vkms
unload vivid
