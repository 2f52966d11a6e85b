#!/bin/bash
# SPDX-License-Identifier: MIT
# The whole way that the README tells, from two cameras to a lit object: grab, calibrate, place, preview, bake,
# run, snapshot. The cameras are simulated and look at the studio (room.c); what comes out is held
# against a path-traced picture by the studio's own light, through the camera as it really is.
# WALK=folder keeps the pictures there (make walk). With it, or INLAY_THOROUGH, 86 lights and pictures with little noise
# in place of 26.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/../cli/tools/scene.sh"
: "${INLAY_CALIBRATE:?the program inlay-calibrate}"
tools=$(dirname "$INLAY")
repository=$PWD
compare() { # FILE FILE [OPTION...]: RMS of the difference, in levels
	"$tools/tests/accuracy/compare" "$@" | cut -d' ' -f2
}
below() { # NAME LIMIT VALUE
	check "$1 ($3, below $2)" awk "BEGIN { exit !($3 < $2) }"
}
above() { # NAME LIMIT VALUE
	check "$1 ($3, above $2)" awk "BEGIN { exit !($3 > $2) }"
}
key() { # FILE KEY: its numbers
	sed -n "s/^$2 = //p" "$1"
}
thorough=${WALK:-}${INLAY_THOROUGH:-}
frequency=2 preview_samples=4 truth_samples=6 shown_off=2.7 preview_off=2.7 elsewhere_off=4 # levels
[ -z "$thorough" ] || frequency=4 preview_samples=32 truth_samples=24 shown_off=1.3 preview_off=3
mkdir "$work/walk" && cd "$work/walk" || exit 1

# ---- the place, which nobody knows ----
cp "$repository/bake/demo/background.ini" camera-truth.ini
cat >eye-truth.ini <<'END'
[fisheye]
model = equisolid
focal = 152.4 151.1
centre = 243.6 236.8
rotation = 2 -3 24
END
mkdir room
lanterns=$("$tools/tests/walk/room" camera-truth.ini eye-truth.ini room) # a line each: x y z radius r g b
check "what the cameras see" test $? -eq 0
cat >kiosk.conf <<'END'
[basis]
file = toy.inlay
[camera fisheye]
driver = sim
width = 480
height = 480
rate = 10
sim.source = files
sim.file = room/fisheye.pfm
sim.clock = frames
sim.exposure = 0.16
sim.transfer = bt709
sim.black_level = 16
sim.read_noise = 0.3
sim.shot_noise = 1
[camera background]
driver = sim
width = 640
height = 480
rate = 10
sim.source = files
sim.file = room/background.pfm
sim.clock = frames
sim.exposure = 1.6
sim.read_noise = 0.3
sim.shot_noise = 1
[screen]
driver = null
[control]
socket = socket
END

# ---- photographs by the kiosk's own cameras ----
# A board is shown to each camera nine times, then nothing.
grab() {
	"$INLAY" grab --config kiosk.conf "$@" >grab.log 2>&1 || sed 's/^/# /' grab.log
}
for k in 1 2 3 4 5 6 7 8 9; do
	grab background -o board-$k.png --set camera.background.sim.file=room/background-$k.pfm
	grab fisheye -o eye-$k.png --set camera.fisheye.sim.file=room/fisheye-$k.pfm \
		--control exposure=0.8
done
grab background -o background.png
grab fisheye -o fisheye.png
grab fisheye --control exposure=0 -o covered.png
grab fisheye --control exposure=1.6,0.8,0.4,0.2,0.1 -o e-%d.png

# ---- calibration ----
calibrate() {
	"$INLAY_CALIBRATE" "$@"
}
check "the camera is found and trusted" calibrate camera --images 'board-*.png' --board 9x6:50mm \
	--object 0.2,-0.125,0.2,0.22 --report camera -o camera.ini
check "with a page" test -s camera/report.html
check "the fisheye is found and trusted" calibrate fisheye --images 'eye-*.png' --board 9x6:20mm \
	--world eye-1.png --report eye -o eye.ini
read -r x y z <<<"$(key eye.ini rotation)"
below "it is turned as it is, in degrees" 0.1 "$(awk "BEGIN { print sqrt(($x - 2) ^ 2 + ($y + 3) ^ 2 + ($z - 24) ^ 2) }")"
check "black level" calibrate light black covered.png -o eye-light.ini
check "response" calibrate light response --times 16,8,4,2,1 e-1.6.png e-0.8.png e-0.4.png e-0.2.png e-0.1.png \
	-o eye-light.ini
check "gain" calibrate light gain --lens eye.ini --patch 380,400,120,50 --reflectance 0.68,0.59,0.45 \
	fisheye.png background.png -o eye-light.ini
# The exposures are as 10 to 1; what walls send back is a constant in the studio.
below "is that of the exposures, its logarithm" 0.06 \
	"$(awk "BEGIN { r = log($(key eye-light.ini gain) / 10); print r < 0 ? -r : r }")"
cat >>kiosk.conf <<'END'
[fisheye]
lens = eye.ini
light = eye-light.ini
END

# ---- placing ----
# The board's first corner is the world's origin, and the toy stands on its middle. There stands the fisheye, too; the
# lanterns are measured from it.
cp kiosk.conf afar.conf
awk 'BEGIN { print "[fisheye]\nposition = 0.2 -0.125 0" }
	{ printf "[lamp %s]\nposition = %f %f %f\nradius = %f\n", NR == 1 ? "warm" : "cool", $1 + 0.2, $2 - 0.125, $3, $4 }' \
	<<<"$lanterns" >>kiosk.conf
cp "$repository/bake/demo/cow.glb" .
cat >toy.scene <<END
[camera]
file = camera.ini
[dome]
frequency = $frequency
[render]
samples = 2
bounces = 2
[ground]
material = rug
[material rug]
colour = 0.68 0.59 0.45
[object cow]
file = cow.glb
position = 0.2 -0.125 0
rotate = 0 0 -12
END
check "a preview" "$INLAY_BAKE" preview toy.scene --background background.png --config kiosk.conf \
	--fisheye fisheye.png --samples $preview_samples -o preview.png
sed 's/camera.ini/camera-truth.ini/; s/^position = .*/position = 0 0 0/' toy.scene >truth.scene
check "the same by the true camera" "$INLAY_BAKE" preview truth.scene --background background.png \
	--config kiosk.conf --samples 2 -o preview-truth.png
check "as coarse" "$INLAY_BAKE" preview toy.scene --background background.png --config kiosk.conf --samples 2 \
	-o preview-coarse.png
below "the object is where it is, in levels" 1.5 "$(compare preview-coarse.png preview-truth.png)"
sed 's/^position = .*/position = 0.005 0 0/' truth.scene >aside.scene
check "5 mm aside" "$INLAY_BAKE" preview aside.scene --background background.png --config kiosk.conf --samples 2 \
	-o aside.png
above "is seen" 5 "$(compare aside.png preview-truth.png)"

# ---- baking and running ----
check "the bake" "$INLAY_BAKE" render --no-preview toy.scene -o toy.inlay
equal "nothing is wrong with the configuration" "configuration is fine" "$("$INLAY" check --config kiosk.conf 2>&1)"
"$INLAY" run --config kiosk.conf --set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real \
	2>run.log &
inlay=$!
tell() {
	"$INLAY" control --socket socket "$@" >tell.log 2>&1
}
has_light() {
	tell status && grep -q '"lights_used":[1-9]' tell.log && grep -oE '"frames":[0-9]+' tell.log | head -n 1 | grep -q '[1-9]'
}
check "the kiosk runs and measures light" until_true has_light
check "it is held" tell freeze on
check "a picture of the screen" tell snapshot shown.png
for view in before guide quad; do
	tell view $view
	check "and of its view $view" tell snapshot $view.png
done
check "it ends" tell quit
wait $inlay
inlay=

# ---- truth ----
# The camera's exposure is 1.6.
mapfile -t lamps < <(awk '{ printf "--lamp\n%s,%s,%s,%s,%g,%g,%g\n", $1, $2, $3, $4, 1.6 * $5, 1.6 * $6, 1.6 * $7 }' \
	<<<"$lanterns")
check "the truth, by the studio's own light" "$INLAY_BAKE" truth truth.scene --panorama room/panorama.pfm \
	--exposure 1.6 "${lamps[@]}" --background before.png --samples $truth_samples --quiet -o truth.png
off() { # FILE: how far it is from the truth, in levels, without the noise of either
	compare "$1" truth.png --mean 8
}
# What is left is mostly the few lights: a lantern's shadow is as soft as a cell is wide.
below "what the kiosk shows is the truth, in levels" $shown_off "$(off shown.png)"
below "and a preview was near it" $preview_off "$(off preview.png)"
above "which is not the empty place" 15 "$(off before.png)"
still() { # OUT OPTIONS...: what it would show otherwise
	local out=$1
	shift
	check "$out" "$INLAY" still --config kiosk.conf --background before.png --fisheye fisheye.png -o "$out" "$@"
}
sed 's/^rotation = .*/rotation = 2 -3 114/' eye.ini >turned.ini
still turned.png --set fisheye.lens=turned.ini
above "nor light from elsewhere" $elsewhere_off "$(off turned.png)"
still afar.png --config afar.conf
above "nor lanterns that are taken as far away" "$(off shown.png)" "$(off afar.png)"
still untied.png --set fisheye.light=
above "nor light whose strength is not known" 10 "$(off untied.png)"

# ---- pictures to look at ----
if [ -n "${WALK:-}" ]; then
	case $WALK in /*) ;; *) WALK=$repository/$WALK ;; esac
	mkdir -p "$WALK"
	cp board-1.png eye-2.png preview.png guide.png shown.png truth.png "$WALK"
	check "the README's picture" ffmpeg -y -loglevel error -i board-1.png -i eye-2.png -i preview.png -i shown.png \
		-filter_complex '[0]scale=400:300[a];[1]crop=480:360:0:60,scale=400:300[b];[2]scale=400:300[c];[3]scale=400:300[d];[a][b][c][d]xstack=inputs=4:layout=0_0|w0_0|0_h0|w0_h0' \
		-frames:v 1 -q:v 4 "$WALK/walk.jpg"
fi
cd "$repository" || exit 1
finish
