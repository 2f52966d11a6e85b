#!/bin/bash
# SPDX-License-Identifier: MIT
# Whether an object registers with the picture to the pixel: a board is rendered through a camera
# whose lens bends both ways, its pictures are calibrated, and what is rendered through the camera
# that was found has to lie on the first. TAP; pictures and reports are left in
# build/accuracy/registration/.
set -u
cd "$(dirname "$0")/../.." || exit 1
build=${BUILD:?is not set: expected the folder that holds inlay, inlay-bake and inlay-calibrate}
here=tests/accuracy
most_rms=0.1   # px, of the board through the two cameras
most_moved=0.25 # px, of any corner in the second picture
count=0
failed=0

if ! command -v python3 >/dev/null; then
	echo "ok 1 - registration # SKIP python3 is not installed"
	echo "1..1"
	exit 0
fi

check() { # name, command...
	local name=$1
	shift
	count=$((count + 1))
	if "$@" >"$work/log" 2>&1; then
		echo "ok $count - $name"
	else
		echo "not ok $count - $name"
		tail -n 20 "$work/log" | sed 's/^/# /'
		failed=1
	fi
}
geometry() { python3 $here/registration.py "$@"; }
below() { # A B: A is the smaller number
	awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a + 0 < b + 0) }'
}
picture() { # SCENE OUT: baked, and composited as the kiosk does it
	{ "$build/inlay-bake" render --no-preview --quiet --samples 8 -o "$work/board.inlay" "$work/$1" || [ $? -eq 3 ]; } &&
		"$build/inlay" still --basis "$work/board.inlay" --background "$work/grey.png" \
			--lights "$work/lights.txt" -o "$work/$2"
}
pictures() {
	for view in 1 2 3 4; do
		picture "view$view.scene" "view$view.png" || return 1
	done
}
calibrated() { # OUT REPORT DIRECTION OPTION...
	local out=$1 report=$2 direction=$3
	shift 3
	"$build/inlay-calibrate" camera --board 9x6:25mm \
		--distortion "$direction" --object 0.1,-0.0625,0,0.15 --report "$work/$report" \
		-o "$work/$out" "$@"
}
# Writes a kiosk whose camera shows each view twice, half a second apart.
held() {
	for view in 1 2 3 4; do
		for frame in 0 1; do
			ln "$work/view$view.png" "$work/held$((2 * view - frame)).png" || return 1
		done
	done
}
unmarked() { # the check can fail
	! geometry marked "$work/view4.png" "$work/live" 2>"$work/why" && grep -q "no mark" "$work/why"
}
apart() { # CAMERA
	geometry apart "$work/true1.ini" "$work/$1" >"$work/apart" || return 1
	read -r rms most <"$work/apart"
	echo "# the board through both cameras: $rms px RMS, $most px at most" >&3
	below "$rms" $most_rms
}
moved() {
	geometry moved "$work/report" "$work/again" >"$work/moved" || return 1
	read -r rms most <"$work/moved"
	echo "# corners in the second picture: $rms px RMS, $most px at most" >&3
	below "$most" $most_moved
}
# A lens without distortion must exceed the bound, or the test could not fail.
would_fail() {
	sed 's/^kappa1 = .*/kappa1 = 0/' "$work/true1.ini" >"$work/straight.ini"
	geometry apart "$work/true1.ini" "$work/straight.ini" >"$work/apart" || return 1
	read -r rms _ <"$work/apart"
	below 1 "$rms"
}

exec 3>&1
for lens in "distorts -0.006" "undistorts 0.006"; do
	read -r direction kappa1 <<<"$lens"
	work=build/accuracy/registration/$direction
	rm -rf "$work"
	mkdir -p "$work"
	check "scenes through a lens that $direction" geometry scenes "$direction" "$kappa1" "$work"
	check "it bends by more than a pixel" would_fail
	check "the board, rendered" pictures
	check "found again, and calibrated" calibrated found.ini report "$direction" \
		--images "$work"/view?.png
	check "both cameras see the board at the same place" apart found.ini
	check "each picture, held still" held
	check "found live, by a kiosk whose camera shows these pictures" calibrated live.ini live \
		"$direction" --live "$work/kiosk.conf" --views 4
	check "at the same place again" apart live.ini
	check "its screen shows the board marked" geometry marked "$work/screen.png" "$work/live"
	check "which its camera's picture does not" unmarked
	sed 's/true1.ini/found.ini/' "$work/view1.scene" >"$work/found.scene"
	check "rendered through the camera that was found" picture found.scene found.png
	check "and found again there" calibrated again.ini again "$direction" \
		--images "$work/found.png" --intrinsics "$work/found.ini"
	check "it lies on the first picture" moved
done
echo "1..$count"
exit $failed
