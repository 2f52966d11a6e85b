#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay run whose fisheye takes exposures in turn: pictures as of a camera that does not clip, whatever
# the control's delay; cameras that refuse; and the ground, which tells what clips.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
counter=$(dirname "$INLAY")/tests/cli/tools/allocations.so

# A fisheye that clips the lamps.
sed -e 's/^gain = 5/gain = 1/; s/^sim.exposure = 0.2/sim.exposure = 1/' "$work/studio.conf" >"$work/new.conf"
mv "$work/new.conf" "$work/studio.conf"
three=(--set "fisheye.exposures=1, 0.125, 0.015625" --set fisheye.exposure_control=exposure)
run() {
	timeout 600 "$INLAY" run --config "$work/studio.conf" --set lights.follow=0 "$@" 2>"$work/run.log"
}
# apart FILE FILE: the largest difference of two videos' last frames
apart() {
	cmp -l <(tail -c $((3 * 48 * 32)) "$1") <(tail -c $((3 * 48 * 32)) "$2") |
		awk 'function n(o) { return int(o / 100) * 64 + int(o % 100 / 10) * 8 + o % 10 }
			{ d = n($2) - n($3); if (d < 0) d = -d; if (d > m) m = d } END { print m + 0 }'
}

# ---- three exposures see what one clips ----
check "one exposure" run --frames 70 --set "screen.device=$work/one.y4m" --stats "$work/one.jsonl"
check "clips ($(number "$work/one.jsonl" clipped))" \
	awk "BEGIN { exit !($(number "$work/one.jsonl" clipped) > 0.001) }"
check "a camera that does not clip" run --frames 70 --set "screen.device=$work/linear.y4m" \
	--set camera.fisheye.format=RGBF
off=$(apart "$work/one.y4m" "$work/linear.y4m")
check "gives another picture ($off levels)" test "$off" -ge 5
for delay in 0 2 6; do
	for known in -1 $delay; do
		check "three exposures, $delay frames late, told $known" run --frames 70 "${three[@]}" \
			--set camera.fisheye.sim.control_delay=$delay --set fisheye.exposure_delay="$known" \
			--set "screen.device=$work/three.y4m" --stats "$work/three.jsonl"
		off=$(apart "$work/three.y4m" "$work/linear.y4m")
		check "as that camera's ($off levels)" test "$off" -le 1
		equal "no picture has another exposure" 0 "$(number "$work/three.jsonl" unfit)"
	done
	check "nothing clips" awk "BEGIN { exit !($(number "$work/three.jsonl" clipped) == 0) }"
done
check "the delay was measured" run --frames 70 "${three[@]}" --set screen.driver=null \
	--set camera.fisheye.sim.control_delay=5
check "which is said" says "$work/run.log" "another exposure is seen after 5 frames"

printf '[light]\ndelay = 3\n' >"$work/eye.ini"
check "a delay that was calibrated" run --frames 40 "${three[@]}" --set screen.driver=null \
	--set camera.fisheye.sim.control_delay=3 --set "fisheye.light=$work/eye.ini" --stats "$work/eye.jsonl"
equal "is not measured again" 0 "$(said "$work/run.log" "another exposure is seen")"
equal "and right" 0 "$(number "$work/eye.jsonl" unfit)"

# ---- the background's camera is left alone ----
check "before, with one exposure" run --frames 40 --set screen.show=before --set "screen.device=$work/b1.y4m"
check "and with three" run --frames 40 --set screen.show=before --set "screen.device=$work/b3.y4m" "${three[@]}"
same "the background is the same" "$work/b1.y4m" "$work/b3.y4m"

# ---- what is wrong with delay, frames, camera ----
check "a wrong delay" run --frames 140 "${three[@]}" --set camera.fisheye.sim.control_delay=4 \
	--set fisheye.exposure_delay=2 --set "screen.device=$work/wrong.y4m"
check "is noticed" says "$work/run.log" "how long it takes is measured"
check "and mended" says "$work/run.log" "another exposure is seen after 4 frames"
check "frames that are lost" run --frames 90 "${three[@]}" --set screen.driver=null \
	--set camera.fisheye.sim.corrupt_every=7 --set camera.fisheye.sim.control_delay=2 --stats "$work/lost.jsonl"
equal "shift nothing" 0 "$(number "$work/lost.jsonl" unfit)"
check "a control that is none" run --frames 30 --set screen.driver=null \
	--set "fisheye.exposures=1, 0.125" --set fisheye.exposure_control=iris --stats "$work/none.jsonl"
equal "is said once" 1 "$(said "$work/run.log" 'no control "iris", expected exposure: it stays at one exposure')"
equal "and there is light" 26 "$(number "$work/none.jsonl" lights_used)"
check "a value out of range" run --frames 60 --set screen.driver=null \
	--set "fisheye.exposures=100000000, 0.125" --set fisheye.exposure_control=exposure
check "too" says "$work/run.log" "it stays at one exposure"
seen_twice() {
	[ "$(said "$work/run.log" "another exposure is seen")" -ge 2 ]
}
start "${three[@]}" --set lights.follow=0 --set camera.fisheye.sim.vanish_after=60 \
	--set camera.fisheye.sim.clock=frames --set camera.background.sim.clock=frames
check "a camera that vanishes takes them up again" until_true seen_twice
stop

# ---- the ground ----
floor=(--set "background.ground_patch=2 2 10 6")
check "the ground" run --frames 20 "${floor[@]}" --set "background.ground_reflectance=0.5 0.5 0.5" \
	--set "screen.device=$work/ground.y4m" --stats "$work/ground.jsonl"
equal "tells what clips" '"yes"' "$(grep -oE '"recovered":"[a-z ]*"' "$work/ground.jsonl" | tail -n 1 | cut -d: -f2)"
check "without clipping" run --frames 20 "${floor[@]}" --set camera.fisheye.sim.exposure=0.05 \
	--set fisheye.gain=20 --set "screen.device=$work/g1.y4m" --stats "$work/g1.jsonl"
check "as without a patch" run --frames 20 --set camera.fisheye.sim.exposure=0.05 \
	--set fisheye.gain=20 --set "screen.device=$work/g2.y4m"
same "it changes nothing" "$work/g1.y4m" "$work/g2.y4m"

for show in before composite; do
	check "one frame, $show" run --frames 1 "${floor[@]}" --set screen.show=$show \
		--set "screen.device=$work/$show.png"
done
check "and the sky" run --frames 1 --set screen.show=before --set background.camera=fisheye \
	--set screen.width=96 --set screen.height=96 --set "screen.device=$work/sky.png"
check "still recovers, too" "$INLAY" still --config "$work/studio.conf" "${floor[@]}" \
	--background "$work/before.png" --fisheye "$work/sky.png" -o "$work/still.png"
same "and makes the picture that run makes" "$work/composite.png" "$work/still.png"

# ---- the configuration ----
refused "one exposure alone" 1 "[fisheye] exposures: is one value, expected 2 to 5" \
	"$INLAY" check --config "$work/studio.conf" --set fisheye.exposures=1
refused "exposures that do not descend" 1 "[fisheye] exposures: 2 comes after 1, expected each" \
	"$INLAY" check --config "$work/studio.conf" "${three[@]}" --set fisheye.exposures=1,2
refused "a camera that is the background's, too" 1 "is seen by another view too" \
	"$INLAY" check --config "$work/studio.conf" "${three[@]}" --set fisheye.camera=background
refused "half a pixel" 1 "[background] ground_patch: is 1.5 2 3 4, expected whole pixels" \
	"$INLAY" check --config "$work/studio.conf" --set "background.ground_patch=1.5 2 3 4"
refused "a patch outside" 1 "[background] ground_patch: reaches to 60, 12, expected at most 48, 32" \
	"$INLAY" run --config "$work/studio.conf" --frames 1 --set "background.ground_patch=40 2 20 10"
sed '$!b; a [fisheye]\nexposures = 4, 2, x' "$work/studio.conf" >"$work/bad.conf"
line=$(wc -l <"$work/bad.conf")
refused "no number" 1 "bad.conf:$line: [fisheye] exposures: is \"4, 2, x\", expected at most 5 numbers" \
	"$INLAY" check --config "$work/bad.conf"

# ---- nothing is allocated per frame ----
preload=(LD_LIBRARY_PATH="$(dirname "$counter")" LD_PRELOAD="$(basename "$counter")"
	ALLOCATIONS="$work/allocations")
if [ -e "$counter" ]; then
	check "three exposures and the ground" env "${preload[@]}" "$INLAY" run --config "$work/studio.conf" \
		--frames 180 --set screen.driver=null --set screen.rate=60 "${three[@]}" "${floor[@]}"
	equal "allocate nothing after the first second" 0 \
		"$(tr ' ' '\n' <"$work/allocations" | grep -A1 -x after | tail -n 1)"
else
	fail "nothing is allocated per frame" < <(echo "$counter: missing")
fi

finish
