#!/bin/bash
# SPDX-License-Identifier: MIT
# Bad input: one clear line, exit code 1, and no file left behind, not even a part of one.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

"$INLAY" run --config "$work/studio.conf" --frames 1 --set "screen.device=$work/background.png" \
	--set screen.show=before 2>"$work/run.log"
"$INLAY" run --config "$work/studio.conf" --frames 1 --set "screen.device=$work/fisheye.png" \
	--set screen.show=before --set background.camera=fisheye --set screen.width=96 \
	--set screen.height=96 2>"$work/run.log"
out=$work/out.png

still() { # NAME WORDS options: refused, and nothing written
	local name=$1 words=$2
	shift 2
	refused "$name" 1 "$words" "$INLAY" still --config "$work/studio.conf" -o "$out" "$@"
	absent "$name: nothing is left" "$out"
}
pictures=(--background "$work/background.png" --fisheye "$work/fisheye.png")

still "no such basis" "none.inlay" "${pictures[@]}" --basis "$work/none.inlay"
: >"$work/empty.inlay"
still "an empty basis" "empty.inlay" "${pictures[@]}" --basis "$work/empty.inlay"
head -c 20000 "$work/box.inlay" >"$work/cut.inlay"
still "a truncated basis" "cut.inlay" "${pictures[@]}" --basis "$work/cut.inlay"
size=$(stat -c %s "$work/box.inlay")
for at in 0 9 40 5000 $((size / 2)) $((size - 1)); do
	cp "$work/box.inlay" "$work/flipped.inlay"
	flip "$work/flipped.inlay" "$at"
	still "a basis with a bit flipped in byte $at" "flipped.inlay" "${pictures[@]}" \
		--basis "$work/flipped.inlay"
done
still "a folder for a basis" "$work" "${pictures[@]}" --basis "$work"

still "no such background" "none.png" --background "$work/none.png" --fisheye "$work/fisheye.png"
still "no such fisheye" "none.png" --background "$work/background.png" --fisheye "$work/none.png"
still "a background of the wrong size" "96x96 pixels, expected 48x32" \
	--background "$work/fisheye.png" --fisheye "$work/fisheye.png"
still "a view outside the picture" "background.png" "${pictures[@]}" --set background.x=48
head -c 300 "$work/fisheye.png" >"$work/cut.png"
still "a truncated picture" "cut.png" --background "$work/background.png" --fisheye "$work/cut.png"
cp "$work/box.scene" "$work/text.png"
still "a picture that is none" "text.png" --background "$work/text.png" \
	--fisheye "$work/fisheye.png"

# A linear picture of 2 x 2 pixels; one value is not a number, infinite.
pfm() { # FILE HEX-OF-THE-LAST-VALUE
	printf 'PF\n2 2\n-1.0\n' >"$1"
	for _ in 1 2 3 4 5 6 7 8 9 10 11; do
		printf '\0\0\200\77'
	done >>"$1"
	# shellcheck disable=SC2059
	printf "$2" >>"$1"
}
pfm "$work/nan.pfm" '\0\0\300\177'
still "a NaN in linear light" "nan.pfm" --background "$work/background.png" \
	--fisheye "$work/nan.pfm"
pfm "$work/inf.pfm" '\0\0\200\177'
still "infinite light" "inf.pfm" --background "$work/background.png" --fisheye "$work/inf.pfm"
pfm "$work/fine.pfm" '\0\0\200\77'
still "a linear background" "expected an 8-bit picture" --background "$work/fine.pfm" \
	--fisheye "$work/fisheye.png" --set background.width=2

printf '1 1 1\n' >"$work/few.txt"
still "too few lights" "few.txt" --background "$work/background.png" --lights "$work/few.txt"
printf '1 1 x\n' >"$work/odd.txt"
still "a light that is none" "odd.txt:1" --background "$work/background.png" \
	--lights "$work/odd.txt"
printf '0x10 1 1\n' >"$work/hex.txt"
still "a light that is no decimal number" "hex.txt:1" --background "$work/background.png" \
	--lights "$work/hex.txt"
printf '1 \033[31m\r1\n' >"$work/escape.txt"
still "an escape sequence is not sent to the terminal" 'escape.txt:1: "1 ?[31m?1" is not' \
	--background "$work/background.png" --lights "$work/escape.txt"
still "a name of two lines is said in one" "two?lines.txt" --background "$work/background.png" \
	--lights "$work/two
lines.txt"
still "lights without end" "/dev/zero: not a regular file but a device" --background "$work/background.png" \
	--lights /dev/zero
still "an empty file of lights" "empty.inlay: holds no lights, expected 26 lines" \
	--background "$work/background.png" --lights "$work/empty.inlay"
still "a pose that there is not" "pose 3" "${pictures[@]}" --pose 3
still "an unknown key" "unknown key, did you mean \"threshold\"?" "${pictures[@]}" \
	--set lights.treshold=1
still "a value out of range" "expected a number 0..64" "${pictures[@]}" --set composite.gain=65
printf '[lights]\nthreshold = 256\n' >"$work/range.conf"
refused "a value out of range in a file" 1 \
	"range.conf:2: [lights] threshold: is \"256\", expected a number 0..255 grey levels" \
	"$INLAY" still --config "$work/range.conf" --basis "$work/box.inlay" "${pictures[@]}" -o "$out"
printf '[lights]\nthreshold = 101%%\n' >"$work/percent.conf"
refused "more than all of white" 1 "is \"101%\", expected a number 0..255 grey levels or a percentage 0%..100%" \
	"$INLAY" still --config "$work/percent.conf" --basis "$work/box.inlay" "${pictures[@]}" -o "$out"
refused "no folder to write to" 1 "nowhere" "$INLAY" still --config "$work/studio.conf" \
	"${pictures[@]}" -o "$work/nowhere/out.png"
refused "no folder for the lights" 1 "nowhere" "$INLAY" still --config "$work/studio.conf" \
	"${pictures[@]}" -o "$out" --lights-out "$work/nowhere/lights.txt"
absent "no folder for the lights: nothing is left" "$out"
printf 'as it was' >"$out"
"$INLAY" still --config "$work/studio.conf" "${pictures[@]}" --basis "$work/cut.inlay" -o "$out" \
	2>"$work/said"
equal "an old picture stays as it was" "as it was" "$(cat "$out")"
rm "$out"

run() { # NAME WORDS options
	local name=$1 words=$2
	shift 2
	refused "$name" 1 "$words" timeout 120 "$INLAY" run --config "$work/studio.conf" --frames 2 \
		--set "screen.device=$out" "$@"
	absent "$name: nothing is left" "$out"
}
run "run without a basis" "none.inlay" --set "basis.file=$work/none.inlay"
run "run with a damaged basis" "cut.inlay" --set "basis.file=$work/cut.inlay"
run "a camera that is none" "/dev/null" --set camera.background.driver=v4l2 \
	--set camera.background.device=/dev/null
run "a camera's file that is none" "text.png" --set camera.background.sim.source=files \
	--set "camera.background.sim.file=$work/text.png"
run "a camera's panorama that is not named" "sim.file: is empty, expected the panorama" \
	--set camera.background.sim.source=panorama --set camera.background.sim.file=
run "a format that a camera has not" "format" --set camera.fisheye.format=NV12
run "an unknown camera driver" "[camera fisheye] driver" --set camera.fisheye.driver=webcam
run "an unknown screen" "[screen] driver" --set screen.driver=oled
run "a view without a camera" "there is no section [camera sky]" --set fisheye.camera=sky
run "no buttons where they should be" "script.file" --set buttons.driver=script \
	--set "buttons.script.file=$work/none.txt"
run "statistics into no folder" "nowhere" --stats "$work/nowhere/s.jsonl"
refused "a screen's file of an unknown kind" 1 "out.bmp" "$INLAY" run --config "$work/studio.conf" \
	--frames 1 --set "screen.device=$work/out.bmp"
refused "a screen's file in no folder" 1 "nowhere" "$INLAY" run --config "$work/studio.conf" \
	--frames 1 --set "screen.device=$work/nowhere/out.png"

run "a camera's picture of the wrong size" "the background is 64x32 pixels, expected 48x32" \
	--set camera.background.width=64

# ---- a pipe that nobody writes to, where a file should be: nothing waits for it ----
mkfifo "$work/pipe"
unfit() { # NAME COMMAND...
	refused "a pipe as $1" 1 "pipe: not a regular file but a named pipe" timeout -k 1 120 "${@:2}"
}
unfit "the configuration" "$INLAY" run --config "$work/pipe"
unfit "the lens" "$INLAY" run --config "$work/studio.conf" --set "fisheye.lens=$work/pipe"
unfit "what was measured" "$INLAY" check --config "$work/studio.conf" --set "fisheye.light=$work/pipe"
unfit "a script of buttons" "$INLAY" run --config "$work/studio.conf" --set buttons.driver=script \
	--set "buttons.script.file=$work/pipe"
for light in fisheye lights; do
	unfit "the $light" "$INLAY" still --config "$work/studio.conf" \
		--background "$work/background.png" "--$light" "$work/pipe" -o "$out"
done
unfit "the background" "$INLAY" still --config "$work/studio.conf" --background "$work/pipe" \
	--fisheye "$work/fisheye.png" -o "$out"
unfit "a scene" "$INLAY_BAKE" render "$work/pipe" -o "$work/none.inlay"
sed "1a file = pipe" "$work/box.scene" >"$work/camera.scene"
unfit "a scene's camera" "$INLAY_BAKE" render "$work/camera.scene" -o "$work/none.inlay"
cp "$work/background.png" "$work/exposure.png"
unfit "a photograph" "$INLAY_CALIBRATE" light response "$work/pipe" "$work/exposure.png" -o "$work/none.ini"
absent "pipes: nothing is left" "$out" "$work/none.inlay"
check "what a command writes is read all the same" "$INLAY" still \
	--config <(sed "s|^file = |file = $work/|" "$work/studio.conf") "${pictures[@]}" -o "$out"
rm "$out"

# ---- what is read is not written over ----
kept() { # NAME FILE COMMAND...: refused, and FILE is what it was
	local name=$1 file=$2
	shift 2
	cp "$file" "$work/before"
	refused "$name" 1 "is read, expected another name to write" "$@"
	same "$name: it is what it was" "$work/before" "$file"
}
mesh=$(sed -n 's/^file *= *//p' "$work/box.scene" | head -n 1)
pfm "$work/sky.pfm" '\0\0\200\077'
kept "a still over its background" "$work/background.png" \
	"$INLAY" still --config "$work/studio.conf" "${pictures[@]}" -o "$work/background.png"
kept "an export over its basis" "$work/box.inlay" \
	"$INLAY_BAKE" export "$work/box.inlay" --msi "$work/box.inlay"
kept "a bake over its scene" "$work/box.scene" \
	"$INLAY_BAKE" render "$work/box.scene" -o "$work/box.scene"
kept "a bake over its mesh" "$work/$mesh" "$INLAY_BAKE" render "$work/box.scene" -o "$work/$mesh"
kept "a truth over its panorama" "$work/sky.pfm" \
	"$INLAY_BAKE" truth "$work/box.scene" --panorama "$work/sky.pfm" -o "$work/sky.pfm"
refused "two outputs of one name" 1 "is to be written twice" "$INLAY_BAKE" truth "$work/box.scene" \
	--panorama "$work/sky.pfm" -o "$work/one.pfm" --fisheye-out "$work/./one.pfm"
absent "two outputs of one name: neither is written" "$work/one.pfm"
refused "no folder for the last of two outputs" 1 "nowhere/out.png" \
	"$INLAY" still --config "$work/studio.conf" "${pictures[@]}" -o "$work/nowhere/out.png" \
	--lights-out "$work/lights.txt"
absent "the first is not written either" "$work/lights.txt"

finish
