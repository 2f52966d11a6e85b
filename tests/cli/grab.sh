#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay grab: still pictures of the kiosk's cameras.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

grab() {
	"$INLAY" grab --config "$work/studio.conf" "$@"
}

# Its fourth frame, as that of a camera whose frames come on demand.
"$INLAY" run --config "$work/studio.conf" --frames 4 --set screen.show=before \
	--set "screen.device=$work/run.png" 2>"$work/run.log" || sed 's/^/# /' "$work/run.log"
check "a picture of the background" grab background -o "$work/background.png"
same "it is what run shows before the object" "$work/run.png" "$work/background.png"
check "the fisheye's" grab fisheye -o "$work/fisheye.png"
check "turned by the view" grab fisheye -o "$work/turned.png" --set fisheye.hflip=yes --set fisheye.vflip=yes
differ "is another" "$work/fisheye.png" "$work/turned.png"
check "as sent it is not turned" grab fisheye --as-sent -o "$work/sent.png" --set fisheye.hflip=yes \
	--set fisheye.vflip=yes
same "and the same" "$work/fisheye.png" "$work/sent.png"
check "a part of the picture" grab background -o "$work/part.png" --set background.width=40 \
	--set background.height=30
differ "is not the whole" "$work/background.png" "$work/part.png"

equal "a camera that hangs on its side is turned upright" "$work/side.png: 32x48" \
	"$(grab background -o "$work/side.png" --set camera.background.rotate=90)"
refused "linear light is not turned" 1 "rotate: pictures of linear light" "$INLAY" check \
	--config "$work/studio.conf" --set camera.background.rotate=90 --set camera.background.format=RGBF
refused "no view" 2 "expected one view or camera: fisheye, background, scene" grab -o "$work/x.png"
refused "no file" 2 "no file, expected -o FILE.png" grab fisheye
refused "a name that is none" 1 'no camera "sky", expected fisheye, background, scene' grab sky -o "$work/x.png"
refused "another kind of file" 2 "expected a name that ends in .png" grab fisheye -o "$work/x.tiff"
refused "a control without a value" 2 "expected NAME=VALUE" grab fisheye -o "$work/x.png" --control gain
refused "several pictures in one file" 2 "expected a name with %d in it" \
	grab fisheye -o "$work/x.png" --control gain=1,2
refused "two series" 2 "two controls with several values" \
	grab fisheye -o "$work/x-%d.png" --control gain=1,2 --control focus=1,2
refused "a control that a simulated camera lacks" 1 "camera fisheye: " \
	grab fisheye -o "$work/x.png" --control gain=1
check "nothing is left of a failure" test ! -e "$work/x.png"

finish
