#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay-calibrate light, and what inlay makes of its files: pictures of a simulated camera whose
# response is known, from exposures to still and run.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
: "${INLAY_CALIBRATE:?the program inlay-calibrate}"

# take NAME EXPOSURE OPTIONS...: the first frame of the studio through the background camera.
take() {
	local out=$1 exposure=$2
	shift 2
	"$INLAY" run --config "$work/studio.conf" --frames 1 --set screen.show=before \
		--set "screen.device=$work/$out" --set camera.background.sim.exposure="$exposure" \
		--set camera.background.sim.transfer=bt709 --set camera.background.sim.black_level=16 \
		--set camera.background.sim.read_noise=0.3 --set camera.background.sim.shot_noise=2 \
		"$@" 2>"$work/run.log" || sed 's/^/# /' "$work/run.log"
}
light() {
	"$INLAY_CALIBRATE" light "$@"
}
# doubted NAME WORDS COMMAND...: exit code 1, one sentence with the words.
doubted() {
	local name=$1 words=$2
	shift 2
	if "$@" >"$work/out" 2>"$work/said"; then
		fail "$name" < <(echo "exit code 0")
	elif grep -qF -- "$words" "$work/said" && [ "$(wc -l <"$work/said")" = 1 ]; then
		pass "$name"
	else
		fail "$name" <"$work/said"
	fi
}

# wrong NAME WORDS COMMAND...: exit code 2 and the words.
wrong() {
	local name=$1 words=$2 is
	shift 2
	light "$@" >"$work/out" 2>"$work/said"
	is=$?
	if [ $is = 2 ] && grep -qF -- "$words" "$work/said"; then
		pass "$name"
	else
		fail "$name" < <(echo "exit code $is" | cat - "$work/said")
	fi
}

# A wide picture has even places enough.
sed -e 's/^width = 48/width = 480/; s/^height = 32/height = 320/' "$work/box.scene" >"$work/wide.scene"
check "a wide scene" "$INLAY_BAKE" render --no-preview "$work/wide.scene" -o "$work/wide.inlay" --quiet \
	--frequency 1 --samples 1
sed -e 's/^width = 48/width = 480/; s/^height = 32/height = 320/; s/box.inlay/wide.inlay/' \
	"$work/studio.conf" >"$work/wide.conf"
mv "$work/wide.conf" "$work/studio.conf"

take covered.png 0
pictures=()
for exposure in 3.2 1.6 0.8 0.4 0.2; do
	take "at-$exposure.png" $exposure
	pictures+=("$work/at-$exposure.png")
done
bg=$work/background.ini

# ---- black level and response ----
check "black level" light black "$work/covered.png" -o "$bg"
level=$(sed -n 's/^black_level = //p' "$bg")
check "is that of the camera ($level)" awk "BEGIN { exit !($level > 15.8 && $level < 16.4) }"
doubted "an open lens is no covered one" "not dark" light black "${pictures[0]}" -o "$bg"
equal "what is doubted is not written" "$level" "$(sed -n 's/^black_level = //p' "$bg")"
check "response" light response --times 16,8,4,2,1 "${pictures[@]}" -o "$bg" --report "$work/page"
sed -n 's/^; //p' "$bg" | sed 's/^/# /'
check "the file keeps the black level" grep -q '^black_level' "$bg"
check "and has the response" grep -q '^response = 0 .* 1$' "$bg"
check "the page is there" test -s "$work/page/report.html" -a -s "$work/page/exposures.csv"
check "and JSON, which says that it is trusted" grep -q '"trusted": *true' "$work/page/light.json"
# BT.709 at the middle of the range is 0.2595.
middle=$(sed -n 's/^response = //p' "$bg" | cut -d' ' -f17)
check "it is the camera's curve ($middle)" \
	awk "BEGIN { d = $middle / 0.25955 - 1; exit !(d < 0.01 && d > -0.01) }"
cp "$bg" "$work/before.ini"
doubted "wrong times" "times do not agree" light response --times 16,8,6,2,1 "${pictures[@]}" -o "$bg"
doubted "two exposures" "fewer than three" light response --times 2,1 "${pictures[@]:0:2}" -o "$bg"
same "what is doubted is not written" "$work/before.ini" "$bg"

# ---- in the kiosk ----
equal "check takes it" "configuration is fine" \
	"$("$INLAY" check --config "$work/studio.conf" --set "background.light=$bg" 2>&1)"
equal "and names its line when it is damaged" \
	"inlay: $work/bad.ini:3: [light] gain: is \"much\", expected a number 0..1000000" \
	"$(printf '[light]\n\ngain = much\n' >"$work/bad.ini"
	"$INLAY" check --config "$work/studio.conf" --set "fisheye.light=$work/bad.ini" 2>&1)"
refused "a file that is not there" 1 "none.ini" \
	"$INLAY" check --config "$work/studio.conf" --set "fisheye.light=$work/none.ini"
refused "nor does run start" 1 "bad.ini:3" \
	"$INLAY" run --config "$work/studio.conf" --frames 1 --set "fisheye.light=$work/bad.ini"

# One stop of gain is one stop of light: still, with the gain in the file and in the configuration.
printf '[light]\ngain = 2.5\n' >"$work/eye.ini"
take sky.png 0.8 --set background.camera=fisheye --set camera.fisheye.sim.exposure=0.2 \
	--set screen.width=96 --set screen.height=96
still() { # NAME OPTIONS...
	local out=$1
	shift
	"$INLAY" still --config "$work/studio.conf" -o "$work/$out" --background "$work/at-0.8.png" \
		--fisheye "$work/sky.png" "$@"
}
check "still by the file" still by-file.png --set "fisheye.light=$work/eye.ini"
check "still by the configuration" still by-key.png --set fisheye.gain=2.5
same "give the same picture" "$work/by-file.png" "$work/by-key.png"
check "still without" still without.png
differ "which is not that of another gain" "$work/by-file.png" "$work/without.png"
check "a measured background" still measured.png --set "background.light=$bg"
differ "is another curve than sRGB" "$work/measured.png" "$work/without.png"
check "colours" still colours.png --set "fisheye.light=$work/red.ini" < <(
	printf '[light]\ncolours = 0 0 0 0 1 0 0 0 1\n' >"$work/red.ini"
	echo)
differ "are the light's" "$work/colours.png" "$work/without.png"

# ---- colours, wrong use ----
cat >"$work/patches.txt" <<'END'
# fisheye, background
0.5 0.1 0.1  0.45 0.15 0.10
0.1 0.5 0.1  0.14 0.47 0.12
0.1 0.1 0.5  0.09 0.13 0.52
0.5 0.5 0.1  0.49 0.52 0.12
0.4 0.4 0.4  0.40 0.42 0.42
0.2 0.3 0.4  0.21 0.32 0.42
END
check "colours from a file of patches" light colours "$work/patches.txt" -o "$work/eye.ini"
check "are beside the gain" grep -q '^gain = 2.5$' "$work/eye.ini"
awk '!/^#/ { print $1, $1, $1, $4, $4, $4 }' "$work/patches.txt" >"$work/grey.txt"
doubted "grey patches" "all grey" light colours "$work/grey.txt" -o "$work/eye.ini"
check "inlay reads them" "$INLAY" check --config "$work/studio.conf" \
	--set "fisheye.light=$work/eye.ini"
wrong "a command that there is not" "expected one of black" white
wrong "a file of hdrgen's to write" "read, not written" response --times 2,1 a.png b.png -o "$work/eye.rsp"
wrong "black without a picture" "expected one picture" black
wrong "black of two pictures" "expected one picture" black "$work/covered.png" "$work/covered.png"
wrong "a response without times" "1 pictures and 0 --times" response "$work/at-0.8.png"
wrong "pairs that are none" "pairs of pictures" gain "$work/sky.png" --patch 0,0,9,9
wrong "pairs without a patch" "pairs of pictures" gain "$work/sky.png" "$work/at-0.8.png"
wrong "colours without a background" "expected a file of patches" colours --fisheye "$work/sky.png" \
	--patch 0,0,9,9
doubted "a picture that is not there" "none.png" light black "$work/none.png"
doubted "pictures of two sizes" "$work/sky.png: the picture is 96x96 pixels, that of $work/at-0.8" \
	light response --times 2,1 "$work/at-0.8.png" "$work/sky.png"
doubted "a picture of linear light" "$work/linear.pfm: the picture holds linear light" light black \
	"$work/linear.pfm" < <(printf 'PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0' >"$work/linear.pfm")

# ---- gain, from the studio's own rug ----
take g-sky.png 0.8 --set background.camera=fisheye --set camera.fisheye.sim.exposure=0.1 \
	--set camera.fisheye.width=480 --set camera.fisheye.height=480 --set screen.width=480 \
	--set screen.height=480
take g-rug.png 0.8
check "gain" light gain "$work/g-sky.png" "$work/g-rug.png" --patch 200,200,60,20 \
	--reflectance 0.68,0.59,0.45 --background-light "$bg" -o "$work/gain.ini" --report "$work/gain"
# The ratio of the exposures; what walls send back is a constant in the studio: 4 % of the light.
gain=$(sed -n 's/^gain = //p' "$work/gain.ini")
check "is the ratio of the exposures ($gain)" awk "BEGIN { exit !($gain > 7.6 && $gain < 8.5) }"
doubted "an edge in the patch" "not of one brightness" light gain "$work/g-sky.png" "$work/g-rug.png" \
	--patch 200,80,60,60 --reflectance 0.5 -o "$work/gain.ini"
check "a lens that is not there is said" test "$(light gain --lens "$work/none.ini" --patch 1,1,9,9 \
	"$work/sky.png" "$work/at-0.8.png" 2>&1 | grep -c none.ini)" = 1
finish
