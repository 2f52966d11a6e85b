#!/bin/bash
# SPDX-License-Identifier: MIT
# The thesis's set-up by its sample configuration: one digitizer, four cameras in one picture of
# 720x486, the fisheye upside down. What is expected is made from the four pictures as they were
# before they were composed. vivid takes only the common sizes and fails in the kernel when it is told
# to crop what it loops, so the composed picture lies in a corner of one of 800x600; the views stay.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh

config=config/thesis.conf basis=$BUILD/tests/vm/thesis/thesis.inlay
width=360 height=243
load vivid n_devs=1 num_inputs=1 input_types=3 num_outputs=1 output_types=1
load vkms
vkms="screen.device=/dev/dri/card$(card_of vkms)"

"$tools/picture" chart fisheye $width $height "$VM_OUT/fisheye.png" 1.1111
"$tools/picture" chart background $width $height "$VM_OUT/background.png"
"$tools/picture" compose $width $height "$VM_OUT/scene.png" "$VM_OUT/background.png" 0 0 rotate180
"$tools/picture" compose 800 600 "$VM_OUT/composed.png" "$VM_OUT/scene.png" 0 0 upright \
	"$VM_OUT/fisheye.png" 360 0 vflip "$VM_OUT/background.png" 0 243 upright
hdmi_loop 0 XR24 800x600 >/dev/null
"$tools/picture" raw BGRX "$VM_OUT/composed.png" "$VM_OUT/composed.raw"
play 0 "$VM_OUT/composed.raw"

# still is given upright pictures of their own, so its views are the whole of them.
upright=()
for view in fisheye background scene; do
	for key in x y width height; do
		upright+=(--set "$view.$key=0")
	done
done
check "still makes the expected picture" expect "$VM_OUT/fisheye.png" "$VM_OUT/background.png" \
	"$VM_OUT/expected.png" "${upright[@]}" --set fisheye.vflip=no

# Shown pixel by pixel, nothing may be lost.
square=(--set screen.scale=none)
for view in fisheye background scene; do
	square+=(--set "$view.squash=1")
done
run_thesis() { # NAME SHOW option...
	local name=$1 show=$2
	shift 2
	"$INLAY" run --config $config --set basis.file="$basis" --set "$vkms" \
		--set screen.show="$show" --set camera.digitizer.format=BGRX \
		--set camera.digitizer.width=800 --set camera.digitizer.height=600 \
		--stats "$VM_OUT/$name.jsonl" "$@" >"$VM_OUT/$name.log" 2>&1 &
	running=$!
}
run_thesis composite composite "${square[@]}"
shows "the composite is what still makes of the separate pictures" vkms "$VM_OUT/expected.png" within=0
stop_run
equal "it ends well" 0 $?
run_thesis before before "${square[@]}"
shows "the background's quarter is upright" vkms "$VM_OUT/background.png" within=0
stop_run
run_thesis scene scene "${square[@]}"
shows "the scene's quarter is upright" vkms "$VM_OUT/scene.png" within=0
stop_run

# The four views fill the screen's quarters in the shape of 4:3: 512x384 each, without a border.
run_thesis quad quad
camera_shown() { # the first pictures may be from before the camera's first frame
	"$tools/scanout" picture "$(card_of vkms)" "$VM_OUT/quad.png" >/dev/null &&
		[ "$("$tools/picture" colour "$VM_OUT/quad.png" 518 390 1 1)" != "0 0 0 0 0 0" ]
}
check "four views are shown" eventually camera_shown
corner() { # DESCRIPTION X Y CONDITION over r g b
	local r g b
	read -r r g b _ < <("$tools/picture" colour "$VM_OUT/quad.png" "$2" "$3" 1 1)
	holds "$1" "$(sed "s/\<r\>/${r:--1}/g; s/\<g\>/${g:--1}/g; s/\<b\>/${b:--1}/g" <<<"$4")"
}
# The background chart is dark red and green up left, and bright yellow down right.
corner "before lies down left, its upper left corner dark" 6 390 "r < 30 && g < 30 && b > 60"
corner "and its lower right corner yellow" 505 760 "r > 130 && g > 130 && b < 30"
corner "the scene up left, turned about" 6 6 "r > 130 && g > 130 && b < 30"
corner "after lies down right" 518 390 "r < 30 && g < 30 && b > 60"
# The chart's lamp stands right of and above the middle, seen upright.
corner "the fisheye up right, its lamp above" 854 134 "r > 200 && g > 200 && b > 200"
stop_run
stop_playing
unload vkms
unload vivid
