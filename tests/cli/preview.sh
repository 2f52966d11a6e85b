#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay-bake preview: the object in a photograph, and again whenever a file changes.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
cd "$work" || exit 1

preview() {
	"$INLAY_BAKE" preview "$@"
}
lines() { # COUNT LINE
	for ((k = 0; k < $1; k++)); do echo "$2"; done
}
# apart FILE.pfm FILE.pfm: RMS of the difference, in thousandths of white.
apart() {
	python3 - "$@" <<'END'
import array, sys
def read(path):
    head, size, scale, data = open(path, "rb").read().split(b"\n", 3)
    pixels = array.array("f", data)
    if float(scale) > 0:
        pixels.byteswap()
    return pixels
a, b = read(sys.argv[1]), read(sys.argv[2])
print(round(1000 * (sum((x - y) ** 2 for x, y in zip(a, b)) / len(a)) ** 0.5))
END
}
# near NAME LIMIT FILE.pfm FILE.pfm
near() {
	check "$1 ($(apart "$3" "$4") thousandths of white RMS)" test "$(apart "$3" "$4")" -le "$2"
}

# ---- one picture ----
check "a photograph" "$INLAY" grab background --config studio.conf -o b.png
# How many samples it takes, unless they are given, is measured: some seconds of them.
few=(--samples 4)
[ -z "${INLAY_THOROUGH:-}" ] || few=()
check "a preview" preview box.scene --background b.png "${few[@]}" -o p.png
differ "has the object in it" p.png b.png
check "nothing is left beside it" test "$(find . -name '*p.png*')" = ./p.png
# One light of 26 is strong. The whole picture against the kiosk's own, of a bake with other rays.
{ lines 9 "0.2 0.3 0.4"; echo "8 7 6"; lines 16 "0.2 0.3 0.4"; } >lamp.txt
check "what the kiosk shows under a lamp" "$INLAY" still --config studio.conf --basis box.inlay \
	--background b.png --lights lamp.txt -o kiosk.pfm
preview box.scene --background b.png --lights lamp.txt --samples 64 -o lamp.pfm --quiet
near "a preview under a lamp is what the kiosk shows" 25 kiosk.pfm lamp.pfm
preview box.scene --background b.png --samples 64 -o white.pfm --quiet
check "an even sky is another light ($(apart kiosk.pfm white.pfm))" test "$(apart kiosk.pfm white.pfm)" -gt 50
lines 6 "1 1 1" >six.txt
preview box.scene --background b.png --samples 64 --lights six.txt --frequency 1 -o six.pfm --quiet
near "lights of another dome that are all white are an even sky" 3 white.pfm six.pfm
sed 's/^gain = 5/gain = 5\ntransfer = bt709/; s/^\[composite\]/[background]\ntransfer = linear\n&\ngain = 0.5/' \
	studio.conf >dim.conf
check "the kiosk shows it by its configuration" "$INLAY" still --config dim.conf --basis box.inlay \
	--background b.png --lights lamp.txt -o kiosk.pfm
preview box.scene --background b.png --config dim.conf --lights lamp.txt --samples 64 -o lamp.pfm --quiet
near "and so does a preview" 25 kiosk.pfm lamp.pfm
"$INLAY" grab fisheye --config dim.conf -o f.png 2>/dev/null
check "the light of a fisheye" "$INLAY" still --config dim.conf --basis box.inlay --background b.png --fisheye f.png \
	-o kiosk.pfm
preview box.scene --background b.png --config dim.conf --fisheye f.png --samples 64 -o lamp.pfm --quiet
near "is measured alike" 25 kiosk.pfm lamp.pfm
preview box.scene --background b.png --config dim.conf --samples 2 --threads 1 -o one.png --quiet
preview box.scene --background b.png --config dim.conf --samples 2 --threads 3 -o three.png --quiet
same "threads do not change it" one.png three.png

# A lens that bends lines: the object is where the bake puts it, which has another code for its rays.
cat >lens.ini <<'END'
[camera]
width = 48
height = 32
rotation = 1 0 0  0 -0.3939193 -0.9191450  0 0.9191450 -0.3939193
translation = 0 0.1969597 3.347
focal = 2
kappa1 = -0.5
centre = 24 16
pixel = 0.02 0.02
aspect = 1
END
sed '/^position/,/^height/d; s/^\[camera\]/&\nfile = lens.ini/' box.scene >lens.scene
check "a bake through a lens" "$INLAY_BAKE" render --no-preview lens.scene -o lens.inlay --quiet --samples 16
"$INLAY" still --config studio.conf --basis lens.inlay --background b.png --lights lamp.txt -o kiosk.pfm
preview lens.scene --background b.png --lights lamp.txt --samples 64 -o lamp.pfm --quiet
near "a preview through that lens is what the kiosk shows" 25 kiosk.pfm lamp.pfm
sed -i '/^kappa1/d' lens.ini
preview lens.scene --background b.png --lights lamp.txt --samples 64 -o plain.pfm --quiet
check "which another one is not ($(apart kiosk.pfm plain.pfm))" test "$(apart kiosk.pfm plain.pfm)" -gt 28

# ---- mistakes ----
sed 's/^width = 48/width = 64/' box.scene >wide.scene
refused "a photograph of another size" 1 "b.png: 48 x 32 pixels, expected 64 x 32 as the camera of wide.scene has" \
	preview wide.scene --background b.png -o no.png
refused "lights of another dome" 1 "six.txt:6: ends after 6 lights, expected 26" \
	preview box.scene --background b.png --lights six.txt -o no.png
lines 26 "0 0 0" >black.txt
refused "black lights" 1 "black.txt: the upper half is black, expected some light" \
	preview box.scene --background b.png --lights black.txt -o no.png
printf '[background]\ntransfr = linear\n' >wrong.conf
refused "no fisheye" 1 "none.png: No such file" preview box.scene --background b.png --config dim.conf \
	--fisheye none.png -o no.png
refused "a configuration with a mistake" 1 "wrong.conf:2: [background] transfr: unknown key" \
	preview box.scene --background b.png --config wrong.conf -o no.png
refused "the photograph as output" 1 "b.png: is read, expected another name to write" \
	preview box.scene --background b.png -o b.png
refused "a kind of picture that is not written" 1 "no.jpg" preview box.scene --background b.png -o no.jpg
sed 's/^look_at = .*/look_at = 0 -6 1/' box.scene >away.scene
refused "a camera that sees no object" 3 "" preview away.scene --background b.png -o no.png --quiet
absent "none of them leaves a picture" no.png no.jpg

# ---- again and again ----
mkdir own
cp box.scene box.obj b.png own
cat >>own/box.scene <<'END'
texture = maps/paint.png
END
sed -i 's/^file = box.obj/&\nmaterial = paint/' own/box.scene
"$INLAY_BAKE" preview own/box.scene --background own/b.png --watch --samples 1 -o own.png >said.log 2>error.log &
watcher=$!
trap 'kill $watcher 2>/dev/null; rm -rf "$work"' EXIT
# made N NAME: there are N pictures.
made() {
	check "$2" until_true is_count said.log 'own.png: ' "$1"
}
is_count() { # FILE WORDS COUNT
	[ "$(said "$1" "$2")" = "$3" ]
}
complained() { # N WORDS NAME
	check "$3" until_true is_count error.log "$2" "$1"
}
complained 1 "maps/paint.png" "a texture that is not there is said"
mkdir own/maps
cp p.png own/maps/part.png
mv own/maps/part.png own/maps/paint.png
made 1 "and waited for, with its folder"
cp own.png before.png
sed -i 's/^position = 0/position = 0.2/' own/box.scene
made 2 "the scene file is replaced by rename"
differ "the picture is another one" before.png own.png
cp own.png before.png
sed 's/^look_at/lok_at/' own/box.scene >wrong.scene
cat wrong.scene >own/box.scene
complained 1 "own/box.scene:3: [camera] lok_at: unknown key" "a mistake is said"
same "the picture before stays" before.png own.png
sed 's/^lok_at/look_at/; s/^position = 0.2/position = 0/' wrong.scene >own/box.scene
made 3 "and mended"
sed 's/0\.6/0.3/' box.obj >own/part.obj
mv own/part.obj own/box.obj
made 4 "the mesh is replaced by rename"
touch own/other.obj
cp box.obj own/box.obj
made 5 "the mesh is written over"
"$INLAY" grab background --config studio.conf --set camera.background.sim.exposure=0.5 -o own/b.png 2>/dev/null
made 6 "another photograph"
rm own/box.scene
complained 1 "own/box.scene: No such file" "the scene goes"
cp box.scene own/box.scene
made 7 "and comes back"
check "it goes on" kill -0 $watcher
kill $watcher
wait $watcher
absent "no part of a picture is left" own.png.
finish
