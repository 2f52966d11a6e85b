#!/bin/bash
# SPDX-License-Identifier: MIT
# `inlay devices --sample` for what is plugged in, and a run with the configuration that it wrote.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
# shellcheck disable=SC2154 # basis, width and height are set there

load vivid n_devs=2 input_types=0xe4,0xe4
load vkms
load gpio-sim
make_panel 4

sample=$VM_OUT/kiosk.conf
"$INLAY" devices --sample >"$sample" 2>"$VM_OUT/errors"
equal "a sample is written" 0 $?
equal "without complaint" "" "$(cat "$VM_OUT/errors")"
setpriv --reuid=65534 --regid=65534 --clear-groups "$INLAY" devices --sample \
	>"$VM_OUT/nobody.conf" 2>"$VM_OUT/errors"
matches "who may open nothing is told so" "some devices are not for this user" \
	"$(cat "$VM_OUT/errors")"
has() {
	grep -q -x -F -e "$1" "$sample"
}
check "the first camera goes by its bus, not by a number that moves" has "device = platform:vivid-000"
check "so does the second" has "device = platform:vivid-001"
check "the views are of both" test "$(grep -c -x 'camera = camera[12]' "$sample")" = 2
check "the connector is named" has "kms.connector = Virtual-1"
check "with the size that it prefers" has ";     width = 1024"
check "the chip goes by its label" has "gpio.chip = panel"
matches "every key is valid" "configuration is fine" \
	"$("$INLAY" check --config "$sample" --set basis.file="$basis" 2>&1)"

config=$sample
"$INLAY" run --config "$sample" --set basis.file="$basis" --set background.width=$width \
	--set background.height=$height --stats "$VM_OUT/sample.jsonl" >"$VM_OUT/sample.log" 2>&1 &
running=$!
check "a run with it sees both cameras" eventually situation sample camera2 fine
pictures() {
	[ "$(stat sample frames)" -gt 5 ]
}
check "and shows pictures" eventually pictures
stop_run
equal "and ends well" 0 $?

remove_panel
unload gpio-sim
unload vkms
unload vivid
