#!/bin/bash
# SPDX-License-Identifier: MIT
# How long things take: the bake, and a frame by stage, for the demo's cow and for spot.
#     BUILD=build/x tests/bench/bench.sh [--quick | --full | --1080p]      (make bench)
# Prints Markdown tables, leaves them in build/bench/table.md and build/bench/modes.md. Spot needs
# $INLAY_SHARED_DATA (else ../shared/data) and is left out without it. --quick: the cow at 640x480
# alone. --full: spot under 1,626 and (at 320x240) 6,486 lights too, and what --1080p is: a frame of
# 1920x1080, of which object and shadow are a quarter, by one thread and by two.
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
data=${INLAY_SHARED_DATA:-../shared/data}
work=build/bench
log=$work/log.txt
threads="1 2"

mkdir -p "$work"
: >"$log"

# The cameras show files, so that no time goes into simulating.
still_pictures() {
	local size=$1
	ffmpeg -y -loglevel error -f lavfi -i "testsrc2=s=$size" -frames:v 1 \
		"$work/background-$size.png" </dev/null
	[ -e "$work/fisheye.png" ] ||
		ffmpeg -y -loglevel error -f lavfi -i "testsrc2=s=480x480" -frames:v 1 \
			"$work/fisheye.png" </dev/null
}

scenes() {
	mkdir -p "$work/cow" "$work/spot"
	cp bake/demo/{cow.glb,cow.scene,background.ini} "$work/cow/"
	[ -e "$data/mesh/spot.obj" ] || return 0
	cp tests/accuracy/spot.scene "$work/spot/"
	ln -sfn "$(realpath "$data/mesh/spot.obj")" "$work/spot/spot.obj"
	# from further off, on ground that ends: together a quarter of a wide picture
	mkdir -p "$work/quarter"
	sed -e 's/^field_deg.*/field_deg = 57/' -e 's/^\[ground\]/&\nextent = 1.4/' tests/accuracy/spot.scene \
		>"$work/quarter/quarter.scene"
	ln -sfn "$(realpath "$data/mesh/spot.obj")" "$work/quarter/spot.obj"
}

# bake NAME SIZE SAMPLES: "seconds million_rays_per_s noise megabytes"
bake() {
	local name=$1 size=$2 samples=$3 line
	line=$("$build/inlay-bake" render --no-preview --frequency 9 --size "$size" \
		--samples "$samples" -o "$work/$name.inlay" "$work/$name/$name.scene" 2>>"$log") ||
		[ $? -eq 3 ]
	echo "$line" >>"$log"
	sed -n 's/.*(\([0-9.]*\) million.*time \([0-9.]*\) s, noise \([0-9.]*\).*/\2 \1 \3/p' \
		<<<"$line" | tr '\n' ' '
	echo $(($(stat -c %s "$work/$name.inlay") / 1000000))
}

# The most memory that a process had, in MB, while it lives.
peak_memory() {
	local pid=$1 peak=0 now
	while now=$(awk '/^VmHWM/ { print int($2 / 1024) }' "/proc/$pid/status" 2>/dev/null) &&
		[ -n "$now" ]; do
		peak=$now
		sleep 0.05
	done
	echo "$peak"
}

# run NAME SIZE THREADS FRAMES: "fps decode sample composite show memory"
run() {
	local name=$1 size=$2 frames=$4 stats=$work/stats.jsonl camera sets=() memory pid
	for camera in fisheye background; do
		sets+=(--set "camera.$camera.driver=sim" --set "camera.$camera.sim.source=files"
			--set "camera.$camera.sim.clock=frames")
	done
	"$build/inlay" run "${sets[@]}" --set "basis.file=$work/$name.inlay" \
		--set "camera.fisheye.sim.file=$work/fisheye.png" \
		--set "camera.background.sim.file=$work/background-$size.png" \
		--set screen.driver=null --set "composite.threads=$3" \
		--frames "$frames" --stats "$stats" 2>>"$log" &
	pid=$!
	memory=$(peak_memory $pid)
	wait $pid
	awk '
		{
			match($0, /"t":[0-9.]+/); t = substr($0, RSTART + 4, RLENGTH - 4)
			match($0, /"fps":[0-9.]+/); n = substr($0, RSTART + 6, RLENGTH - 6) * (t - before)
			before = t; sum += n
			for (i = 1; i <= 4; i++) {
				match($0, "\"" stage[i] "\":[0-9.]+")
				ms[i] += n * substr($0, RSTART + length(stage[i]) + 3, RLENGTH)
			}
		}
		BEGIN { split("decode sample composite show", stage) }
		END {
			printf "%.1f", sum / before
			for (i = 1; i <= 4; i++) printf " %.2f", ms[i] / sum
		}' "$stats"
	echo " $memory"
}

# rows NAME SIZE SAMPLES FRAMES
rows() {
	local name=$1 size=$2 samples=$3 t seconds rays noise mb fps decode sample composite show memory
	still_pictures "$size"
	echo "baking $name at $size" >&2
	read -r seconds rays noise mb < <(bake "$name" "$size" "$samples")
	for t in $threads; do
		echo "running $name at $size, threads: $t" >&2
		read -r fps decode sample composite show memory < <(run "$name" "$size" "$t" "$4")
		echo "| $name | $size | $samples | $seconds | $rays | $noise | $mb | $t |" \
			"$decode | $sample | $composite | $show | $fps | $memory |"
	done
	rm -f "$work/$name.inlay"
}

table() {
	echo "| object | size | samples | bake s | Mrays/s | noise levels | basis MB | threads |" \
		"decode ms | sample | composite | show | fps | memory MB |"
	echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
	rows cow 640x480 8 120
	[ -z "${quick:-}" ] || return 0
	rows cow 1920x1080 2 20
	[ -e "$work/spot/spot.obj" ] || return 0
	rows spot 640x480 8 120
	rows spot 1920x1080 2 20
}

# ---- inlay bench ----

# Of the JSON that inlay bench prints, a row a line: the figure of a way under a lighting, by the
# fastest kernel, which comes last.
figure() { # JSON LIGHTING WHAT KEY
	grep -F "{\"lighting\": \"$2\", \"what\": \"$3\"" "$1" | tail -n 1 |
		sed -n "s/.*\"$4\": \([^,}]*\).*/\1/p"
}
head_figure() { # JSON KEY
	sed -n "s/.*\"$2\": \([0-9.e+]*\).*/\1/p" "$1" | head -n 1
}
rounded() { # DIGITS VALUE...
	local digits=$1 value
	shift
	for value in "$@"; do
		case ${value:-null} in
		null) printf '| - ' ;;
		*) printf "| %.${digits}f " "$value" ;;
		esac
	done
}

# mode_rows JSON SCENE: a row for each lighting.
mode_rows() {
	local json=$1 lighting
	sed -n 's/^[[:space:]]*{"lighting": "\([^"]*\)".*/\1/p' "$json" | uniq | while read -r lighting; do
		of() { figure "$json" "$lighting" "$1" "$2"; }
		printf '| %s, %dx%d, %d lights, threads %d | %s ' "$2" "$(head_figure "$json" width)" \
			"$(head_figure "$json" height)" "$(head_figure "$json" lights)" \
			"$(head_figure "$json" threads)" "$lighting"
		rounded 2 "$(of 'thesis, double precision' median_ms)" "$(of exact median_ms)"
		rounded 3 "$(of fast median_ms)"
		rounded 0 "$(of fast speedup)"
		rounded 1 "$(of fast psnr_db)" "$(of fast max)"
		rounded 4 "$(of fast contrast)"
		rounded 3 "$(of 'whole frame' median_ms)" "$(of 'memcpy of the picture' median_ms)"
		rounded 1 "$(of 'whole frame' copies)"
		echo "|"
	done
}

# bake_modes SCENE FREQUENCY SIZE SAMPLES [OPTION...]
bake_modes() {
	local scene=$1 f=$2 size=$3 samples=$4
	shift 4
	echo "baking $scene at $size, f = $f" >&2
	"$build/inlay-bake" render --no-preview --frequency "$f" --size "$size" --samples "$samples" "$@" \
		-o "$work/$scene-$f-$size.inlay" "$work/$scene/$scene.scene" >>"$log" 2>&1 || [ $? -eq 3 ]
}

# modes SCENE FREQUENCY SIZE REPEAT [OPTION...]: puts the bake through inlay bench, under the built-in
# lightings and the panoramas.
modes() {
	local scene=$1 f=$2 size=$3 repeat=$4 name out json sky=()
	shift 4
	name=$scene-$f-$size
	out=$work/$name
	[[ " $* " != *" --threads 2 "* ]] || out+=-2-threads
	for json in "$data"/hdri/*.hdr; do
		[ -e "$json" ] && sky+=(--panorama "$json")
	done
	echo "timing $name" >&2
	"$build/inlay" bench --basis "$work/$name.inlay" --repeat "$repeat" "$@" --json \
		>"$out.json" 2>>"$log"
	mode_rows "$out.json" "$scene"
	if [ ${#sky[@]} -gt 0 ]; then
		"$build/inlay" bench --basis "$work/$name.inlay" --repeat "$repeat" "$@" --json \
			"${sky[@]}" >"$out-panoramas.json" 2>>"$log"
		mode_rows "$out-panoramas.json" "$scene"
	fi
	echo "${out##*/}: fast $(head_figure "$out.json" shown_mb) MB," \
		"exact $(head_figure "$out.json" exact_mb) MB," \
		"a byte for each value $(head_figure "$out.json" dense_mb) MB;" \
		"others had the processor for $(head_figure "$out.json" waited) of the time" \
		>>"$work/sizes.txt"
}

# 8 samples a pixel, whose noise costs columns; 64 would take half an hour.
quarter() {
	bake_modes quarter 9 1920x1080 8
	modes quarter 9 1920x1080 15 --thesis no --cells 4 --kernel auto
	modes quarter 9 1920x1080 15 --thesis no --cells 4 --kernel auto --threads 2
	rm -f "$work/quarter-9-1920x1080.inlay"
}

# spot FREQUENCY SIZE SAMPLES REPEAT [OPTION...]: with its exact layer, which is large.
spot() {
	local f=$1 size=$2 samples=$3
	shift 3
	bake_modes spot "$f" "$size" "$samples" --exact
	modes spot "$f" "$size" "$@"
	rm -f "$work/spot-$f-$size.inlay"
}

modes_table() {
	: >"$work/sizes.txt"
	echo "| scene | lighting | thesis ms | exact ms | fast ms | x thesis |" \
		"PSNR dB | max | contrast | whole frame ms | memcpy ms | frame / memcpy |"
	echo "|---|---|---|---|---|---|---|---|---|---|---|---|"
	[ -n "${wide:-}" ] || spot 9 640x480 64 15
	if [ -n "${full:-}" ]; then
		spot 18 640x480 64 9
		# the exact layer of 6,486 lights at 640x480 would be 12 GB
		spot 9 320x240 64 9
		spot 36 320x240 64 5 --cells 8
	fi
	[ -z "${full:-}${wide:-}" ] || quarter
	echo
	cat "$work/sizes.txt"
}

case ${1:-} in
'') ;;
--quick) quick=yes ;;
--full) full=yes ;;
--1080p) wide=yes ;;
*)
	echo "usage: bench.sh [--quick | --full | --1080p]" >&2
	exit 2
	;;
esac
scenes
if [ -z "${wide:-}" ]; then
	table | tee "$work/table.part.md"
	mv "$work/table.part.md" "$work/table.md"
fi
if [ -z "${quick:-}" ] && [ -e "$work/spot/spot.obj" ]; then
	echo
	modes_table | tee "$work/modes.part.md"
	mv "$work/modes.part.md" "$work/modes.md"
fi
