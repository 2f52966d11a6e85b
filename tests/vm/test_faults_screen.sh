#!/bin/bash
# SPDX-License-Identifier: MIT
# What goes wrong with the screen, in one run of the kiosk that is never restarted. A flip that
# never comes cannot be had from vkms: the simulated screen does that (tests/cli).
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/faults.sh

faults_load
no_screen() { [ "$(of_status screen)" = "no screen" ]; }
screen_fine() { [ "$(of_status screen)" = fine ]; }

# ---- off at the start ----
screen_unplugged_begin
kiosk screen
check "the kiosk starts without a screen" eventually no_screen
matches "and says so" "screen" "$(cat "$VM_OUT/screen.log")"
check "cameras are used meanwhile" eventually all_fine
screen_unplugged_end
check "a screen that is plugged in is used" eventually screen_fine
check "pictures go on" pictures_go_on

# ---- unplugged and back ----
screen_unplugged_begin
check "unplugged: it is named" eventually no_screen
check "unplugged: the rest goes on" eventually act threshold-set 30
screen_unplugged_end
check "unplugged: it is used again" eventually screen_fine
check "unplugged: pictures go on" pictures_go_on
equal "unplugged: nothing is lost" 30 "$(of_status threshold)"

# ---- another kiosk ----
"$INLAY" run --config $kiosk_conf --set control.socket= --set state.file= >"$VM_OUT/second.log" 2>&1
equal "two instances: the second ends" 1 $?
matches "two instances: and says who holds the screen" 'inlay: .*(another program|inlay)' \
	"$(tail -n 1 "$VM_OUT/second.log")"
"$INLAY" run --config $kiosk_conf --set screen.driver=null >"$VM_OUT/third.log" 2>&1
equal "two instances: one that only shares the control socket ends" 1 $?
matches "two instances: and says so" "/run/control" "$(tail -n 1 "$VM_OUT/third.log")"
check "two instances: the first goes on" pictures_go_on
check "two instances: and still listens" act threshold-set 40

check "the kiosk was never restarted" kill -0 $running
stop_run
equal "it ends well" 0 $?
faults_unload
