#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay still: the same picture as inlay run makes, from files.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
compare=$(dirname "$INLAY")/tests/accuracy/compare

# The lamps move, and a still picture knows no light before its own.
run() { # NAME.png, options: the third frame
	local out=$1
	shift
	"$INLAY" run --config "$work/studio.conf" --frames "${frames:-3}" --set "screen.device=$work/$out" "$@" \
		--set lights.follow=0 2>"$work/run.log" || sed 's/^/# /' "$work/run.log"
}
still() { # NAME, options
	local out=$1
	shift
	"$INLAY" still --config "$work/studio.conf" -o "$work/$out" "$@"
}

# The camera pictures of the last frame that run showed.
run background.png --set screen.show=before
sky=(--set background.camera=fisheye --set screen.width=96 --set screen.height=96)
run fisheye.png --set screen.show=before "${sky[@]}"
run after.png
run after-100.png --set lights.threshold=100 --set lights.threshold_mode=drop
pictures=(--background "$work/background.png" --fisheye "$work/fisheye.png")

check "still makes a picture" still still.png --basis "$work/box.inlay" "${pictures[@]}"
same "it is the one that run shows" "$work/after.png" "$work/still.png"
check "the basis may stand in the configuration" still again.png "${pictures[@]}"
same "and gives the same picture" "$work/still.png" "$work/again.png"
differ "the object is in it" "$work/still.png" "$work/background.png"

check "a threshold" still still-100.png "${pictures[@]}" --threshold 100 \
	--set lights.threshold_mode=drop
same "leaves out the lights that run leaves out" "$work/after-100.png" "$work/still-100.png"
differ "which shows" "$work/still.png" "$work/still-100.png"
# The lights that fit a budget depend on those of the frame before: its first one.
frames=1
run background-1.png --set screen.show=before
run fisheye-1.png --set screen.show=before "${sky[@]}"
run after-percent.png --set lights.threshold=20%
frames=3
check "a budget of white" still still-percent.png --threshold 20% \
	--background "$work/background-1.png" --fisheye "$work/fisheye-1.png"
same "leaves out the lights that run leaves out" "$work/after-percent.png" "$work/still-percent.png"
check "none of it is none" still still-zero.png "${pictures[@]}" --threshold 0%
same "and all are used" "$work/still.png" "$work/still-zero.png"
for wrong in 101% -1% 1%% % 1%2 "1 %" 0x1 nan 256; do
	refused "a threshold of $wrong" 2 "expected a grey level 0..255 or a percentage 0%..100%" \
		still no.png "${pictures[@]}" --threshold "$wrong"
done

check "lights are written" still with-lights.png "${pictures[@]}" --lights-out "$work/lights.txt"
equal "one for each of 26" 26 "$(grep -c '^[0-9]' "$work/lights.txt")"
check "and read instead of a fisheye" still from-lights.png --background "$work/background.png" \
	--lights "$work/lights.txt"
same "with the same picture" "$work/still.png" "$work/from-lights.png"
{
	printf '\xef\xbb\xbf'
	cat "$work/lights.txt"
} >"$work/marked.txt"
check "a byte order mark does not matter" still from-marked.png --background "$work/background.png" \
	--lights "$work/marked.txt"
same "it is the same picture" "$work/still.png" "$work/from-marked.png"
awk '/^[0-9]/ { print 0, 0, 0; next } { print }' "$work/lights.txt" >"$work/night.txt"
check "no light at all" still night.png --background "$work/background.png" \
	--lights "$work/night.txt"
differ "leaves the object black" "$work/night.png" "$work/still.png"

# Half a level is rounding, the rest is the bound of the integer arithmetic.
for kernel in auto c; do
	check "fast, kernel $kernel" still fast.png "${pictures[@]}" --mode fast \
		--set "composite.kernel=$kernel"
	same "is what there is without a word" "$work/still.png" "$work/fast.png"
done
check "the reference" still reference.png "${pictures[@]}" --mode reference
worst=$("$compare" "$work/still.png" "$work/reference.png" | awk '{ print $3 }')
check "is within one level of fast (${worst:-not compared})" test "${worst%.*}" -le 1
refused "a kernel that there is not" 1 'no kernel called "abacus"' \
	"$INLAY" still --config "$work/studio.conf" -o "$work/none.png" "${pictures[@]}" \
	--set composite.kernel=abacus
refused "exact without the lights' own pictures" 1 "inlay-bake render --exact" \
	"$INLAY" still --config "$work/studio.conf" -o "$work/none.png" "${pictures[@]}" --mode exact
check "a basis with them" "$INLAY_BAKE" render "$work/box.scene" --exact -o "$work/exact.inlay" \
	--quiet
exact=(--basis "$work/exact.inlay" "${pictures[@]}")
check "gives an exact picture" still exact.png "${exact[@]}" --mode exact
check "as the configuration may ask for" still exact-too.png "${exact[@]}" \
	--set composite.mode=exact
same "alike" "$work/exact.png" "$work/exact-too.png"
check "and is its reference" still exact-reference.png "${exact[@]}" --mode reference
worst=$("$compare" "$work/exact.png" "$work/exact-reference.png" | awk '{ print $3 }')
check "which is within one level (${worst:-not compared})" test "${worst%.*}" -le 1
check "linear light into PFM" still still.pfm "${pictures[@]}"
equal "of the same size" "PF 48 32" "$(head -c 9 "$work/still.pfm" | tr '\n' ' ' | sed 's/ *$//')"
worst=$("$compare" "$work/still.png" "$work/still.pfm" | awk '{ print $3 }')
check "and the same light (${worst:-not compared})" awk "BEGIN { exit !($worst < 0.01) }"
check "into Radiance too" still still.hdr "${pictures[@]}"

# A camera that hangs upside down gives both pictures turned.
down=(--set background.hflip=yes --set background.vflip=yes)
run turned-background.png --set screen.show=before "${down[@]}"
run turned-fisheye.png --set screen.show=before "${sky[@]}" "${down[@]}"
differ "turned pictures are others" "$work/background.png" "$work/turned-background.png"
check "are turned back" still turned.png --background "$work/turned-background.png" \
	--fisheye "$work/turned-fisheye.png" "${down[@]}" \
	--set fisheye.hflip=yes --set fisheye.vflip=yes
same "into the same picture" "$work/still.png" "$work/turned.png"

# Linear light: what the fisheye's picture stands for, as a float file.
"$INLAY" still --config "$work/studio.conf" --lights "$work/night.txt" \
	--background "$work/background.png" -o "$work/plain.pfm" --set composite.gain=0
check "a linear fisheye" still linear.png --background "$work/background.png" \
	--fisheye "$work/plain.pfm"
"$INLAY" run --config "$work/studio.conf" --frames 2 --set "screen.device=$work/linear-run.png" \
	--set camera.fisheye.sim.source=files --set "camera.fisheye.sim.file=$work/plain.pfm" \
	--set camera.fisheye.format=RGBF --set camera.fisheye.width=0 --set camera.fisheye.height=0 \
	--set camera.fisheye.sim.exposure=1 --set camera.background.sim.source=files \
	--set "camera.background.sim.file=$work/background.png" --set camera.background.width=0 \
	--set camera.background.height=0 2>"$work/run.log" || sed 's/^/# /' "$work/run.log"
same "gives what a camera of linear light gives" "$work/linear-run.png" "$work/linear.png"

finish
