#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay-calibrate: from points to a file that inlay-bake reads, reports, files of OpenCV and ROS, and
# how it fails.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
: "${INLAY_CALIBRATE:?the program inlay-calibrate}"

calibrate() {
	"$INLAY_CALIBRATE" "$@"
}
commands=$(calibrate --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p')
has_command() {
	grep -qx "$1" <<<"$commands"
}
# wrong NAME WORDS COMMAND...: exit 2, the words on stderr, nothing on stdout.
wrong() {
	local name=$1 words=$2 out is
	shift 2
	out=$(calibrate "$@" 2>"$work/stderr" </dev/null)
	is=$?
	if [ $is -eq 2 ] && [ -z "$out" ] && grep -qF -- "$words" "$work/stderr"; then
		pass "$name"
	else
		fail "$name" < <(echo "exit code $is, expected 2 and: $words" | cat - "$work/stderr")
	fi
}
# failed_with NAME WORDS COMMAND...: exit 1, one line on stderr that holds the words.
failed_with() {
	local name=$1 words=$2 is
	shift 2
	calibrate "$@" >"$work/stdout" 2>"$work/stderr" </dev/null
	is=$?
	if [ $is -eq 1 ] && [ "$(grep -c '' "$work/stderr")" -eq 1 ] &&
		[[ $(cat "$work/stderr") == "inlay-calibrate: "*"$words"* ]]; then
		pass "$name"
	else
		fail "$name" < <(echo "exit code $is, expected 1 and one line: $words" |
			cat - "$work/stderr")
	fi
}
is_json() { # FILE
	if command -v python3 >/dev/null; then
		python3 -m json.tool "$1" >/dev/null
	else
		test -s "$1"
	fi
}

# ---- the program and its commands ----
check "--help" calibrate --help
check "--version" calibrate --version
wrong "no command" "COMMAND" 2>/dev/null
wrong "an unknown command" 'there is no command "guess"' guess
for command in $commands; do
	check "$command --help" calibrate "$command" --help
	equal "$command --version" "$(calibrate --version)" "$(calibrate "$command" --version)"
	wrong "$command with an unknown option" "--no-such-thing" "$command" --no-such-thing
done

equal "an option without its value is said by the program" \
	"inlay-calibrate: board: --board has no value" \
	"$(calibrate board --board 2>&1 | head -n 1)"

# ---- files of OpenCV and ROS ----
cat >"$work/camera.ini" <<'END'
[camera]
width = 640
height = 480
rotation = 1 0 0 0 -1 0 0 0 -1
translation = 0 0 3
focal = 8.4
kappa1 = -0.004
distortion = distorts
centre = 321.5 236.25
pixel = 0.0132 0.0121
aspect = 1.07
END
sed 's/= distorts/= undistorts/; s/-0.004/0.004/' "$work/camera.ini" >"$work/tsai.ini"
cat >"$work/fisheye.ini" <<'END'
[fisheye]
focal = 230 221
centre = 361 290
model = equisolid
END
wrong "convert without files" "expected two files" convert
wrong "an ending that says nothing" "expected .ini, .yml, .yaml or --as" convert "$work/camera.ini" \
	"$work/out.txt"
wrong "both ours" "files of the same kind" convert "$work/camera.ini" "$work/out.ini"
wrong "a kind that is none" "opencv" convert "$work/camera.ini" "$work/out" --as matlab
absent "and nothing was written" "$work/out"
for ending in yml yaml; do
	check "a camera to .$ending" calibrate convert "$work/camera.ini" "$work/camera.$ending"
	check "and back" calibrate convert "$work/camera.$ending" "$work/back-$ending.ini"
	check "a camera that undistorts to .$ending" calibrate convert "$work/tsai.ini" \
		"$work/tsai.$ending"
	check "and back" calibrate convert "$work/tsai.$ending" "$work/back-tsai-$ending.ini"
	check "a fisheye to .$ending" calibrate convert "$work/fisheye.ini" \
		"$work/fisheye.$ending" --size 720x576
	check "and back" calibrate convert "$work/fisheye.$ending" "$work/back-eye-$ending.ini"
done
same "both ways a camera is the same" <(grep -v '^;' "$work/back-yml.ini") \
	<(grep -v '^;' "$work/back-yaml.ini")
check "OpenCV's says so" grep -q '^%YAML:1.0$' "$work/camera.yml"
check "ROS's says so" grep -q '^distortion_model: plumb_bob$' "$work/camera.yaml"
check "of a fisheye too" grep -q '^distortion_model: equidistant$' "$work/fisheye.yaml"
check "the direction of the distortion comes back" grep -q '^distortion = undistorts$' \
	"$work/back-tsai-yml.ini"
check "what was fitted says so" grep -q '^# Fitted: .* at most [0-9.e-]* px' "$work/tsai.yml"
{
	cat "$work/camera.ini"
	printf 'kappa2 = 7e-5\ntangential = 1e-4 -2e-4\n'
} >"$work/terms.ini"
check "a camera of more terms" calibrate convert "$work/terms.ini" "$work/terms.yaml"
check "and back" calibrate convert "$work/terms.yaml" "$work/terms-back.ini"
check "has its second term" grep -q '^kappa2 = ' "$work/terms-back.ini"
check "and its tangential ones" grep -q '^tangential = ' "$work/terms-back.ini"
sed 's/^kappa2 = .*/kappa2 = -7e-4/' "$work/terms.ini" >"$work/folds.ini"
failed_with "a lens that folds over" "fold the picture over" convert "$work/folds.ini" "$work/none.yml"
printf 'kappa4 = 1\n' | cat "$work/camera.ini" - >"$work/kappa4.ini"
failed_with "a term that is none" "kappa4.ini:12: " convert "$work/kappa4.ini" "$work/none.yml"
printf 'tangential = 1e-4\n' | cat "$work/camera.ini" - >"$work/half.ini"
failed_with "one tangential term" "half.ini:12: " convert "$work/half.ini" "$work/none.yml"
cat >"$work/chain.yaml" <<'END'
cam0:
  camera_model: pinhole
  intrinsics: [600.0, 601.0, 319.5, 239.5]
  distortion_model: radtan
  distortion_coeffs: [-0.1, 0.0, 0.0, 0.0]
  resolution: [640, 480]
cam1:
  camera_model: pinhole
  intrinsics: [400.0, 400.0, 319.5, 239.5]
  distortion_model: equidistant
  distortion_coeffs: [0.003, -0.001, 0.0, 0.0]
  resolution: [640, 480]
END
failed_with "a chain of cameras" "one of them by --camera" convert "$work/chain.yaml" "$work/none.ini"
check "the first of Kalibr's cameras" calibrate convert "$work/chain.yaml" "$work/chain.ini" --camera cam0
check "is a camera" grep -q '^kappa1 = ' "$work/chain.ini"
check "the second" calibrate convert "$work/chain.yaml" "$work/chain.ini" --camera cam1
check "is a fisheye" grep -q '^polynomial = ' "$work/chain.ini"
failed_with "a fisheye without its size" "expected --size" convert "$work/fisheye.ini" \
	"$work/none.yml"
failed_with "more than may be off" "--tolerance" convert "$work/tsai.ini" "$work/none.yml" \
	--tolerance 0
failed_with "a file that is not there" "$work/nothing.yml: No such file" convert \
	"$work/nothing.yml" "$work/none.ini"
failed_with "a file without end" "/dev/zero: not a regular file but a device, expected one to read" convert \
	/dev/zero "$work/none.ini"
{
	printf '\xef\xbb\xbf'
	cat "$work/camera.yml"
} >"$work/marked.yml"
check "a byte order mark does not matter" calibrate convert "$work/marked.yml" "$work/marked.ini"
same "it is the same camera" <(grep -v '^;' "$work/back-yml.ini") <(grep -v '^;' "$work/marked.ini")
head -c 200 "$work/camera.yml" >"$work/cut.yml"
failed_with "a file that ends too soon" "$work/cut.yml:" convert "$work/cut.yml" "$work/none.ini"
absent "and nothing was written" "$work/none"

# ---- inlay-bake reads what comes back ----
bakes() { # CAMERA: bakes the box through it, small; what camera that was is in $work/baked
	sed "s|^position = .*|file = $1|; /^look_at/d; /^field_deg/d; /^width/d; /^height/d" \
		"$work/box.scene" >"$work/back.scene"
	"$INLAY_BAKE" render --quiet --size 48x36 --frequency 1 --samples 2 -o "$work/back.inlay" \
		"$work/back.scene" && "$INLAY_BAKE" info "$work/back.inlay" >"$work/baked"
}
for direction in distorts undistorts; do
	file=back-yml.ini
	[ $direction = distorts ] || file=back-tsai-yml.ini
	# the lens comes back from these files, and nothing of where the camera is
	sed -i '/^rotation/d; /^translation/d' "$work/$file"
	grep -E '^(rotation|translation)' "$work/camera.ini" >>"$work/$file"
	check "inlay-bake reads a camera that $direction and was converted" bakes "$file"
	check "and bakes with its distortion" grep -q "^distortion = $direction$" "$work/baked"
done

# ---- a camera from points ----
# points TILT LAYERS: a grid of 9 x 7 in each of the layers, 0.1 apart, seen from 1.4 away by f = 800 px
# with noise of 0.06 px; tilted by so many degrees.
points() {
	awk -v tilt="$1" -v layers="$2" 'BEGIN {
		s = sin(tilt * 3.14159265358979 / 180)
		c = cos(tilt * 3.14159265358979 / 180)
		seed = 7
		for (k = 0; k < layers; k++)
			for (j = -3; j <= 3; j++)
				for (i = -4; i <= 4; i++) {
					x = i / 10
					y = j / 10
					z = k / 10
					away = s * y - c * z + 1.4
					noise_x = (seed = seed * 16807 % 2147483647) / 2147483647 - 0.5
					noise_y = (seed = seed * 16807 % 2147483647) / 2147483647 - 0.5
					printf "%g %g %g %.4f %.4f\n", x, y, z,
						320 + 800 * x / away + 0.2 * noise_x,
						240 + 800 * (-c * y - s * z) / away + 0.2 * noise_y
				}
	}'
}
key() { # FILE KEY: its value
	sed -n "s/^$2 = //p" "$1"
}
if has_command camera; then
	points 45 3 >"$work/box.points"
	points 0 1 >"$work/parallel.points"
	points 35 1 >"$work/tilted.points"
	wrong "camera without points" "expected --points, --images or --live" camera --size 640x480 \
		-o "$work/none.ini"
	failed_with "points that are not there" "$work/nothing: No such file" camera \
		--points "$work/nothing" --size 640x480 -o "$work/none.ini"
	sed '3s/.*/1 2 three 4 5/' "$work/box.points" >"$work/bad.points"
	failed_with "a point that is none" "$work/bad.points:3: expected five finite numbers" camera \
		--points "$work/bad.points" --size 640x480 -o "$work/none.ini"
	absent "and nothing was written" "$work/none"

	cp "$work/box.points" "$work/own.points"
	wrong "views of points" "--views goes with --live" camera --points "$work/box.points" --size 640x480 \
		--views 3 -o "$work/none.ini"
	wrong "points that would be written over" "expected another one" camera \
		--points "$work/own.points" --size 640x480 -o "$work/own.points"
	same "and are not" "$work/box.points" "$work/own.points"
	mkdir "$work/folder"
	failed_with "an output that is a folder" "it is a folder" camera --points "$work/box.points" \
		--size 640x480 -o "$work/folder"
	failed_with "a disk that is full" "cannot be written" camera --points "$work/box.points" \
		--size 640x480 -o /dev/full
	failed_with "photographs that are not there" "no such photograph" camera \
		--images "$work/nothing*.jpg" --board 9x6:25mm -o "$work/none.ini"
	wrong "a centre that the lens's file says" "--centre-deviation" camera \
		--points "$work/box.points" --intrinsics "$work/camera.ini" --centre-deviation 3 \
		-o "$work/none.ini"
	wrong "radial terms that the lens's file says" "--radial" camera \
		--points "$work/box.points" --intrinsics "$work/camera.ini" --radial 2 -o "$work/none.ini"
	wrong "four radial terms" "--radial" camera --points "$work/box.points" --size 640x480 --radial 4 \
		-o "$work/none.ini"
	wrong "pixels that the lens's file says" "--aspect" camera --points "$work/box.points" \
		--intrinsics "$work/camera.ini" --aspect 1 -o "$work/none.ini"
	failed_with "one board does not tell whether pixels are square" "give --aspect 1 if they are" \
		camera --points "$work/tilted.points" --size 640x480 --centre-deviation 0 \
		--aspect-deviation 0.05 -o "$work/none.ini"
	check "unless that is said" calibrate camera --points "$work/tilted.points" --size 640x480 \
		--centre-deviation 0 --aspect 1 -o "$work/square.ini"
	check "or is to be assumed, as it is" calibrate camera --points "$work/tilted.points" \
		--size 640x480 --centre-deviation 0 -o "$work/square.ini"
	failed_with "the same points twice" "own.points: shows just what" camera \
		--points "$work/box.points" "$work/own.points" --size 640x480 -o "$work/none.ini"
	check "a camera from points" calibrate camera --points "$work/box.points" --size 640x480 \
		--report "$work/report" -o "$work/found.ini"
	check "its focal length is the true one" awk -v f="$(key "$work/found.ini" focal)" \
		'BEGIN { exit !(f > 797 && f < 803) }'
	check "inlay-bake reads it" bakes found.ini
	check "its report is a page" grep -q '</html>' "$work/report/report.html"
	check "with pictures" test "$(find "$work/report" -name '*.png' | wc -l)" -ge 2
	check "and JSON" is_json "$work/report/calibration.json"
	check "which says that it is trusted" grep -q '"trusted": true' \
		"$work/report/calibration.json"
	check "a report takes the place of an earlier one" calibrate camera \
		--points "$work/box.points" --size 640x480 --report "$work/report" -o "$work/found.ini"
	equal "and nothing is left beside it" "" "$(find "$work" -maxdepth 1 -name 'report.*')"

	failed_with "a board that is parallel to the picture" "tilt it by 30 degrees or more" camera \
		--points "$work/parallel.points" --size 640x480 --report "$work/doubt" \
		-o "$work/none.ini"
	absent "is not written" "$work/none"
	check "but reported" grep -q 'Not trusted.*tilt it by 30 degrees' \
		<(tr -d '\n' <"$work/doubt/report.html")
	check "in JSON too" is_json "$work/doubt/calibration.json"
	failed_with "--force does not make it trusted" "tilt it by 30 degrees or more" camera \
		--points "$work/parallel.points" --size 640x480 --force -o "$work/forced.ini"
	check "but writes it" grep -q '^focal = ' "$work/forced.ini"

	# A lens that comes from elsewhere, and where the camera is now.
	check "the lens, by way of OpenCV's file" calibrate convert "$work/found.ini" "$work/lens.yml"
	check "back" calibrate convert "$work/lens.yml" "$work/lens.ini"
	check "where it is, that lens given" calibrate camera --points "$work/tilted.points" \
		--intrinsics "$work/lens.ini" -o "$work/pose.ini"
	check "is right" awk -v t="$(key "$work/pose.ini" translation)" \
		'BEGIN { split(t, a, " "); exit !(a[3] > 1.39 && a[3] < 1.41) }'
fi

# ---- a fisheye from its image circle ----
# What an equidistant lens of 180 x 176 px/rad shows of an even sky, each pixel the mean of 4 x 4 places.
circle() {
	python3 -c '
import struct, sys
out = sys.stdout.buffer
out.write(b"PF\n720 576\n-1\n")
for y in reversed(range(576)):
    for x in range(720):
        sky = sum(((x + (k % 4 + 0.5) / 4 - 361) / 282.743) ** 2 + ((y + (k // 4 + 0.5) / 4 - 290) / 276.460) ** 2 < 1
                  for k in range(16)) if abs(((x - 361) / 282.7) ** 2 + ((y - 290) / 276.5) ** 2 - 1) < 0.05 \
            else 16 * (((x - 361) / 282.7) ** 2 + ((y - 290) / 276.5) ** 2 < 1)
        out.write(struct.pack("<3f", *3 * [sky / 32]))'
}
if has_command fisheye; then
	circle >"$work/circle.pfm"
	check "a fisheye from its circle" calibrate fisheye --circle "$work/circle.pfm" --rotation 0,0,0 \
		--report "$work/eye-report" -o "$work/eye.ini"
	check "is where it is" awk '/^centre = / { exit !($3 > 360.95 && $3 < 361.05 && $4 > 289.95 && $4 < 290.05) }' "$work/eye.ini"
	check "a page" grep -q '<title>Calibration of the fisheye</title>' "$work/eye-report/report.html"
	check "and JSON" is_json "$work/eye-report/calibration.json"
	failed_with "how it is turned has to be said" "give --rotation 0,0,0" fisheye --circle "$work/circle.pfm" \
		-o "$work/none.ini"
	absent "and nothing was written" "$work/none"
	sed 's|^\[fisheye\]$|&\nlens = eye.ini|' "$work/studio.conf" >"$work/eye.conf"
	check "the kiosk reads it" "$INLAY" check --config "$work/eye.conf"
	check "by way of OpenCV's file, too" calibrate convert "$work/eye.ini" "$work/eye.yml" \
		--size 720x576
	check "and back" calibrate convert "$work/eye.yml" "$work/eye-again.ini"
	same "it is the same lens" <(grep -E '^(focal|centre|model)' "$work/eye.ini") \
		<(grep -E '^(focal|centre|model)' "$work/eye-again.ini")
fi

# ---- a fisheye from photographs, from a live camera ----
photographs=$(dirname "$INLAY")/tests/cli/tools/photographs
# near FILE KEY X Y MOST: both numbers of the key within so many pixels
near() {
	key "$1" "$2" | awk -v x="$3" -v y="$4" -v most="$5" \
		'{ exit !($1 > x - most && $1 < x + most && $2 > y - most && $2 < y + most) }'
}
if has_command fisheye && [ -x "$photographs" ]; then
	"$photographs" "$work" >"$work/stdout"
	check "a fisheye from photographs of a board" calibrate fisheye --images "$work/eye?.png" \
		--board 9x6:20mm --field 88 --world eye1.png --report "$work/photo-report" \
		-o "$work/photo.ini"
	# drawn with the board over the lens, tilted by up to 20 degrees
	check "that looks up at the board" near "$work/photo.ini" rotation 0 0 30
	failed_with "that nobody turned" "--world" fisheye --images "$work/eye?.png" \
		--board 9x6:20mm --field 88 -o "$work/none.ini"
	check "that is known to lie on its back" calibrate fisheye --images "$work/eye?.png" \
		--board 9x6:20mm --field 88 --rotation 1,2,3 -o "$work/back.ini"
	check "is written so" grep -q '^rotation = 1 2 3$' "$work/back.ini"
	wrong "how it is turned, twice" "--rotation goes with" fisheye --images "$work/eye?.png" \
		--board 9x6:20mm --rotation 1,2,3 --world 1 -o "$work/none.ini"
	# A photograph without a board keeps its number, and is no world.
	mkdir "$work/gap"
	for n in 1 2 3 4 5 6 7 8; do
		ln -s "$work/eye$n.png" "$work/gap/eye$((n + (n > 1))).png"
	done
	cp "$work/dark.png" "$work/gap/eye2.png"
	calibrate fisheye --images "$work/gap/eye?.png" --board 9x6:20mm --field 88 --world 2 \
		-o "$work/none.ini" >"$work/stdout" 2>"$work/stderr"
	equal "a world without a board" 1 $?
	check "is refused by its name" grep -q 'eye2.png: is to show where the world is, but' \
		"$work/stderr"
	calibrate fisheye --images "$work/gap/eye?.png" --board 9x6:20mm --field 88 --world 10 \
		-o "$work/none.ini" >"$work/stdout" 2>"$work/stderr"
	check "a number beyond all photographs" grep -q 'its number of 1 to 9' "$work/stderr"
	calibrate camera --images "$work/gap/eye[2-9].png" --board 9x6:20mm -o "$work/none.ini" \
		>"$work/stdout" 2>"$work/stderr"
	equal "a camera whose first photograph shows no board" 1 $?
	check "has no world" grep -q 'eye2.png: is to show where the world is.*--reference' \
		"$work/stderr"
	absent "and nothing was written" "$work/none.ini"
	# A photograph that was cut off on its way is left out.
	head -c 3000 "$work/eye1.png" >"$work/gap/eye2.png"
	calibrate fisheye --images "$work/gap/eye?.png" --board 9x6:20mm --field 88 --world eye1.png \
		-o "$work/gap.ini" >"$work/stdout" 2>"$work/stderr"
	equal "a photograph that is cut off" 0 $?
	check "is skipped with a line" grep -q 'eye2.png: damaged PNG' "$work/stderr"
	check "is of the model that it is" grep -q '^model = equidistant$' "$work/photo.ini"
	check "of its focal lengths" near "$work/photo.ini" focal 220 211 0.1
	check "and its centre" near "$work/photo.ini" centre 483.2 357.4 0.1
	check "a page" grep -q '</html>' "$work/photo-report/report.html"
	# each place for two pictures, half a second apart
	for n in $(seq 18); do
		ln -s "eye$(((n + 1) / 2)).png" "$work/$(printf 'held%03d.png' "$n")"
	done
	cat >"$work/held.conf" <<-END
		[camera eye]
		driver = sim
		rate = 2
		sim.source = files
		sim.file = held%03d.png
		sim.clock = frames
		[fisheye]
		camera = eye
		[background]
		camera = eye
		[screen]
		driver = file
		device = held.png
	END
	check "a fisheye from a live camera" calibrate fisheye --live "$work/held.conf" \
		--board 9x6:20mm --views 9 --field 88 --model equidistant --world 1 \
		-o "$work/held.ini" 2>"$work/stderr"
	check "is the same" near "$work/held.ini" focal 220 211 0.1
	check "around the same centre" near "$work/held.ini" centre 483.2 357.4 0.1
fi

# ---- light ----
if has_command light; then
	awk 'BEGIN {
		for (i = 0; i < 12; i++) {
			r = 0.1 + 0.07 * (i * 5 % 12)
			g = 0.1 + 0.06 * (i * 7 % 11)
			b = 0.1 + 0.08 * (i * 3 % 10)
			print r, g, b, 0.9 * r + 0.05 * g, 0.02 * r + 1.1 * g, 0.1 * g + 0.8 * b
		}
	}' >"$work/patches"
	wrong "light of nothing" "light: expected one of black" light
	"$INLAY" grab fisheye --config "$work/studio.conf" -o "$work/grabbed.png" 2>"$work/stderr"
	failed_with "pictures that say no times" "says no exposure time (EXIF), expected --times" light \
		response "$work/grabbed.png" "$work/grabbed.png" -o "$work/none.ini"
	printf '2 0.75 0.25 0\n2 0.75 0.25 0\n2 0.75 0.25 0\n' >"$work/camera.rsp"
	check "the curve of another program" calibrate light response "$work/camera.rsp" -o "$work/rsp.ini"
	check "is the response" grep -q '^response = 0 0.00' "$work/rsp.ini"
	wrong "a merged picture without a name" "expected -o FILE.hdr" light merge "$work/lit.png" \
		"$work/lit.png" -o "$work/none.png"
	if command -v python3 >/dev/null; then
		bracket=$(dirname "$0")/tools/bracket.py
		mkdir "$work/bracket"
		python3 "$bracket" write "$work/bracket"
		check "a bracket merges by the times that its pictures say" calibrate light merge \
			"$work"/bracket/a?.jpg -o "$work/merged.pfm"
		off=$(python3 "$bracket" compare "$work/merged.pfm")
		check "to 2 % of its light, ISO and f-number included" awk "BEGIN { exit !($off < 0.02) }"
		check "in any order" calibrate light merge "$work"/bracket/a{3,1,5,2,4}.jpg -o "$work/any.pfm"
		python3 "$bracket" compare "$work/any.pfm" >"$work/any"
		equal "it is the same" "$off" "$(cat "$work/any")"
		check "as .hdr, too" calibrate light merge "$work"/bracket/a?.jpg -o "$work/merged.hdr"
		equal "which begins as one" "#?RADIANCE" "$(head -n 1 "$work/merged.hdr")"
		check "--times instead of what they say" calibrate light merge "$work"/bracket/a?.jpg \
			--times 1,1,1,1,1 -o "$work/wrong.pfm"
		off=$(python3 "$bracket" compare "$work/wrong.pfm")
		check "is believed" awk "BEGIN { exit !($off > 0.5) }"
		failed_with "one picture that says no time" "bare.jpg: says no exposure time (EXIF), expected --times" \
			light merge "$work/bracket/a1.jpg" "$work/bracket/bare.jpg" -o "$work/none.pfm"
		absent "and nothing was written" "$work/none.pfm"
		check "light that is clipped in all of them" calibrate light merge "$work"/bracket/a{1,2}.jpg \
			-o "$work/clipped.pfm"
		calibrate light merge "$work"/bracket/a{1,2}.jpg -o "$work/clipped.pfm" 2>"$work/stderr"
		check "is said" grep -q '% of the values are clipped in all exposures' "$work/stderr"
		wrong "a time too few" "as many of each" light merge "$work"/bracket/a{1,2,3}.jpg --times 4,1 \
			-o "$work/none.pfm"
	fi
	echo "; nothing" >"$work/nothing.ini"
	failed_with "a lens file without a fisheye" "nothing.ini: expected a [fisheye] section" light gain \
		--lens "$work/nothing.ini" --patch 0,0,8,8 "$work/lit.png" "$work/lit.png" -o "$work/none.ini"
	failed_with "a file of patches that is not there" "$work/nothing" light colours "$work/nothing" \
		-o "$work/none.ini"
	absent "and nothing was written" "$work/none"
	check "colours of two cameras" calibrate light colours "$work/patches" \
		--report "$work/light-report" -o "$work/light.ini"
	check "a page" grep -q '</html>' "$work/light-report/report.html"
	check "and JSON" is_json "$work/light-report/light.json"
	sed 's|^\[fisheye\]$|&\nlight = light.ini|' "$work/studio.conf" >"$work/lit.conf"
	check "the kiosk reads it" "$INLAY" check --config "$work/lit.conf"
fi

# ---- boards ----
# seen_live COMMAND: one place, and then the verdict that one is not enough.
seen_live() {
	! calibrate "$1" --live "$work/live.conf" --views 1 --board 9x6:25mm -o "$work/none.ini" \
		2>"$work/stderr" >"$work/stdout" &&
		[ "$(grep -c '' "$work/stderr")" -eq 2 ] &&
		grep -q "place 1 of 1: 54 points" "$work/stderr" && [ ! -e "$work/none.ini" ]
}
if has_command board; then
	check "a board to print" calibrate board -o "$work/board.pdf"
	check "is a PDF" grep -aq '^%PDF-' "$work/board.pdf"
	failed_with "a board that the page does not hold" "at most 25" board --board 9x6:60mm \
		-o "$work/none.pdf"
	wrong "a board that is none" "expected a board such as" board --board 9by6 -o "$work/none.pdf"
	wrong "a page that is none" "expected a4, a3 or letter" board --page a5 -o "$work/none.pdf"
	# a disk that is full, played by a limit on the size of files
	cramped() (
		trap '' XFSZ
		ulimit -f 1
		calibrate board -o "$work/none.pdf" 2>&1
	)
	equal "a disk that is full is said" "inlay-calibrate: $work/none.pdf: cannot be written: File too large" \
		"$(cramped)"
	absent "and nothing was written" "$work/none"
	if command -v pdftoppm >/dev/null; then
		# What is printed is found again, square to the view: that alone is no camera.
		calibrate board --board 9x6:25mm -o "$work/chess.pdf"
		pdftoppm -r 80 -png -singlefile "$work/chess.pdf" "$work/chess"
		failed_with "what is printed is found" "tilt it by 30 degrees or more" camera \
			--images "$work/chess.png" --board 9x6:25mm -o "$work/none.ini"
		failed_with "another board is not found in it" "$work/chess.png" camera \
			--images "$work/chess.png" --board 5x4:25mm -o "$work/none.ini"
		# Markers that others print, with the squares of an earlier OpenCV.
		check "a board of other markers" calibrate board \
			--board charuco:8x6:30mm:22mm:DICT_6X6_250:legacy -o "$work/markers.pdf"
		pdftoppm -r 80 -png -singlefile "$work/markers.pdf" "$work/markers"
		failed_with "names its markers" "names its own if they are not 5x5" camera \
			--images "$work/markers.png" --board charuco:8x6:30mm:22mm -o "$work/none.ini"
		failed_with "is found by its name" "tilt it by 30 degrees or more" camera --images "$work/markers.png" \
			--board charuco:8x6:30mm:22mm:6x6:legacy -o "$work/none.ini"
		# Held before the cameras of a kiosk, whose screen shows that it was seen.
		cat >"$work/live.conf" <<-END
			[camera eye]
			driver = sim
			rate = 2
			sim.source = files
			sim.file = chess.png
			sim.clock = frames
			[fisheye]
			camera = eye
			[background]
			camera = eye
			[screen]
			driver = file
			device = live.png
		END
		for command in camera fisheye; do
			rm -f "$work/live.png"
			check "seen live by the $command" seen_live "$command"
			check "and shown" test -s "$work/live.png"
		done
		wrong "live without a board" "--board is missing" fisheye --live "$work/live.conf" \
			-o "$work/none.ini"
		failed_with "a configuration that is not there" "$work/nothing.conf" fisheye \
			--live "$work/nothing.conf" --board 9x6:25mm -o "$work/none.ini"
	fi
fi

# ---- the sky, watched by the studio's fisheye ----
if has_command sky; then
	# valid_list FILE: inlay-bake takes it.
	valid_list() {
		"$INLAY_BAKE" dome --frequency 9 --fine "$1" --angles >"$work/angles" && [ "$(wc -l <"$work/angles")" -gt 410 ]
	}
	sed 's/^width = 96/width = 240/; s/^height = 96/height = 240\nrate = 1/' "$work/studio.conf" >"$work/sky.conf"
	check "a short watch" calibrate sky --live "$work/sky.conf" --watch 10s -o "$work/short.fine"
	check "finds the studio's lamps" valid_list "$work/short.fine"
	equal "and says how long it was" "watched for 10 s" "$(grep -o 'watched for [0-9a-z ]*' "$work/short.fine")"
	check "a longer watch" calibrate sky --live "$work/sky.conf" --watch 90s -o "$work/long.fine"
	check "finds more, as they move" [ "$(wc -l <"$work/long.fine")" -gt "$(wc -l <"$work/short.fine")" ]
	# files that may have no byte are as good as a full disk
	full=$(
		trap '' XFSZ
		ulimit -f 0
		"$INLAY_CALIBRATE" sky --live "$work/sky.conf" --watch 30s -o "$work/full.fine" 2>&1
	)
	check "a list that cannot be written does not end the watch" grep -q 'tried again in 10 minutes' <<<"$full"
	absent "and is not written in parts" "$work/full.fine"
	failed_with "a camera that is not there" "camera fisheye" sky --live <(sed \
		's/^sim.view = fisheye/sim.source = files\nsim.file = none.png/' "$work/sky.conf") -o "$work/none.fine"
	absent "leaves no list" "$work/none.fine"
	for signal in TERM KILL; do
		"$INLAY_CALIBRATE" sky --live "$work/sky.conf" --watch 10000h -o "$work/$signal.fine" 2>"$work/$signal.log" &
		watcher=$!
		check "a watch that SIG$signal ends has written before" until_true test -s "$work/$signal.fine"
		kill -$signal $watcher
		wait $watcher 2>/dev/null
		is=$?
		equal "its exit code" "$([ $signal = TERM ] && echo 0 || echo 137)" $is
		check "and leaves a valid list" valid_list "$work/$signal.fine"
	done
	wrong "sky without a camera" "--live is missing" sky -o "$work/none.fine"
	wrong "sky without an output" "-o FINE is missing" sky --live "$work/sky.conf"
	wrong "a time without a unit" 'is "24", expected a time' sky --live "$work/sky.conf" --watch 24 -o "$work/none.fine"
	wrong "no time" 'is "0h", expected a time' sky --live "$work/sky.conf" --watch 0h -o "$work/none.fine"
	failed_with "a list over the configuration" "sky.conf" sky --live "$work/sky.conf" -o "$work/sky.conf"
fi

# ---- lamps, by a traced fisheye on three places ----
if has_command lamps; then
	places=(0,0,0 1,0,0 0.1,0.9,0.1)
	for k in 0 1 2; do
		for ending in pfm png; do
			check "the truth's fisheye at ${places[k]} in .$ending" "$INLAY_BAKE" truth "$work/box.scene" \
				--lamp 1.1,0.4,2.2,0.06,40,40,40 --lamp=-0.8,1.2,1.7,0.04,60,50,40 \
				--samples 1 --size 8x8 --quiet --fisheye "${places[k]}" --fisheye-size 300 \
				--fisheye-out "$work/eye$k.$ending" -o "$work/none.pfm"
		done
	done
	printf '[fisheye]\nmodel = equidistant\n' >"$work/up.ini"
	pictures=(--lens "$work/up.ini" --picture "$work/eye0.png" --picture "$work/eye1.png" --picture "$work/eye2.png")
	at=(--at 0,0,0 --at 1,0,0 --at 0.1,0.9,0.1)
	# near FILE SECTION X Y Z RADIUS: within 2 cm, and the radius within 5 mm, or larger where light is clipped
	near() {
		"$INLAY" check --config <(printf '[basis]\nfile = x\n' | cat - "$1") --print-config 2>/dev/null |
			awk -v section="[$2]" -v x="$3" -v y="$4" -v z="$5" -v r="$6" '
			/^\[/ { in_it = $0 == section }
			in_it && $1 == "position" { off = sqrt(($3 - x) ^ 2 + ($4 - y) ^ 2 + ($5 - z) ^ 2); n++ }
			in_it && $1 == "radius" { n += $3 > r - 0.005 && $3 < r + 0.015 }
			END { exit !(n == 2 && off < 0.02) }'
	}
	check "lamps from pictures of 8 bits" calibrate lamps "${pictures[@]}" "${at[@]}" -o "$work/lamps.ini" \
		--report "$work/lamps"
	check "the one with more light is at its place" near "$work/lamps.ini" "lamp lamp1" 1.1 0.4 2.2 0.06
	check "so is the other" near "$work/lamps.ini" "lamp lamp2" -0.8 1.2 1.7 0.04
	check "the report is for programs, too" is_json "$work/lamps/calibration.json"
	check "lamps from linear light" calibrate lamps "${pictures[@]//png/pfm}" "${at[@]}" -o "$work/linear.ini"
	check "are at the same place" near "$work/linear.ini" "lamp lamp1" 1.1 0.4 2.2 0.06
	failed_with "places that are told in another order" "" lamps "${pictures[@]}" --at 1,0,0 --at 0,0,0 \
		--at 0.1,0.9,0.1 -o "$work/wrong.ini"
	absent "are written nowhere" "$work/wrong.ini"
	failed_with "two places with much doubt" "shows no parallax" lamps "${pictures[@]:0:6}" --at 0,0,0 --at 1,0,0 \
		--turn-deviation 5 -o "$work/wrong.ini"
	wrong "one place" "from one nobody can tell" lamps "${pictures[@]:0:4}" --at 0,0,0 -o "$work/wrong.ini"
	wrong "the same place twice" "expected another place" lamps "${pictures[@]:0:6}" --at 0,0,0 --at 0,0.01,0 \
		-o "$work/wrong.ini"
	wrong "fewer pictures than places" "expected one for each of 3" lamps "${pictures[@]:0:6}" "${at[@]}" -o "$work/wrong.ini"
	wrong "a place that is none" "--at: \"0,0\"" lamps "${pictures[@]:0:6}" --at 0,0 --at 1,0,0 -o "$work/wrong.ini"
	wrong "pictures without a lens" "--lens is missing" lamps "${pictures[@]:2}" "${at[@]}" -o "$work/wrong.ini"
	wrong "neither pictures nor camera" "either --live or --picture" lamps "${at[@]}" -o "$work/wrong.ini"
	# The studio's camera stays where it is: its lights are as if infinitely far.
	sed 's/^width = 96/width = 240/; s/^height = 96/height = 240/' "$work/studio.conf" >"$work/stays.conf"
	check "a camera that stays shows nothing near" bash -c 'printf "\n\n" | "$1" lamps --live "$2" --at 0,0,0 \
		--at 1,0,0 -o "$3" 2>&1 | grep "no light is near\|shows no parallax"' - "$INLAY_CALIBRATE" \
		"$work/stays.conf" "$work/wrong.ini"
	check "a person who leaves ends it" grep -q "ended before the fisheye lay at 0,0,0" <(calibrate lamps \
		--live "$work/stays.conf" "${at[@]}" -o "$work/wrong.ini" 2>&1 </dev/null)
	absent "no file of all that" "$work/wrong.ini"
fi

finish
