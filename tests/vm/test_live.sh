#!/bin/bash
# SPDX-License-Identifier: MIT
# The whole program on devices: pictures of ours are played into two cameras (vivid's HDMI inputs),
# `inlay run` puts the object in, and what the screen really shows is compared, pixel by pixel, with
# `inlay still` on the same pictures, before and after a button on a GPIO line is pressed.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
# shellcheck disable=SC2154 # sets is set there

load vkms
vkms="screen.device=/dev/dri/card$(card_of vkms)"
live_load
expect "$VM_OUT/fisheye.png" "$VM_OUT/background.png" "$VM_OUT/expected-100.png" --threshold 100
load gpio-sim
make_panel 4
echo pull-up >"$panel/sim_gpio2/pull"
run vkms --set "$vkms" "${sets[@]}" --set lights.threshold_step=100 --set buttons.driver=gpio \
	--set buttons.gpio.chip=panel --set buttons.gpio.threshold_up=2 --set buttons.gpio.repeat_after_ms=0
shows "vkms shows what still makes" vkms "$VM_OUT/expected.png" within=0
check "vkms puts out exactly that (checksum)" "$tools/scanout" checksum "$(card_of vkms)"
echo pull-down >"$panel/sim_gpio2/pull"
shows "a press on a GPIO line steps the threshold" vkms "$VM_OUT/expected-100.png" within=0
echo pull-up >"$panel/sim_gpio2/pull"
stop_run
equal "SIGTERM ends a run well" 0 $?
equal "the statistics say so" 100 "$(stat vkms threshold)"
equal "and count all lights" 86 "$(stat vkms lights)"
remove_panel
unload gpio-sim
stop_playing

unload vkms
unload vivid
