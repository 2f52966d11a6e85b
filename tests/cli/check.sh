#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay check, --print-config, --help, --version, devices: what they say, and with which exit code.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

equal "a sound configuration" "configuration is fine" \
	"$("$INLAY" check --config "$work/studio.conf" 2>&1)"

cat >"$work/wrong.conf" <<'END'
[basis]
file = nowhere.inlay
pose = 1
[camera sky]
driver = sim
sim.file = missing.hdr
rate = fast
[camera other]
driver = v4l3
[fisheye]
camera = syk
transfer = sgrb
[background]
camera = other
[lights]
treshold = 5
threshold_step = 1000
[screen]
driver = file
END
cat >"$work/expected" <<END
inlay: $work/wrong.conf:7: [camera sky] rate: is "fast", expected a number 0..1000 Hz
inlay: $work/wrong.conf:12: [fisheye] transfer: is "sgrb", expected one of srgb, bt709, linear; did you mean "srgb"?
inlay: $work/wrong.conf:16: [lights] treshold: unknown key, did you mean "threshold"?
inlay: $work/wrong.conf:17: [lights] threshold_step: is "1000", expected a number 0.1..255 grey levels, or percent
inlay: $work/wrong.conf: [camera sky] sim.file: cannot read "$work/missing.hdr": No such file or directory
inlay: $work/wrong.conf: [camera other] driver: is "v4l3", expected one of v4l2, sim; did you mean "v4l2"?
inlay: $work/wrong.conf: [fisheye] camera: there is no section [camera syk]; did you mean "sky"?
END
"$INLAY" check --config "$work/wrong.conf" >"$work/out" 2>"$work/said"
equal "a wrong one is exit code 1" 1 $?
equal "with nothing on standard output" "" "$(cat "$work/out")"
# libcamera is not in every build.
grep -v nowhere.inlay "$work/said" | sed 's/ libcamera,//' >"$work/said-else"
same "all that is wrong is said" "$work/expected" "$work/said-else"
check "the missing basis too" grep -qF "[basis] file: $work/nowhere.inlay" "$work/said"

refused "a pose that the basis does not hold" 1 "[basis] pose: is 1, expected 0..0" \
	"$INLAY" check --config "$work/studio.conf" --set basis.pose=1
head -c 5000 "$work/box.inlay" >"$work/short.inlay"
refused "a damaged basis" 1 "short.inlay" \
	"$INLAY" check --config "$work/studio.conf" --set "basis.file=$work/short.inlay"
refused "a kernel that there is not" 1 '[composite] kernel: this processor has none called "abacus"' \
	"$INLAY" check --config "$work/studio.conf" --set composite.kernel=abacus
refused "a patch of ground outside" 1 "[background] ground_patch: reaches to 60, 12, expected at most 48, 32" \
	"$INLAY" check --config "$work/studio.conf" --set "background.ground_patch=40 2 20 10"
refused "a mask of people that is not there" 1 "[people] mask: $work/none.png: No such file or directory" \
	"$INLAY" check --config "$work/studio.conf" --set "people.mask=$work/none.png"
refused "a mask of another size" 1 "pixels, expected 48x32 as the basis was baked" \
	"$INLAY" check --config "$work/studio.conf" --set people.mask=board/kiosk.png
refused "a mask that is no picture" 1 "[people] mask: $work/box.inlay" \
	"$INLAY" run --config "$work/studio.conf" --frames 1 --set people.occlude=yes --set "people.mask=$work/box.inlay"
printf '[fisheye]\nlens = %s\n[basis]\nfile = %s\n' "$work/none.ini" "$work/none.inlay" >"$work/both.conf"
"$INLAY" check --config "$work/both.conf" 2>"$work/said"
equal "a lens file that is not there is exit code 1" 1 $?
check "and is named" grep -qF "none.ini" "$work/said"
check "with what else is missing" grep -qF "none.inlay" "$work/said"
refused "exact without the lights' own pictures" 1 "no exact layer" \
	"$INLAY" check --config "$work/studio.conf" --set composite.mode=exact
refused "no such configuration" 1 "none.conf: No such file or directory" \
	"$INLAY" check --config "$work/none.conf"
refused "a configuration that is none" 1 "expected a text file" \
	"$INLAY" run --config "$work/box.inlay"

# ---- a depth camera ----
cp "$work/studio.conf" "$work/depth.conf"
printf '[camera depth]\ndriver = sim\n[depth]\ncamera = depth\n' >>"$work/depth.conf"
cat >"$work/far.ini" <<'EOF'
[camera]
width = 96
height = 64
rotation = 1 0 0  0 0 -1  0 1 0
translation = 0 1 3
focal = 1
pixel = 0.01 0.01
centre = 48 32
EOF
wrong() { # NAME WORDS OPTIONS...
	local name=$1 words=$2
	shift 2
	refused "$name" 1 "$words" "$INLAY" check --config "$work/depth.conf" "$@"
}
check "a depth camera is fine" "$INLAY" check --config "$work/depth.conf"
wrong "a camera for two views" \
	"[depth] camera: camera background is seen by another view too, expected a camera of its own" \
	--set depth.camera=background
wrong "pictures in place of depths" \
	"[camera depth] format: is YUYV, but [depth] looks through it; expected Z16 or none" \
	--set camera.depth.format=YUYV
wrong "no such camera" 'there is no section [camera dept]; did you mean "depth"?' --set depth.camera=dept
wrong "no such calibration" "[depth] calibration: cannot read" --set "depth.calibration=$work/none.ini"
sed 's/^focal.*/focal = -1/' "$work/far.ini" >"$work/wrong.ini"
wrong "a calibration that is none" "wrong.ini:6: [camera] focal: is \"-1\"" --set "depth.calibration=$work/wrong.ini"
sed 's/^rotation.*/rotation = 1 0 0  0 1 0  0 1 0/' "$work/far.ini" >"$work/turned.ini"
wrong "a rotation that is none" "turned.ini: camera: rotation" --set "depth.calibration=$work/turned.ini"
printf '[fisheye]\n' >"$work/eye.ini"
wrong "one of another camera" "eye.ini" --set "depth.calibration=$work/eye.ini"
printf '[depth]\nunit = 0\n' >>"$work/depth.conf"
lines=$(grep -c '' "$work/depth.conf")
wrong "no unit" "depth.conf:$lines: [depth] unit: is \"0\", expected a number 0.001..1000 mm"

# The sample is the defaults; its own test compares it with the tables.
"$INLAY" check --sample >"$work/sample.conf"
check "the sample reads without fault" "$INLAY" run --config "$work/sample.conf" --print-config
"$INLAY" run --config "$work/studio.conf" --set lights.threshold=12.5 --print-config >"$work/one.conf"
"$INLAY" check --config "$work/one.conf" --print-config >"$work/two.conf"
same "what --print-config prints reads back the same" "$work/one.conf" "$work/two.conf"
check "with the value that --set gave" grep -qx "threshold = 12.5" "$work/one.conf"

for command in "" run still devices check bench; do
	# shellcheck disable=SC2086
	check "inlay $command --help" "$INLAY" $command --help
done
equal "--version" "inlay" "$("$INLAY" --version | cut -d' ' -f1)"
refused "a misspelt command" 2 "did you mean \"check\"?" "$INLAY" chekc
refused "an unknown command" 2 "expected one of those" "$INLAY" zzzzzzzzz
refused "a misspelt option" 2 "did you mean --frames?" "$INLAY" run --framse 3
refused "an option without its value" 2 "--frames has no value" "$INLAY" run --frames
refused "a wrong value" 2 "--frames: \"0\"" "$INLAY" run --frames 0
refused "a word that is no option" 2 "\"here\" is one argument too many" "$INLAY" check here
refused "a value that none is expected for" 2 "--json takes no value" "$INLAY" devices --json=yes
refused "an unknown short option" 2 "unknown option -x" "$INLAY" still -x
refused "a background of another size than the basis" 1 "the picture is 64x32 pixels, expected 48x32" \
	"$INLAY" check --config "$work/studio.conf" --set camera.background.width=64 --set camera.background.height=32
refused "still without a picture" 2 "--background IMG is missing" "$INLAY" still -o "$work/a.png"
refused "still with two lights" 2 "expected one of --fisheye IMG and --lights FILE" "$INLAY" still \
	-o "$work/a.png" --background a.png --fisheye b.png --lights c.txt
refused "still into an unknown kind of file" 2 ".png, .pfm or .hdr" "$INLAY" still -o a.bmp
"$INLAY" >"$work/out" 2>"$work/said"
equal "no command is exit code 2" 2 $?
check "with the list of commands" grep -q "still  " "$work/said"
if [ -w /dev/full ]; then
	refused "a full disk behind standard output" 1 "cannot write to standard output" \
		sh -c "\"\$INLAY\" --help >/dev/full"
fi

"$INLAY" devices >"$work/devices" 2>&1
equal "devices" 0 $?
check "lists the drivers" grep -q "camera   sim" "$work/devices"
"$INLAY" devices --json >"$work/devices.json" 2>&1
check "and in JSON the three kinds" grep -qxE \
	'\{"cameras": \[.*\], "screens": \[.*\], "buttons": \[.*\]\}' "$work/devices.json"

finish
