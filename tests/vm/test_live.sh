#!/bin/bash
# SPDX-License-Identifier: MIT
# The whole program on devices: pictures of ours are played into two cameras (vivid's HDMI inputs),
# `inlay run` puts the object in, and what the screen really shows is compared, pixel by pixel, with
# `inlay still` on the same pictures.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh

load vivid n_devs=2 num_inputs=1,1 input_types=3,3 num_outputs=1,1 output_types=1,1
load vkms
vkms="screen.device=/dev/dri/card$(card_of vkms)"
virtio="screen.device=/dev/dri/card$(card_of virtio)"
"$tools/picture" chart fisheye 640 480 "$VM_OUT/fisheye.png"
"$tools/picture" chart background 640 480 "$VM_OUT/background.png"
check "still makes the expected picture" \
	expect "$VM_OUT/fisheye.png" "$VM_OUT/background.png" "$VM_OUT/expected.png"

# ---- R'G'B' in: nothing may be lost ----
feed XR24 BGRX "$VM_OUT/fisheye.png" "$VM_OUT/background.png"
sets=(--set camera.fisheye.format=BGRX --set camera.background.format=BGRX)
run vkms --set "$vkms" "${sets[@]}"
shows "vkms shows what still makes" vkms "$VM_OUT/expected.png" within=0
check "vkms puts out exactly that (checksum)" "$tools/scanout" checksum "$(card_of vkms)"
within_seconds 5 test -s "$VM_OUT/vkms.jsonl"
"$INLAY" run --config $config --set basis.file="$basis" --set "$vkms" \
	--set camera.fisheye.driver=sim --set camera.fisheye.sim.source=files \
	--set camera.fisheye.sim.file="$VM_OUT/fisheye.png" --set background.camera=fisheye >"$VM_OUT/second.log" 2>&1
equal "a second run while the first holds the screen fails" 1 $?
equal "with one line, but for the camera left out" 1 \
	"$(grep -vc 'camera background: no view names it' "$VM_OUT/second.log")"
matches "that says so" 'inlay: .*another program' "$(cat "$VM_OUT/second.log")"
stop_run
equal "SIGTERM ends a run well" 0 $?
holds "statistics count frames" "$(stat vkms frames) > 0"
equal "and all lights" 86 "$(stat vkms lights)"

# ---- outside of its hours the screen is off by DPMS, and no camera streams ----
crtc_is() { # active=0 or active=1
	grep -q "^[[:space:]]*$1" "/sys/kernel/debug/dri/$(card_of vkms)/state"
}
later=$(date -d '+3 hours' +%H:%M)-$(date -d '+4 hours' +%H:%M)
run rest --set "$vkms" "${sets[@]}" --set "screen.hours=$later" --set control.socket=/run/inlay.socket
check "outside of its hours vkms is switched off" within_seconds 20 crtc_is active=0
cameras_held() {
	find "/proc/$running/fd" -lname '/dev/video*' | grep -q .
}
check "and no camera is open" test -z "$(find "/proc/$running/fd" -lname '/dev/video*')"
equal "it is woken" ok "$("$INLAY" control --socket /run/inlay.socket wake)"
check "and vkms is switched on" within_seconds 20 crtc_is active=1
check "with the cameras" within_seconds 20 cameras_held
shows "which shows what still makes" vkms "$VM_OUT/expected.png" within=0
stop_run
equal "and ends well" 0 $?

printf '\033[2J\033[Hthe console before\n' >/dev/tty1
echo 0 >/sys/class/graphics/fbcon/cursor_blink
settled() {
	screendump "$VM_OUT/before.ppm" && screendump "$VM_OUT/again.ppm" &&
		cmp "$VM_OUT/before.ppm" "$VM_OUT/again.ppm"
}
within_seconds 5 settled
run virtio --set "$virtio" "${sets[@]}"
shows "virtio-gpu shows what still makes" virtio "$VM_OUT/expected.png" within=0
stop_run
given_back() {
	screendump "$VM_OUT/after.ppm" && cmp "$VM_OUT/before.ppm" "$VM_OUT/after.ppm"
}
check "after a run the console's picture is back" within_seconds 5 given_back

# ---- what cannot work ends at once with one line and exit code 1 ----
# refused DESCRIPTION REGEX option...
refused() {
	local description=$1 regex=$2
	shift 2
	run refused "${sets[@]}" "$@"
	within_seconds 15 ended
	stop_run
	equal "$description is refused" 1 $?
	equal "$description: one line, besides what cameras send" 1 \
		"$(grep -c -v '" sends ' "$VM_OUT/refused.log")"
	matches "$description: that says so" "^inlay: .*$regex" "$(tail -n 1 "$VM_OUT/refused.log")"
}
refused "a screen that is none" /dev/null --set screen.device=/dev/null
refused "a camera that is none" /dev/null --set "$vkms" --set camera.fisheye.device=/dev/null

# ---- buttons, scripted and on GPIO, step the threshold ----
printf '0.1 threshold-set 100\n' >"$VM_OUT/script"
expect "$VM_OUT/fisheye.png" "$VM_OUT/background.png" "$VM_OUT/expected-100.png" --threshold 100
run script --set "$vkms" "${sets[@]}" --set buttons.driver=script \
	--set buttons.script.file="$VM_OUT/script"
shows "a scripted button sets the threshold" vkms "$VM_OUT/expected-100.png" within=0
stop_run
holds "fewer lights are used then" "$(stat script lights_used) < $(stat vkms lights_used)"

load gpio-sim
bank=/sys/kernel/config/gpio-sim/inlay/bank
mkdir -p $bank && echo 4 >$bank/num_lines && echo panel >$bank/label &&
	echo 1 >/sys/kernel/config/gpio-sim/inlay/live
line=/sys/devices/platform/$(cat ${bank%/bank}/dev_name)/$(cat $bank/chip_name)/sim_gpio2/pull
echo pull-up >"$line"
run gpio --set "$vkms" "${sets[@]}" --set lights.threshold_step=100 --set buttons.driver=gpio \
	--set buttons.gpio.chip=panel --set buttons.gpio.threshold_up=2 \
	--set buttons.gpio.repeat_after_ms=0
shows "before the press all lights are used" vkms "$VM_OUT/expected.png" within=0
echo pull-down >"$line"
shows "a press on a GPIO line steps the threshold" vkms "$VM_OUT/expected-100.png" within=0
echo pull-up >"$line"
stop_run
equal "the statistics say so" 100 "$(stat gpio threshold)"
echo 0 >/sys/kernel/config/gpio-sim/inlay/live
rmdir $bank ${bank%/bank}
unload gpio-sim

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
