#!/bin/bash
# SPDX-License-Identifier: MIT
# Jobs for other renderers: what is in them, what is refused; with INLAY_THOROUGH also what comes back from
# Blender (board/deps.sh deep installs it) and from Radiance, which Debian does not have, where it is installed.
set -u
here=$(realpath "$(dirname "$0")")
# shellcheck source=tests/cli/tools/scene.sh
. "$here/tools/scene.sh"

bake=$INLAY_BAKE
cd "$work" || exit 1

skip() {
	count=$((count + 1))
	echo "ok $count - $1 # SKIP $2"
}
# exits NAME CODE WORDS OPTIONS...: export exits with CODE and says WORDS; of 1, in one sentence.
exits() {
	local name=$1 code=$2 words=$3 is
	shift 3
	"$bake" export "$@" >/dev/null 2>stderr </dev/null
	is=$?
	if [ $is != "$code" ] || ! grep -qF -- "$words" stderr ||
		{ [ "$code" = 1 ] && [ "$(wc -l <stderr)" != 1 ]; }; then
		fail "$name" < <(echo "exit code $is, expected $code with \"$words\": $*" && cat stderr)
	else
		pass "$name"
	fi
}
holds() { # NAME FILE WORDS
	check "$1" grep -qF -- "$3" "$2"
}
lines() { # FILE PATTERN
	grep -c -- "$2" "$1"
}

# A camera off its centre, with pixels that are not square and a lens that bends a little; few lights.
sed -e '/^\[camera\]/,/^\[dome\]/{/^\[dome\]/!d}' -e 's/^frequency.*/frequency = 1/' box.scene >bent.scene
cat >>bent.scene <<'END'
[tsai]
width = 30
height = 20
rotation = 1 0 0 0 -0.397607437634 -0.917555625310 0 0.917555625310 -0.397607437634
translation = 0 0.183511125062 3.349078032381
focal = 8
kappa1 = -0.00015
distortion = distorts
centre = 16.5 8.5
pixel = 0.25 0.2
aspect = 1.05
END
sed 's/^kappa1.*/kappa1 = -0.004/' bent.scene >barrel.scene
# A box with a coat behind a tinted pane, and a real step beside it.
printf 'v -0.5 0 0.6\nv 0.4 0 0.6\nv 0.4 0.7 0.6\nv -0.5 0.7 0.6\nf 1 2 3 4\n' >pane.obj
awk '$1 == "v" { $2 = 0.9 + $2 / 2; $3 /= 3; $4 /= 2 } 1' box.obj >step.obj
sed 's/^file = box.obj/&\nmaterial = paint/; s/^.material paint./&\nkind = glossy/; s/^bounces.*/bounces = 4/' bent.scene >pane.scene
cat >>pane.scene <<'END'
[object pane]
file = pane.obj
material = clear
[standin step]
file = step.obj
[material clear]
kind = glass
thin = yes
colour = 0.8 0.6 0.7
END
sed 's/^\[ground\]//' bent.scene >floating.scene
sed 's/^extent.*//; s/^\[ground\]/&\nextent = 4/' bent.scene >disc.scene

# ---- Blender ----
check "a job for Blender" "$bake" export bent.scene --blender blender
equal "its files" "angles.txt objects.obj render.py scene.json" "$(find blender -type f -printf '%f\n' | sort | xargs)"
same "its lights" blender/angles.txt <("$bake" dome --frequency 1 --angles)
equal "its triangles" 12 "$(lines blender/objects.obj '^f ')"
check "its script is Python" python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' blender/render.py
check "its scene is JSON" python3 -c 'import json, sys; json.load(open(sys.argv[1]))' blender/scene.json
holds "its camera" blender/scene.json '"focal": [33.6, 40], "centre": [16.5, 8.5]'
holds "how it is taken back" blender/scene.json "--object 'o%03d.exr'"
"$bake" export disc.scene --blender disc --frequency 2 --size 60x40 || exit 1
holds "a disc of ground" disc/scene.json '"reach": 4, "round": true'
holds "of another size" disc/scene.json '"size": [60, 40], "focal": [67.2, 80], "centre": [33, 17]'
equal "of another dome" 26 "$(lines disc/angles.txt .)"
"$bake" export pane.scene --blender pane 2>said || exit 1
holds "a pane" pane/scene.json '"ior": 1.5, "thin": true'
equal "what is seen through it is said in one line" 1 "$(lines said 'seen through glass')"
cat bent.scene - >turn.scene <<'END'
[poses]
count = 2
[keyframe here]
object = box
position = 0 0 0
[keyframe aside]
object = box
pose = 1
position = 0.5 0 0
END
check "the first pose" "$bake" export turn.scene --blender first
same "is the scene as it stands" first/objects.obj blender/objects.obj
check "another pose" "$bake" export turn.scene --blender aside --pose aside
differ "is another" aside/objects.obj blender/objects.obj
exits "a pose that is not there" 1 'no pose "back"' turn.scene --blender no --pose back
exits "a lens that Blender has not" 1 "moves pixels by up to" barrel.scene --blender no
absent "nothing is left of it" no

# ---- Radiance ----
check "a job for Radiance" "$bake" export barrel.scene --radiance radiance
for light in 0 1 2 3 4 5; do
	equal "light $light of 64 suns" 64 "$(lines radiance/light00$light.rad '^cell source')"
done
# 2 pi (1 - cos(angle / 2)) of all suns make up the sky.
sky=$(cat radiance/light*.rad | awk '/source/ { s += 6.283185307 * (1 - cos($10 * 0.00872664626)) }
	END { printf "%.4f", s }')
equal "all suns are the sky" 6.2832 "$sky"
equal "suns above the horizon" 0 "$(cat radiance/light*.rad | awk '/source/ && $9 < 0' | wc -l)"
for rays in object seen ground; do
	equal "its rays: $rays" $((4 * 30 * 4 * 20 * 24)) "$(stat -c %s radiance/$rays.rays)"
done
holds "its box" radiance/materials.rad "plastic m0"
holds "its ground" radiance/ground.rad "plastic ground 0 0 5 0.5 0.5 0.5 0 0"
check "ground alone" test "$(lines radiance/ground.rad mesh)" = 0
check "its Makefile" make -s -n -C radiance
check "no path of this machine" test -z "$(grep -rlF "$work" blender radiance)"

# Programs that stand in for Radiance's, and note that they were called: which pictures are made, how often.
mkdir fake
for program in oconv obj2mesh rtrace pcomb pfilt; do
	cat >fake/$program <<'END'
#!/bin/sh
echo "${0##*/}" >>"$ASKED"
[ "${0##*/}" != obj2mesh ] || { for last; do :; done; echo "${0##*/}" >"$last"; exit; }
[ -z "${FAILS:-}" ] || [ "${0##*/}" != "$FAILS" ] || exit 1
echo "${0##*/}"
END
	chmod +x fake/$program
done
export ASKED=$work/asked
pretend() {
	PATH=$work/fake:$PATH make -s -j2 -C radiance
}
FAILS=pcomb pretend >/dev/null 2>&1
equal "a program that fails leaves no picture" 0 "$(find radiance -name 'o*.hdr' | wc -l)"
check "goes on from there" pretend
equal "all pictures" 18 "$(find radiance -name '[oga]0*.hdr' | wc -l)"
left=$(find radiance \( -name '*.wide' -o -name '*.oct' -o -name '*.part' -o -name '*.rtm' \) -printf '%f\n')
equal "nothing else is left" objects.rtm "$left"
: >asked
pretend >said
equal "done once" 0 "$(wc -l <asked)"
holds "says how it is taken back" said "inlay-bake import --angles angles.txt --object 'o%03d.hdr'"
rm radiance/o003.hdr
check "one that is missing" pretend
equal "is made alone" "oconv 1 pcomb 1 pfilt 2 rtrace 2" "$(sort asked | uniq -c | awk '{ print $2, $1 }' | xargs)"

# ---- what does not go together ----
"$bake" render --quiet --no-preview --samples 2 pane.scene -o pane.inlay || exit 1
exits "glass in the thesis's format" 0 "no glass and no mirrors" pane.inlay --msi pane.msi
exits "nothing to do" 2 "expected --msi OUT.msi, --radiance DIR or --blender DIR" bent.scene
exits "two at once" 2 "one of --msi" bent.scene --radiance a --blender b
exits "a size of a basis" 2 "not of --msi" bent.scene --msi no.msi --size 3x3
exits "threads of a scene" 2 "is of --msi" bent.scene --blender no --threads 2
exits "no scene" 2 "expected one scene file" --blender no
exits "a scene that is not there" 1 "none.scene" none.scene --blender no
exits "nothing real in it" 1 "expected something real" floating.scene --blender no
exits "a file in place of the folder" 1 "expected a folder" bent.scene --radiance box.obj
mkdir -p empty own
echo "somebody's" >own/render.py
exits "a folder of something else" 1 "has other files in it" bent.scene --blender own
equal "which stays as it is" "render.py:somebody's" "$(cd own && grep -H '' -- *)"
check "an empty folder" "$bake" export bent.scene --blender empty
check "an earlier job" "$bake" export disc.scene --blender empty
holds "is written over" empty/scene.json '"reach": 4'
exits "a folder that cannot be made" 1 "cannot be made" bent.scene --radiance none/there

# ---- rendered for real ----
[ -n "${INLAY_THOROUGH:-}" ] || finish
# Compares the imported bake with an own bake of the same camera: shift and brightness.
"$bake" render bent.scene --samples 4000 --exact --quiet -o own.inlay || exit 1
ffmpeg -y -loglevel error -f lavfi -i "color=c=0x999999:s=30x20" -frames:v 1 grey.png </dev/null
awk 'BEGIN { for (i = 0; i < 6; i++) print 0.7, 0.7, 0.7 }' >even.txt
awk 'BEGIN { for (i = 0; i < 6; i++) print 0.2 + i % 3 / 2, 0.3 + i % 2, 1 - i / 8 }' >mixed.txt
awk 'BEGIN { for (i = 0; i < 6; i++) print (i == 2) * 2 + 0.1, (i == 2) * 2 + 0.1, 0.3 }' >lamp.txt
# Pictures show the ground through glass, the own bake shows the background: here both are equally bright.
awk 'BEGIN { for (i = 0; i < 6; i++) print 0.637, 0.637, 0.637 }' >alike.txt
still() { # BASIS LIGHTS
	"$INLAY" still --basis "$1.inlay" --background grey.png --lights "$2.txt" --mode exact -o "$1.png" &&
		ffmpeg -y -loglevel error -i "$1.png" -f rawvideo -pix_fmt rgb24 "$1.rgb" </dev/null
}
compared() { # WHAT BASIS BASIS LIGHTS...
	local what=$1 own=$2 other=$3 light
	shift 3
	for light in "$@"; do
		rm -f "$own.rgb" "$other.rgb" apart
		still "$own" "$light" && still "$other" "$light" &&
			python3 "$here/tools/export.py" 30 20 "$own.rgb" "$other.rgb" >apart
		check "$what, $light light: a picture" test -s apart
		read -r shift_px brighter <apart || return
		echo "# $what, $light light: shifted by $shift_px px, brightness off by $brighter %"
		check "$what, $light light: within half a pixel" awk "BEGIN { exit !($shift_px < 0.5) }"
		check "$what, $light light: within 5 % in brightness" awk "BEGIN { exit !($brighter < 5) }"
	done
}
import() { # FOLDER ENDING
	"$bake" import --angles "$1/angles.txt" --object "$1/o%03d.$2" --ground "$1/g%03d.$2" \
		--alone "$1/a%03d.$2" --coverage "$1/coverage.$2" --exact --quiet -o "$1.inlay"
}
# The measures notice what they are for: a picture moved by a pixel, and one of more light.
still own even
cp own.rgb first.rgb
{ head -c 3 first.rgb && head -c -3 first.rgb; } >moved.rgb
read -r shift_px _ < <(python3 "$here/tools/export.py" 30 20 first.rgb moved.rgb)
check "a pixel aside is seen" awk "BEGIN { exit !($shift_px > 0.5) }"
sed 's/0.7/0.6/g' even.txt >dim.txt
still own dim
read -r _ brighter < <(python3 "$here/tools/export.py" 30 20 first.rgb own.rgb)
check "less light is seen" awk "BEGIN { exit !($brighter > 5) }"

if ! command -v blender >/dev/null; then
	skip "rendered by Blender" "blender is not installed"
elif ! blender -b --python-exit-code 1 --python-expr "import numpy" >said 2>&1; then
	check "Blender without numpy says so" grep -q "^render.py: no numpy" \
		<(blender -b -P blender/render.py 2>&1)
	skip "rendered by Blender" "python3-numpy is not installed"
else
	check "Blender renders half of the lights" blender -b -t 2 -P blender/render.py -- --samples 512 --share 2/2
	check "Blender renders the rest" blender -b -t 2 -P blender/render.py -- --samples 512
	touch before
	check "Blender keeps what is there" blender -b -t 2 -P blender/render.py -- --samples 512
	equal "none of it is made again" "" "$(find blender -name '*.exr' -newer before)"
	touch -d 2001-01-01 blender/o003.exr blender/coverage.exr
	check "Blender makes anew" blender -b -t 2 -P blender/render.py -- --samples 512
	equal "what is older than the job" "coverage.exr o003.exr" \
		"$(find blender -name '*.exr' -newer before -printf '%f\n' | sort | xargs)"
	check "import from Blender" import blender exr
	compared Blender own blender even mixed lamp
	"$bake" render pane.scene --samples 4000 --exact --quiet -o own-pane.inlay || exit 1
	check "Blender renders glass" blender -b -t 2 -P pane/render.py -- --samples 512
	check "import of glass" import pane exr
	compared "Blender, glass" own-pane pane alike
fi
if command -v rtrace >/dev/null && command -v oconv >/dev/null; then
	"$bake" export bent.scene --radiance real || exit 1
	check "Radiance renders" make -s -j2 -C real
	check "import from Radiance" import real hdr
	compared Radiance own real even mixed lamp
else
	skip "rendered by Radiance" "rtrace and oconv are not installed"
fi
finish
