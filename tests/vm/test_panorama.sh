#!/bin/bash
# SPDX-License-Identifier: MIT
# A real mesh in a real panorama, through devices: photographs of it are played into the cameras.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh

if [ ! -r "$BUILD/tests/vm/spot/spot.inlay" ]; then
	echo "ok a real panorama # SKIP the panoramas are not there (INLAY_SHARED_DATA)"
	exit 0
fi
basis=$BUILD/tests/vm/spot/spot.inlay
width=320 height=240
view=(--set background.x=160 --set background.y=120 --set background.width=320
	--set background.height=240)

load vivid n_devs=2 num_inputs=1,1 input_types=3,3 num_outputs=1,1 output_types=1,1
load vkms
check "still puts spot into the panorama" expect "$BUILD/tests/vm/spot/fisheye.png" \
	"$BUILD/tests/vm/spot/background.png" "$VM_OUT/expected.png" "${view[@]}"
feed XR24 BGRX "$BUILD/tests/vm/spot/fisheye.png" "$BUILD/tests/vm/spot/background.png"
run panorama "${view[@]}" --set "screen.device=/dev/dri/card$(card_of vkms)" \
	--set camera.fisheye.format=BGRX --set camera.background.format=BGRX
shows "the screen shows what still makes" vkms "$VM_OUT/expected.png" within=0
stop_run
equal "the run ends well" 0 $?
stop_playing
unload vkms
unload vivid
