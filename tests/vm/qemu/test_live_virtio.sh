#!/bin/bash
# SPDX-License-Identifier: MIT
# The whole program on a card of another driver: the picture, the console's picture given back, and another
# screen in place of the first.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/faults.sh

virtio="screen.device=/dev/dri/card$(card_of virtio)"
live_load
printf '\033[2J\033[Hthe console before\n' >/dev/tty1
echo 0 >/sys/class/graphics/fbcon/cursor_blink
settled() {
	screendump "$VM_OUT/before.ppm" && screendump "$VM_OUT/again.ppm" &&
		cmp "$VM_OUT/before.ppm" "$VM_OUT/again.ppm"
}
eventually settled
run virtio --set "$virtio" "${sets[@]}"
shows "virtio-gpu shows what still makes" virtio "$VM_OUT/expected.png" within=0
stop_run
given_back() {
	screendump "$VM_OUT/after.ppm" && cmp "$VM_OUT/before.ppm" "$VM_OUT/after.ppm"
}
check "after a run the console's picture is back" eventually given_back
stop_playing
unload vivid

# ---- another screen, of other modes, in place of the first ----
of_size() { # WIDTHxHEIGHT: that is what is scanned out
	screendump "$VM_OUT/size.ppm" && head -c 20 "$VM_OUT/size.ppm" | tr '\n' ' ' | grep -q "^P6 ${1/x/ } "
}
faults_load
screen_fine() { [ "$(of_status screen)" = fine ]; }
no_screen() { [ "$(of_status screen)" = "no screen" ]; }
kiosk modes --set "screen.device=/dev/dri/card$(card_of virtio)"
check "modes: the kiosk starts" eventually screen_fine
check "modes: in the preferred one" eventually of_size 1280x800
resize_window 1024 768
check "modes: another screen's preferred mode is set" eventually of_size 1024x768
check "modes: pictures go on" pictures_go_on
resize_window 0 0
check "modes: pulled out, it is named" eventually no_screen
resize_window 1280 800
check "modes: it is used again" eventually of_size 1280x800
check "modes: pictures go on after that" pictures_go_on
stop_run
equal "modes: it ends well" 0 $?
faults_unload
