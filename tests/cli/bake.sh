#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay-bake as a person calls it: what it prints, what it leaves, how it fails.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

bake=$INLAY_BAKE
out="$work/out.inlay"

# rejected NAME CODE WORDS COMMAND...: exits with CODE, says WORDS on stderr, nothing on stdout.
rejected() {
	local name=$1 code=$2 words=$3 said is
	shift 3
	said=$("$@" 2>"$work/stderr" </dev/null)
	is=$?
	if [ $is -ne "$code" ] || [ -n "$said" ] || ! grep -qF -- "$words" "$work/stderr"; then
		fail "$name" < <(printf '%s\n' "exit code $is, expected $code with \"$words\": $*" \
			"$said" "$(cat "$work/stderr")")
	else
		pass "$name"
	fi
}
scene() { # NAME, text on stdin after a camera
	{
		printf '[camera]\nposition = 0 -3 1.5\nwidth = 24\nheight = 16\n'
		printf '[dome]\nfrequency = 2\n[render]\nsamples = 2\n'
		cat
	} >"$work/$1.scene"
}

# ---- all commands ----
for command in dome render info truth sky; do
	check "$command --help" "$bake" $command --help
	check "$command --version" "$bake" $command --version
	rejected "$command with an unknown option" 2 "$command: unknown option --no-such-option" \
		"$bake" $command --no-such-option
done
check "--help" "$bake" --help
equal "--version" "inlay-bake" "$("$bake" --version | cut -d' ' -f1)"
rejected "no command" 2 "usage" "$bake"
rejected "an unknown command" 2 'no command "bakr"' "$bake" bakr

# ---- dome ----
for pair in "1 6" "2 26" "3 46" "4 86" "6 186" "9 406"; do
	equal "dome of frequency $pair" "${pair#* }" \
		"$("$bake" dome --frequency "${pair% *}" --angles | grep -c '^[0-9]')"
done
equal "solid angles sum to 2 pi" 6.283185307 "$("$bake" dome --frequency 5 |
	awk '!/^#/ { s += $4 } END { printf "%.9f", s }')"
equal "dome as JSON" 26 "$("$bake" dome --frequency 2 --json | grep -c theta_rad)"
rejected "dome without a frequency" 2 "--frequency is missing" "$bake" dome
rejected "dome in two forms" 2 "one of --angles and --json" "$bake" dome --frequency 2 --angles --json
rejected "dome frequency out of range" 2 "from 1 to 72" "$bake" dome --frequency 73
equal "angles of a dome that is finer in parts say so" "fine 2" \
	"$("$bake" dome --frequency 2 --fine "30 40 1 4" --angles | head -n 1)"
equal "solid angles of finer parts sum to 2 pi" 6.283185307 "$("$bake" dome --frequency 3 --fine "30 5 4 36" |
	awk '!/^#/ { s += $4 } END { printf "%.9f", s }')"
rejected "finer parts of no multiple" 1 "part 1: frequency is 5, expected a multiple of the dome's 2" \
	"$bake" dome --frequency 2 --fine "30 40 1 5"

# ---- sky ----
# panorama NAME PIXEL: an even sky of 64 x 32 pixels, whose pixel in row 10 and column 32, towards +X, is PIXEL thrice
panorama() {
	{
		printf 'PF\n64 32\n-1\n'
		for ((k = 0; k < 64 * 32; k++)); do
			# rows count from the bottom
			[ $k -eq $((21 * 64 + 32)) ] && printf '%b%b%b' "$2" "$2" "$2" || printf '\0\0\200?\0\0\200?\0\0\200?'
		done
	} >"$work/$1.pfm"
}
panorama even '\0\0\200?'
panorama lamp '\0\0zD'
equal "an even sky has no part, and says so" \
	"inlay-bake: $work/even.fine: no light is strong and small: a whole dome does" \
	"$("$bake" sky "$work/even.pfm" -o "$work/even.fine" 2>&1)"
equal "its list is a remark" "# $work/even.pfm: 406 lights, with frequency 9 elsewhere" "$(cat "$work/even.fine")"
equal "which is a list of no part" 406 "$("$bake" dome --frequency 9 --fine "$work/even.fine" --angles | wc -l)"
check "a lamp" "$bake" sky "$work/lamp.pfm" --turn 90 --most 600 -o "$work/lamp.fine"
check "is found where it is turned to" awk '!/^#/ && $1 > 80 && $1 < 95 && $2 > 26 && $2 < 36 { found = 1 }
	END { exit !found }' "$work/lamp.fine"
equal "with as many lights as the list says" "$(sed -n 's/^#.*: \([0-9]*\) lights.*/\1/p' "$work/lamp.fine")" \
	"$("$bake" dome --frequency 9 --fine "$work/lamp.fine" --angles | grep -c '^[0-9]')"
rejected "more lights than allowed" 1 "alone has 406 lights, more than 400" \
	"$bake" sky "$work/lamp.pfm" --most 400 -o "$work/none.fine"
rejected "sky without a panorama" 2 "expected one panorama" "$bake" sky -o "$work/none.fine"
rejected "sky without an output" 2 "-o FINE is missing" "$bake" sky "$work/lamp.pfm"
# The same lamp through a perfect fisheye: parts are in the same cells.
echo '[fisheye]' >"$work/eye.ini"
check "a fisheye sees it" "$bake" truth "$work/box.scene" --panorama "$work/lamp.pfm" --samples 1 \
	--fisheye-out "$work/eye.pfm" --fisheye-size 512 -o "$work/truth.png" --quiet
check "a lamp in a fisheye's picture" "$bake" sky "$work/eye.pfm" --fisheye "$work/eye.ini" --most 600 -o "$work/eye.fine"
check "is found where it is" awk '!/^#/ && $1 > -10 && $1 < 5 && $2 > 26 && $2 < 36 && $4 >= 18 { found = 1 }
	END { exit !found }' "$work/eye.fine"
# The studio in two exposures, in either order.
for exposure in 0.2 1; do
	"$INLAY" run --config "$work/studio.conf" --frames 1 --set screen.show=fisheye --set "screen.device=$work/at-$exposure.png" \
		--set camera.fisheye.sim.exposure=$exposure 2>/dev/null
done
check "a bracket" "$bake" sky "$work/at-1.png" "$work/at-0.2.png" --times 5,1 --fisheye "$work/eye.ini" -o "$work/a.fine"
if [ -n "${INLAY_THOROUGH:-}" ]; then # a list takes most of a second
	check "in the other order" "$bake" sky "$work/at-0.2.png" "$work/at-1.png" --times 1,5 --fisheye "$work/eye.ini" \
		-o "$work/b.fine"
	equal "gives the same parts" "$(grep -v '^#' "$work/a.fine")" "$(grep -v '^#' "$work/b.fine")"
fi
check "and there are some" grep -q '^[^#]' "$work/a.fine"
rejected "a bracket without times" 2 "as many --times as pictures" \
	"$bake" sky "$work/eye.pfm" "$work/eye.pfm" --fisheye "$work/eye.ini" -o "$work/none.fine"
rejected "a bracket of one time" 2 "each another one" "$bake" sky "$work/eye.pfm" "$work/eye.pfm" --times 2,2 \
	--fisheye "$work/eye.ini" -o "$work/none.fine"
rejected "a bracket of linear light" 1 "eye.pfm: is linear light" "$bake" sky "$work/eye.pfm" "$work/eye.pfm" \
	--times 2,1 --fisheye "$work/eye.ini" -o "$work/none.fine"
: >"$work/no.ini"
rejected "a lens that is none" 1 "expected a [fisheye] section" \
	"$bake" sky "$work/eye.pfm" --fisheye "$work/no.ini" -o "$work/none.fine"
rejected "times without a fisheye" 2 "go with --fisheye" "$bake" sky "$work/lamp.pfm" --times 1 -o "$work/none.fine"
# In midsummer at 50 degrees the noon sun is 63.4 degrees high.
check "the sun, with a panorama" "$bake" sky "$work/lamp.pfm" --sun 50 --north 90 --dates 06-21..06-21 \
	--hours 11.5..12.5 -o "$work/both.fine"
check "is in the south at noon, as high as it should be" awk '!/^#/ && $2 > 45 { n++; if ($1 > -120 && $1 < -60 &&
	$2 > 58 && $2 < 69) at++ } END { exit !(n > 0 && at == n) }' "$work/both.fine"
check "and the lamp is there" grep -qE '^[0-9.-]+ +[23][0-9.]+ ' "$work/both.fine"
rejected "the sun without north" 2 "--north is missing" "$bake" sky --sun 50 -o "$work/none.fine"
rejected "north without the sun" 2 "go with --sun" "$bake" sky "$work/lamp.pfm" --north 0 -o "$work/none.fine"
rejected "a date that is none" 2 'is "02-30..03-01"' "$bake" sky --sun 50 --north 0 --dates 02-30..03-01 -o "$work/none.fine"
rejected "hours that are none" 2 'is "8-17"' "$bake" sky --sun 50 --north 0 --hours 8-17 -o "$work/none.fine"
rejected "a sun that does not rise" 1 "below the horizon" \
	"$bake" sky --sun 80 --north 0 --dates 12-01..12-31 -o "$work/none.fine"

# ---- render ----
small=(--size 16x16 --samples 1)
check "render" "$bake" render "$work/box.scene" -o "$out" --threads 2
check "options after the scene" "$bake" render "$work/box.scene" -o "$work/again.inlay" --threads 1
same "the same file from another number of threads" "$out" "$work/again.inlay"
check "another seed" "$bake" render --seed 9 "$work/box.scene" -o "$work/again.inlay"
differ "gives another file" "$out" "$work/again.inlay"
equal "quiet says nothing" "" "$("$bake" render --quiet "$work/box.scene" -o "$out" 2>&1)"
cp "$out" "$work/plain.inlay"
check "noise" "$bake" render --noise 3 --size 40x30 --frequency 1 "$work/box.scene" \
	-o "$work/noise.inlay"
equal "is kept to" 1 "$("$bake" info --json "$work/noise.inlay" |
	grep -o '"noise_levels": [0-9.]*' | awk '{ print ($2 > 0 && $2 <= 3) }')"
equal "size and dome from the command line" '"width": 40, "height": 30, "lights": 6' \
	"$("$bake" info --json "$work/noise.inlay" | grep -o '"width.*lights": 6')"
check "an exact layer, over fewer coarse lights" "$bake" render "${small[@]}" --exact --coarse 1 --error 1,3 \
	--cell-error 4 --column-cut 0.002 "$work/box.scene" -o "$work/exact.inlay"
equal "the file says how it was encoded" "target_levels = rms 1, max 3, cell 4
column_cut = 0.002
coarse_lights = 6
exact = yes" "$("$bake" info "$work/exact.inlay" | grep -E '^(target_|column_|coarse_|exact = )')"
check "many lights" "$bake" render --size 8x8 --samples 1 --frequency 18 "$work/box.scene" \
	-o "$work/many.inlay"
equal "a cut that fits their number" "0.0010 0.0005" "$(for file in out many; do
	"$bake" info "$work/$file.inlay" | sed -n 's/^column_cut = //p'
done | awk '{ printf "%s%.4f", (NR > 1 ? " " : ""), $1 }')"
equal "most is twice RMS where nobody says" "target_levels = rms 0.25, max 0.5, cell 1.4" \
	"$("$bake" render "${small[@]}" --quiet --error 0.25 "$work/box.scene" -o "$work/fine.inlay" &&
		"$bake" info "$work/fine.inlay" | grep '^target_levels')"
rejected "an error that is none" 2 "--error" "$bake" render --error 0.5,no "$work/box.scene" \
	-o "$work/none.inlay"
rejected "an error of nothing" 2 "from 0.001 to 255" "$bake" render --error 0 "$work/box.scene" \
	-o "$work/none.inlay"
rejected "a cut beyond reason" 2 "from 0 to 0.1" "$bake" render --column-cut 1 \
	"$work/box.scene" -o "$work/none.inlay"
rejected "samples and noise together" 2 "exclude" "$bake" render --samples 2 --noise 2 \
	"$work/box.scene" -o "$work/none.inlay"
rejected "no output" 2 "-o OUT.inlay is missing" "$bake" render "$work/box.scene"
rejected "no scene" 2 "one scene file" "$bake" render -o "$work/none.inlay"
rejected "a size that is none" 2 "expected a size" "$bake" render --size 20 "$work/box.scene" \
	-o "$work/none.inlay"
rejected "no such scene" 1 "missing.scene" "$bake" render "$work/missing.scene" \
	-o "$work/none.inlay"
rejected "no such folder" 1 "no/none.inlay" "$bake" render "$work/box.scene" \
	-o "$work/no/none.inlay"

scene typo <<<$'[object a]\nfile = box.obj\nmateral = paint'
rejected "a misspelt key" 1 "typo.scene:11: [object a] materal" "$bake" render \
	"$work/typo.scene" -o "$work/none.inlay"
printf 'v 0 0 0\nv 1 0 0\n' >"$work/points.obj"
scene faceless <<<$'[object a]\nfile = points.obj'
rejected "a mesh without faces" 1 "points.obj" "$bake" render "$work/faceless.scene" \
	-o "$work/none.inlay"
scene untextured <<<$'[object a]\nfile = box.obj\nmaterial = m\n[material m]\ntexture = no.png'
rejected "a texture that is not there" 1 "no.png" "$bake" render "$work/untextured.scene" \
	-o "$work/none.inlay"

# cut_ply NAME WORDS, a PLY on stdin: refused in one line, and soon.
cut_ply() {
	cat >"$work/cut.ply"
	rejected "$1" 1 "$2" timeout 120 "$bake" render "$work/cut.scene" -o "$work/none.inlay"
	equal "$1: one line" 1 "$(grep -c '' "$work/stderr")"
}
scene cut <<<$'[object a]\nfile = cut.ply'
ply=$'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n'
ply+=$'element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n'
cut_ply "a PLY without its last face" "cut.ply: it ends in face 2" <<<"$ply"
cut_ply "a PLY with a face of nothing" "cut.ply:14: face 2" <<<"${ply}0"
cut_ply "a PLY with a face cut short" "cut.ply:14: face 2" <<<"${ply}3 0 1"
cut_ply "a PLY cut in its header" "cut.ply: no line end_header" <<<"${ply%end_header*}"
cut_ply "a PLY of billions" "cut.ply: it ends in vertex 5, expected 2000000000 of them" \
	<<<"${ply/vertex 3/vertex 2000000000}"
printf 'v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 1 2\n' >"$work/flat.obj"
scene flat <<<$'[object a]\nfile = flat.obj'
rejected "a mesh without area" 1 "flat.obj: its faces all have no area" "$bake" render \
	"$work/flat.scene" -o "$work/none.inlay"
scene frames <<<$'[object a]\nfile = box.obj\n[poses]\ncount = 3\n[keyframe b]\nobject = a\npose = 1\nfile = no.obj'
rejected "a keyframe's mesh that is not there" 1 '[keyframe b] file: cannot open' "$bake" render \
	--quiet "$work/frames.scene" -o "$work/none.inlay"
absent "failures leave no file" "$work/none.inlay"

scene behind <<<$'[object a]\nfile = box.obj\nposition = 0 -500 0'
rejected "an object out of sight is not baked" 3 "the camera sees no object" "$bake" render --quiet \
	"$work/behind.scene" -o "$work/behind.inlay"
absent "and leaves no file" "$work/behind.inlay"
scene glass <<<$'[object pane]\nfile = box.obj\nscale = 1.2\nmaterial = clear\nposition = 0 0 0.1\n[material clear]
kind = glass\n[object kernel]\nfile = box.obj\nscale = 0.1\n'
check "an object behind glass is seen" test -z "$("$bake" render --quiet --preview "$work/glass.scene" \
	-o "$work/glass.inlay" 2>&1 | grep 'nothing of it')"
scene places <<<$'[ground]\n[object sunk]\nfile = box.obj\nposition = 0 0 -0.6\n[object gone]\nfile = box.obj
position = 0 -500 0\n[object around]\nfile = box.obj\nscale = 40\nstand = yes\nposition = 0 0 -3\n'
said=$("$bake" render --preview "$work/places.scene" -o "$work/places.inlay" 2>&1)
for words in "[object gone]: nothing of it is seen" "[object around]: the camera is inside of it" \
	"[object sunk]: " "% of its height is below the ground"; do
	check "a strange place is remarked on: $words" grep -qF -- "$words" <<<"$said"
done
check "each object has a line" grep -qE '^sunk: [0-9.]+ x [0-9.]+ x [0-9.]+ world units, [0-9.]+ % of the picture, [0-9]+ % of' \
	<<<"$said"

# ---- a preview, alone and before the bake ----
is_preview() { # FILE
	"$bake" info "$1" | head -n 1 | grep -qF ": preview, 48 x 32, 26 lights" &&
		"$bake" info "$1" | grep -qx "preview = yes"
}
quick="$work/quick.inlay"
check "a preview" "$bake" render --preview "$work/box.scene" -o "$quick"
check "says that it is one" is_preview "$quick"
check "to programs too" grep -q '"preview": true' <("$bake" info --json "$quick")
equal "it declares its errors" 1 "$("$bake" info --json "$quick" |
	sed -E 's/.*"sky_rms": ([0-9.]+), "sky_max": ([0-9.]+).*/\1 \2/' | awk '{ print ($1 > 0 && $2 > $1) }')"
check "options go over it" "$bake" render --preview --size 16x16 --samples 6 --exact "$work/box.scene" -o "$work/over.inlay"
equal "and it keeps them" "samples = 6
exact = yes" "$("$bake" info "$work/over.inlay" | grep -E '^(samples|exact) =')"
check "a bake over a preview" "$bake" render "$work/box.scene" -o "$quick"
same "is the bake without one" "$quick" "$work/plain.inlay"
equal "a bake of its own leaves two lines" "quick.inlay: preview, rays
quick.inlay: rays" "$(rm "$quick" && "$bake" render "$work/box.scene" -o "$quick" |
	grep -oE '[a-z]+\.inlay: (preview, )?rays')"
equal "over a finished file it says that this stays" "quick.inlay: stays" \
	"$("$bake" render "$work/box.scene" -o "$quick" | grep -oE '[a-z]+\.inlay: stays')"
rejected "a preview and none" 2 "--preview and --no-preview exclude" "$bake" render --preview --no-preview \
	"$work/box.scene" -o "$work/none.inlay"
rejected "a preview of a shard" 2 "--preview and --shard exclude" "$bake" render --preview --shard 1/2 \
	"$work/box.scene" -o "$work/none.inlay"
runs() { # PID: it has become another program
	[ "$(readlink "/proc/$1/exe")" != "$(readlink "/proc/$$/exe")" ]
}
# interrupted SIGNAL FILE: a bake of minutes, ended by a signal as soon as anything stands at FILE.
interrupted() {
	local pid
	"$bake" render --quiet --samples 65536 "$work/box.scene" -o "$2" &
	pid=$!
	until_true runs "$pid" # until then it is this shell, which may swallow a signal
	until_true test -e "$2"
	kill "-$1" $pid
	wait $pid 2>/dev/null
	[ $? -gt 128 ]
}
check "a bake that is interrupted" interrupted TERM "$work/long.inlay"
check "leaves its preview" is_preview "$work/long.inlay"
check "one over a finished file" interrupted TERM "$quick"
same "leaves that" "$quick" "$work/plain.inlay"
equal "and nothing else" 2 "$(find "$work" -name 'long.*' -o -name 'quick.*' | grep -c '')"

# ---- more asked for than can be held ----
# missed NAME OUT WORDS COMMAND...: exits with 3, says WORDS in one line, and keeps OUT.
missed() {
	local name=$1 out=$2 words=$3 is
	shift 3
	"$@" >/dev/null 2>"$work/stderr" </dev/null
	is=$?
	if [ $is -ne 3 ] || [ "$(grep -c '' "$work/stderr")" -ne 1 ] || ! grep -qE -- "$words" "$work/stderr" ||
		! "$bake" info "$out" >/dev/null; then
		fail "$name" < <(printf '%s\n' "exit code $is, expected 3 with \"$words\"" "$(cat "$work/stderr")")
	else
		pass "$name"
	fi
}
tight=(render --size 16x16 --samples 1 --frequency 1 --error 0.001 --cell-error 255 "$work/box.scene")
missed "a bake that misses its errors" "$work/tight.inlay" \
	'1 tile misses .*pixels 0\.\.15 x 0\.\.15.* expected 0\.00[12]: .*--error.*the file is kept' \
	"$bake" "${tight[@]}" -o "$work/tight.inlay"
check "a shard of it" "$bake" "${tight[@]}" --shard 1/1 -o "$work/tight.shard"
missed "is missed by the merge" "$work/merged.inlay" '1 tile misses .*the file is kept' \
	"$bake" merge "$work/tight.shard" -o "$work/merged.inlay"
same "which is the same file" "$work/tight.inlay" "$work/merged.inlay"

# ---- info ----
check "info" "$bake" info "$out"
equal "info names blocks by kind" 2 "$("$bake" info "$out" | grep -c '^[TV] (')"
equal "the file holds no path" 0 "$(grep -acF "$work" "$out")"
equal "info says how much of the ground the box covers" "footprint: 0.6 x 0.6 world units of the ground" \
	"$("$bake" info "$out" | grep ^footprint)"
check "to programs too" grep -q '"footprint": \[0.600[0-9]*, 0.600[0-9]*\]' <("$bake" info --json "$out")
rejected "info of no basis file" 1 "box.obj" "$bake" info "$work/box.obj"
head -c 5000 "$out" >"$work/cut.inlay"
rejected "info of half a basis file" 1 "cut.inlay" "$bake" info "$work/cut.inlay"
if command -v python3 >/dev/null; then
	check "info --json is JSON" python3 -c 'import json, sys; json.loads(sys.argv[1])' \
		"$("$bake" info --json "$out")"
fi

# ---- truth ----
# A panorama of 8 x 4 texels: white above, grey below (PFM: little-endian, from the bottom up).
{
	printf 'PF\n8 4\n-1.0\n'
	for _ in {1..16}; do printf '\x00\x00\x80\x3e%.0s' 1 2 3 | cat; done
	for _ in {1..16}; do printf '\x00\x00\x80\x3f%.0s' 1 2 3 | cat; done
} >"$work/sky.pfm" 2>/dev/null
rejected "an object out of sight has no truth" 3 "the camera sees no object" "$bake" truth "$work/behind.scene" \
	--panorama "$work/sky.pfm" -o "$work/behind.png"
absent "and no picture" "$work/behind.png"
check "truth" "$bake" truth "$work/box.scene" --panorama "$work/sky.pfm" -o "$work/truth.png" \
	--samples 4 --background-out "$work/background.png" --fisheye-out "$work/fisheye.pfm" \
	--fisheye-size 32
check "with that background" "$bake" truth "$work/box.scene" --panorama "$work/sky.pfm" \
	-o "$work/truth2.png" --samples 4 --background "$work/background.png" --threads 1
same "is the same picture" "$work/truth.png" "$work/truth2.png"
rejected "truth without light" 2 "--panorama or --lamp is missing" "$bake" truth "$work/box.scene" \
	-o "$work/none.png"
# Lamps at places, without a panorama. A fisheye nearer to one sees it larger, and a turned one elsewhere.
lit() { # NAME OPTION...
	check "$1 under lamps" "$bake" truth "$work/box.scene" --lamp 1,0,1,0.1,9,9,9 --lamp=-1,2,2,0.2,1,2,3 \
		--samples 4 --fisheye-size 64 --quiet -o "$work/$1-truth.png" --background-out "$work/$1-background.png" \
		--fisheye-out "$work/$1-eye.pfm" "${@:2}"
}
printf '[fisheye]\nrotation = 0 0 90\n' >"$work/turned.ini"
lit at-the-origin
lit nearer --fisheye 0.5,0,0.1
lit turned --fisheye-lens "$work/turned.ini"
same "the truth knows no fisheye" "$work/nearer-truth.png" "$work/turned-truth.png"
# What goes between the two is the camera's 8 bits, as linear light or not.
check "its background in linear light" "$bake" truth "$work/box.scene" --lamp 1,0,1,0.1,9,9,9 --lamp=-1,2,2,0.2,1,2,3 \
	--samples 4 --quiet -o "$work/linear-truth.png" --background-out "$work/linear.pfm"
check "and as code values" "$bake" truth "$work/box.scene" --background "$work/linear.pfm" --samples 1 --quiet \
	--lamp 1,0,1,0.1,9,9,9 -o "$work/any.png" --background-out "$work/coded.png"
same "are one picture" "$work/turned-background.png" "$work/coded.png"
check "a fisheye has a place" bash -c "! cmp -s '$work/at-the-origin-eye.pfm' '$work/nearer-eye.pfm'"
check "and a lens" bash -c "! cmp -s '$work/at-the-origin-eye.pfm' '$work/turned-eye.pfm'"
rejected "a lamp without a radius" 2 "expected a radius above 0" "$bake" truth "$work/box.scene" --lamp 1,0,1,0,9,9,9 \
	-o "$work/none.png"
rejected "a lamp of too few numbers" 2 "--lamp: \"1,0,1\", expected 7" "$bake" truth "$work/box.scene" --lamp 1,0,1 \
	-o "$work/none.png"
rejected "a lens without lamps" 2 "go with --lamp" "$bake" truth "$work/box.scene" --panorama "$work/sky.pfm" \
	--fisheye-lens "$work/turned.ini" --fisheye-out "$work/no-eye.pfm" -o "$work/none.png"
rejected "a lens that is none, of the truth's" 1 "expected a [fisheye] section" "$bake" truth "$work/box.scene" \
	--lamp 1,0,1,0.1,9,9,9 --samples 1 --fisheye-lens "$work/no.ini" --fisheye-out "$work/no-eye.pfm" -o "$work/none.png"
rejected "a truth as a kind of picture that is not written" 1 "truth.jpg: cannot tell the kind" \
	"$bake" truth "$work/box.scene" --panorama "$work/sky.pfm" -o "$work/truth.jpg"
rejected "pictures of lights that would be rounded" 1 "c.png: would round" "$bake" pictures \
	"$work/box.scene" --object "$work/o%d.pfm" --ground "$work/g%d.pfm" --coverage "$work/c.png"
check "before any is rendered" test ! -e "$work/o0.pfm"
rejected "an 8-bit panorama" 1 "linear light" "$bake" truth "$work/box.scene" \
	--panorama "$work/truth.png" -o "$work/none.png"
rejected "a background of another size" 1 "expected 48 x 32" "$bake" truth "$work/box.scene" \
	--panorama "$work/sky.pfm" --background "$work/fisheye.pfm" -o "$work/none.png"
# night NAME WIDTH HEIGHT: all black.
night() {
	{ printf 'Pf\n%d %d\n-1.0\n' "$2" "$3" && head -c $((4 * $2 * $3)) /dev/zero; } >"$work/$1.pfm"
}
night night 8 4
night square 8 8
for panorama in night square; do
	words="upper half is black"
	[ $panorama = night ] || words="square.pfm: 8 x 8 pixels, expected twice as wide as high"
	rejected "a panorama that is none: $panorama" 1 "$words" "$bake" truth "$work/box.scene" \
		--panorama "$work/$panorama.pfm" -o "$work/none.png" --fisheye-out "$work/no-eye.pfm" \
		--background-out "$work/no-ground.png"
done
absent "failures leave no picture" "$work/none.png"
absent "of those that go with it, neither" "$work/no-eye.pfm"
absent "nor the background" "$work/no-ground.png"
finish
