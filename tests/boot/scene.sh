# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced: a kiosk.conf for cameras that always see the same, put where a person would put it, and
# what `inlay still` makes of the same pictures.

# still_scene_pictures FOLDER: what each camera of the demo sees first.
still_scene_pictures() {
	local folder=$1 camera
	for camera in fisheye background; do
		"$INLAY" run --config board/image/demo.conf --set state.file= --set control.socket= \
			--set basis.file=build/image/demo/cow.inlay \
			--set camera.fisheye.sim.file=build/image/demo/fisheye.y4m \
			--set camera.background.sim.file=build/image/demo/background.y4m \
			--set background.camera=$camera --set screen.show=before \
			--set screen.driver=file --set "screen.device=$folder/$camera.png" --frames 1 || return
	done
}

# still_scene IMAGE FOLDER: changes the partition INLAY of an image.
still_scene() {
	local image=$1 folder=$2
	still_scene_pictures "$folder" || return
	sed -e "s|^sim.file = .*/\(.*\).y4m|sim.file = \1.png|" -e 's/^scale = fit/scale = none/' \
		-e '/^\[state\]/a interval = 0' -e '/^rate =/d' board/image/demo.conf >"$folder/kiosk.conf"
	mcopy -o -i "$image@@1M" "$folder"/{kiosk.conf,fisheye.png,background.png} ::/
}

# expected FOLDER THRESHOLD: prints the picture's path.
expected() {
	local picture=$1/expected-$2.png
	[ -e "$picture" ] || "$INLAY" still --config board/image/demo.conf \
		--basis build/image/demo/cow.inlay --fisheye "$1/fisheye.png" \
		--background "$1/background.png" --threshold "$2" -o "$picture" >&2
	echo "$picture"
}

# shown FOLDER THRESHOLD: the machine's screen shows it now, in its middle (1280x800, 400x300).
shown() {
	screendump "$1/screen.ppm" &&
		"$BUILD/tests/vm/tools/picture" compare "$(expected "$1" "$2")" "$1/screen.ppm" x=440 y=250 \
			within=0 >"$1/compared" 2>&1
}
