#!/bin/bash
# SPDX-License-Identifier: MIT
# Pictures of every light, and the thesis's files, to a basis: what comes out, what is refused.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

bake=$INLAY_BAKE
compare=$(realpath "${BUILD:?is not set: expected the folder that holds the programs}")/tests/accuracy/compare
cd "$work" || exit 1
pictures=(--object 'o%03d.pfm' --ground 'g%03d.pfm')

# unfit NAME WORDS OPTIONS...: the import exits with 1 and one sentence, and writes no file.
unfit() {
	local name=$1 words=$2 is
	shift 2
	rm -f no.inlay
	"$bake" import --quiet "$@" -o no.inlay >/dev/null 2>stderr </dev/null
	is=$?
	if [ $is -ne 1 ] || [ -e no.inlay ] || [ "$(wc -l <stderr)" != 1 ] || ! grep -qF -- "$words" stderr; then
		fail "$name" < <(echo "exit code $is, expected 1 with \"$words\": $*" && cat stderr)
	else
		pass "$name"
	fi
}
wrong() { # NAME WORDS OPTIONS...
	local name=$1 words=$2 is
	shift 2
	"$bake" import "$@" >/dev/null 2>stderr </dev/null
	is=$?
	if [ $is = 2 ] && grep -qF -- "$words" stderr; then
		pass "$name"
	else
		fail "$name" < <(echo "exit code $is, expected 2 with \"$words\"" && cat stderr)
	fi
}
# far A B: the most levels that two pictures differ by.
far() {
	"$compare" "$1" "$2" | awk '{ printf "%d", $3 }'
}
# Few lights and many samples, so that little of what is left between both is their noise: a level with 8000 rays a
# pixel, and the root of eight as much, with a level of rounding, with an eighth of them.
samples=1000 levels=4
[ -z "${INLAY_THOROUGH:-}" ] || samples=8000 levels=1
sed -e 's/^width.*/width = 32/' -e 's/^height.*/height = 24/' -e 's/^frequency.*/frequency = 1/' \
	-e 's/^file = .*/&\nmaterial = paint/' box.scene >small.scene
"$bake" dome --frequency 1 --angles >six.txt
check "pictures, light by light" "$bake" pictures small.scene "${pictures[@]}" --alone 'x%03d.pfm' \
	--coverage c.pfm --samples $samples --quiet
check "our own bake" "$bake" render small.scene --samples $samples --exact --quiet -o own.inlay
{ # a byte order mark does not matter
	printf '\xef\xbb\xbf'
	cat six.txt
} >marked.txt
mv marked.txt six.txt
check "import" "$bake" import --angles six.txt "${pictures[@]}" --alone 'x%03d.pfm' --coverage c.pfm \
	--exact --quiet -o in.inlay
ffmpeg -y -loglevel error -f lavfi -i "testsrc2=s=32x24" -frames:v 1 b.png </dev/null
awk 'BEGIN { for (i = 0; i < 6; i++) print 0.7, 0.7, 0.7 }' >even.txt
awk 'BEGIN { for (i = 0; i < 6; i++) print 0.2 + i % 3 / 2, 0.3 + i % 2, 1 - i / 8 }' >mixed.txt
for light in even mixed; do
	for basis in own in; do
		"$INLAY" still --basis $basis.inlay --background b.png --lights $light.txt --mode exact \
			-o $basis.png
	done
	most=$(far own.png in.png)
	echo "# $light: at most ${most:-?} levels"
	check "$light light: within $levels levels of our own bake" test "${most:-9}" -le $levels
done

# ---- more lights, in any order ----
"$bake" dome --frequency 2 --angles >a.txt
"$bake" pictures box.scene --frequency 2 "${pictures[@]}" --coverage c.pfm --samples 16 --quiet || exit 1
equal "which tells nothing of the ground below the object" "footprint: not known" \
	"$("$bake" info in.inlay | grep ^footprint)"
equal "nor where its pixels are" "lamps at places: no, the places of its pixels are not known" \
	"$("$bake" info in.inlay | grep ^lamps)"
printf '%s\n' '[lamp desk]' 'position = 0 0 2' 'radius = 0.1' >lamp.conf
cat "$work/studio.conf" lamp.conf >near.conf
check "so a lamp counts as distant, which is said" grep -q "lamps are taken as distant" \
	<("$INLAY" check --config near.conf --set basis.file="$PWD/in.inlay" 2>&1)
check "and not of our own bake" bash -c '! grep -q distant "$0"' \
	<("$INLAY" check --config near.conf --set basis.file="$PWD/own.inlay" 2>&1)
check "with coverage alone" "$bake" import --angles a.txt "${pictures[@]}" --coverage c.pfm --quiet -o in.inlay
equal "lights" 26 "$("$bake" info --json in.inlay | sed -n 's/.*"lights": *\([0-9]*\).*/\1/p' | head -n 1)"
# The same pictures and angles, both in another order.
mkdir turned
for ((k = 0; k < 26; k++)); do
	for what in o g; do
		ln -s "$work/$what$(printf %03d $k).pfm" "turned/$what$((26 - k)).pfm"
	done
done
tac a.txt >turned/a.txt
check "in another order, from 1" "$bake" import --angles turned/a.txt --object 'turned/o%d.pfm' \
	--ground 'turned/g%d.pfm' --coverage c.pfm --quiet -o again.inlay
same "the same file" in.inlay again.inlay

# ---- a dome that is finer in parts ----
fine=(--frequency 1 --fine "20 60 10 2")
"$bake" dome "${fine[@]}" --angles >fine.txt
check "pictures of finer parts" "$bake" pictures small.scene "${fine[@]}" --object 'f%03d.pfm' --ground 'h%03d.pfm' \
	--coverage k.pfm --samples 300 --quiet
check "import of finer parts" "$bake" import --angles fine.txt --object 'f%03d.pfm' --ground 'h%03d.pfm' \
	--coverage k.pfm --quiet -o fine.inlay
check "our own bake of finer parts" "$bake" render "${fine[@]}" --samples 300 --quiet --no-preview -o own-fine.inlay \
	small.scene
lights=$(($(wc -l <fine.txt) - 1))
for basis in fine own-fine; do
	equal "lights of $basis" $lights \
		"$("$bake" info --json $basis.inlay | sed -n 's/.*"lights": *\([0-9]*\).*/\1/p' | head -n 1)"
done
awk -v n=$lights 'BEGIN { for (i = 0; i < n; i++) print 0.3 + i % 3 / 5, 0.4, 0.5 - i / 60 }' >some.txt
ffmpeg -y -loglevel error -f lavfi -i "testsrc2=s=32x24" -frames:v 1 f.png </dev/null
for basis in fine own-fine; do
	check "still of $basis" "$INLAY" still --basis $basis.inlay --background f.png --lights some.txt -o $basis.png
done
rms=$("$compare" fine.png own-fine.png | awk '{ print $2 }')
check "finer parts: as our own bake but for noise (RMS ${rms:-?} levels)" awk "BEGIN { exit !(${rms:-9} < 1.5) }"
unfit "finer parts too near each other" "expected unit directions" \
	--angles <(printf 'fine 1\n0.5 0\n0.5 0.001\n') "${pictures[@]}" --coverage c.pfm

# ---- what does not fit ----
all=(--angles a.txt "${pictures[@]}" --coverage c.pfm)
unfit "angles in another order" "order" --angles turned/a.txt "${pictures[@]}" --coverage c.pfm
head -n 6 a.txt >few.txt
unfit "more pictures than lights" "one picture too many" --angles six.txt "${pictures[@]}" --coverage c.pfm
unfit "no dome has so many lights" "7 lights, expected" --angles <(head -n 7 a.txt) "${pictures[@]}" --coverage c.pfm
unfit "six lights of another dome" "is no light of a dome" --angles few.txt "${pictures[@]}" --coverage c.pfm
{ head -n 25 a.txt && echo 0 none; } >bad.txt
unfit "a line that is no angles" "bad.txt:26" --angles bad.txt "${pictures[@]}" --coverage c.pfm
unfit "no angles at all" "No such file" --angles none.txt "${pictures[@]}" --coverage c.pfm
unfit "another unit" "--scale" "${all[@]}" --scale 12.6
mv o007.pfm aside.pfm
unfit "a picture is missing" "o007.pfm" "${all[@]}"
head -c 500 aside.pfm >o007.pfm
unfit "a picture is cut off" "o007.pfm" "${all[@]}"
ffmpeg -y -loglevel error -f lavfi -i "testsrc2=s=20x20" -frames:v 1 small.png </dev/null
rm o007.pfm
ln -s small.png o007.pfm
unfit "a picture of another size" "o007.pfm: 20 x 20 pixels, expected 48 x 32" "${all[@]}"
mv aside.pfm o007.pfm
unfit "a mask of another size" "small.png: 20 x 20 pixels" --angles a.txt "${pictures[@]}" --mask small.png
ffmpeg -y -loglevel error -f lavfi -i "color=black:s=48x32" -frames:v 1 black.png </dev/null
unfit "ground and objects interchanged" "interchanged" --angles a.txt --object 'g%03d.pfm' --ground 'o%03d.pfm' --coverage c.pfm
unfit "ground in place of objects" "the same pictures" --angles a.txt --object 'g%03d.pfm' --ground 'g%03d.pfm' --coverage c.pfm
unfit "objects and ground as objects alone" "over black" "${all[@]}" --alone 'o%03d.pfm'
equal "a coverage that is black is remarked on" 1 "$("$bake" import --angles a.txt "${pictures[@]}" --mask black.png \
	--quiet -o black.inlay 2>&1 | grep -c 'black.png: no pixel is of an object')"
wrong "no angles" "--angles FILE is missing" "${pictures[@]}" --coverage c.pfm -o no.inlay
wrong "no output" "-o OUT.inlay is missing" "${all[@]}"
wrong "mask and coverage" "one of --coverage and --mask" "${all[@]}" --mask c.pfm -o no.inlay
wrong "pictures and .msi" "exclude each other" "${all[@]}" --msi x.msi -o no.inlay
wrong "transfer of an .msi" "exclude each other" --angles a.txt --msi x.msi --transfer srgb -o no.inlay
wrong "a light rate of pictures" "--rate is of --msi" "${all[@]}" --rate 2 -o no.inlay
wrong "a name without a number" "one number" --angles a.txt --object o.pfm --ground 'g%03d.pfm' --mask c.pfm -o no.inlay
wrong "a name with two" "one number" --angles a.txt --object 'o%d%d.pfm' --ground 'g%03d.pfm' --mask c.pfm -o no.inlay

# ---- the thesis's format ----
"$bake" render box.scene --frequency 2 --exact --quiet -o own.inlay || exit 1
rate=$("$bake" export own.inlay --msi t.msi | sed 's/rate = //')
check "export" "$bake" import --msi t.msi --rate "$rate" --angles a.txt --quiet -o msi.inlay
"$bake" import --msi t.msi --rate "$rate" --angles a.txt --error 0.001 --cell-error 255 --quiet -o tight.inlay 2>stderr
equal "errors that cannot be held" 3 $?
check "are named, and the file is kept" "$bake" info tight.inlay
equal "in one line" 1 "$(grep -cE '^inlay-bake: tight.inlay: [0-9]+ tiles? miss.*pixels.*levels' stderr)"
head -c 5000 t.msi >cut.msi
unfit "an .msi cut off" "as it says itself" --msi cut.msi --angles a.txt
unfit "an .msi of other lights" "26 lights, expected 6" --msi t.msi --angles six.txt
unfit "no .msi" "or damaged" --msi b.png --angles a.txt
: >empty.msi
unfit "an empty .msi" "is empty" --msi empty.msi --angles a.txt
unfit "a device" "not a regular file but a device" --msi /dev/zero --angles a.txt
finish
