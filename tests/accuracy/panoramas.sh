#!/bin/bash
# SPDX-License-Identifier: MIT
# Spot in real panoramas: the composite that inlay makes, against path-traced truth.
#     BUILD=build/x tests/accuracy/panoramas.sh           the table, in Markdown (make accuracy)
#     BUILD=build/x tests/accuracy/panoramas.sh --quick   a few of its cells as a test, in TAP
#     BUILD=build/x tests/accuracy/panoramas.sh --record  the same, and its figures written to figures.txt
# Pictures and table are left in build/accuracy/. README.md says how to read them.
set -u
cd "$(dirname "$0")/../.." || exit 1
# shellcheck source=tests/accuracy/method.sh
. tests/accuracy/method.sh
work=build/accuracy

frequencies="2 4 9 18"
samples_baked=64
samples_true=4096

# live NAME FILE EXPOSURE FREQUENCY WIDTH HEIGHT OUT: the same by `inlay run`, whose cameras stand in
# the panorama: a fisheye that does not clip, and the scene's camera in 8 bits.
live() {
	local camera sets=()
	for camera in fisheye background; do
		sets+=(--set "camera.$camera.driver=sim" --set "camera.$camera.sim.clock=frames"
			--set "camera.$camera.sim.source=panorama"
			--set "camera.$camera.sim.file=$data/hdri/$2.hdr"
			--set "camera.$camera.sim.exposure=$3")
	done
	"$build/inlay" run "${sets[@]}" --set "basis.file=$work/f$4.inlay" \
		--set camera.fisheye.format=RGBF \
		--set camera.fisheye.width=512 --set camera.fisheye.height=512 \
		--set "camera.background.width=$5" --set "camera.background.height=$6" \
		--set camera.background.sim.view=perspective \
		--set camera.background.sim.eye="2.3 -4.0 2.1" \
		--set camera.background.sim.target="0 0 0.72" \
		--set camera.background.sim.angle=40 \
		--set screen.driver=file --set "screen.device=$7" --frames 1 \
		>>"$log" 2>&1 || fail "inlay run in $1 failed"
}

# ---- the table ----

rows() {
	local name file exposure f out psnr rms max
	while read -r name file exposure; do
		for f in $frequencies; do
			printf '| %s | %s ' "$name" "$f"
			out=$work/$name-f$f
			composite "$name" "$f" "$out.png"
			read -r psnr rms max < <(compare "$out.png" "$work/$name-truth.pfm" \
				--difference "$out-difference.png")
			printf '| %s | %s | %s |\n' "$psnr" "$rms" "$max"
		done
	done <<<"$panoramas"
}

table() {
	local name file exposure f
	for f in $frequencies; do
		echo "baking f=$f" >&2
		bake "$f" --samples "$samples_baked"
	done
	while read -r name file exposure; do
		echo "tracing the truth in $file" >&2
		trace "$name" "$file" "$exposure" --samples "$samples_true"
	done <<<"$panoramas"
	{
		echo "| panorama | f | PSNR dB | RMS | max |"
		echo "|---|---|---|---|---|"
		rows
	} >"$work/table.part.md"
	mv "$work/table.part.md" "$work/table.md"
	cat "$work/table.md"
	echo
	grep -h 'noise' "$log" | sed 's/^/noise: /'
}

# ---- the test ----

count=0

# check TEXT CONDITION: CONDITION is for awk
check() {
	count=$((count + 1))
	if awk "BEGIN { exit !($2) }"; then
		echo "ok $count - $1 ($2)"
	else
		echo "not ok $count - $1 ($2)"
	fi
}

# figure NAME IS: not worse than figures.txt says by more than its noise. With --record IS becomes the figure.
figures=tests/accuracy/figures.txt
figure() {
	local told

	count=$((count + 1))
	if [ "${record:-}" ]; then
		awk -v name="$1" -v is="$2" '
			$1 == name { printf "%-14s %8s %6s  %s\n", name, is, $3, $4; next } { print }' \
			"$figures" >"$work/figures.txt" && cp "$work/figures.txt" "$figures"
	fi
	if told=$(awk -v name="$1" -v is="$2" '
		$1 == name && is != "" {
			met = 1
			better = $4 == "more" ? is - $2 : $2 - is
			printf "%s is %s, in figures.txt %s: ", name, is, $2
			if (better > 0) printf "better by %.2f", better
			else if (better < 0) printf "worse by %.2f, noise is %s", -better, $3
			else printf "the same"
			worse = -better > $3 + 1e-9
		}
		END {
			if (!met) printf "%s is \"%s\", and not in figures.txt", name, is
			exit !met || worse
		}' "$figures"); then
		echo "ok $count - $told"
	else
		echo "not ok $count - $told"
	fi
}

# The bounds lie 4 to 10 dB below what comes out, much of which is noise of few samples. Light from
# a wrong side has to fail them, or they would prove nothing: the last two see to that.
quick() {
	local size=64x48 cell2 cell9 live9 double shown shown_most mirrored turned rest

	if [ ! -e "$data/mesh/spot.obj" ] || [ ! -e "$data/hdri/venice_sunset_1k.hdr" ]; then
		echo "ok 1 - composite against truth # SKIP no data in $data"
		echo "1..1"
		return
	fi
	for f in 2 9; do
		bake "$f" --size $size --samples 32 --quiet --exact
	done
	trace sunset venice_sunset_1k 0.856 --size $size --samples 256 --quiet
	trace turned venice_sunset_1k 0.856 --size $size --samples 1 --quiet --turn 180
	composite sunset 2 "$work/quick.png"
	read -r cell2 rest < <(compare "$work/quick.png" "$work/sunset-truth.pfm")
	composite sunset 9 "$work/quick.png"
	read -r cell9 rest < <(compare "$work/quick.png" "$work/sunset-truth.pfm")
	# Double precision and the same rays: first only the arithmetic differs, then the encoding too,
	# under light that the encoder has not seen: 2 levels, as it was asked for, and half a one that
	# rounding to 8 bits adds.
	composite sunset 9 "$work/double.pfm" --mode reference
	composite sunset 9 "$work/exact.png" --mode exact
	read -r rest rest double < <(compare "$work/exact.png" "$work/double.pfm")
	read -r shown rest shown_most < <(compare "$work/quick.png" "$work/double.pfm")
	live sunset venice_sunset_1k 0.856 9 64 48 "$work/live.png"
	read -r live9 rest < <(compare "$work/live.png" "$work/sunset-truth.pfm")
	composite sunset 9 "$work/mirrored.png" --set fisheye.hflip=yes
	read -r mirrored rest < <(compare "$work/mirrored.png" "$work/sunset-truth.pfm")
	cp "$work/sunset-background.png" "$work/turned-background.png"
	composite turned 9 "$work/turned.png"
	read -r turned rest < <(compare "$work/turned.png" "$work/sunset-truth.pfm")
	check "26 lights" "$cell2 >= 36"
	check "406 lights" "$cell9 >= 42"
	check "406 lights, by inlay run" "$live9 >= 42"
	check "integers against double precision" "$double <= 1"
	check "what is shown against every light in double precision" \
		"$shown >= 50 && $shown_most <= 2.5"
	figure cell2_psnr "$cell2"
	figure cell9_psnr "$cell9"
	figure live9_psnr "$live9"
	figure double_max "$double"
	figure shown_psnr "$shown"
	figure shown_max "$shown_most"
	check "mirrored light is noticed" "$mirrored < 36"
	check "light from behind is noticed" "$turned < 36"
	echo "1..$count"
}

case ${1:-} in
'')
	prepare
	table
	;;
--quick | --record)
	quick=yes
	[ "$1" = --quick ] || record=yes
	work=build/accuracy/quick
	prepare
	quick
	;;
*)
	echo "usage: panoramas.sh [--quick | --record]" >&2
	exit 2
	;;
esac
