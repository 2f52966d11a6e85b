#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay run on simulated cameras: what it shows, counts, survives, and when it ends.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
counter=$(dirname "$INLAY")/tests/cli/tools/allocations.so

run() {
	timeout 600 "$INLAY" run --config "$work/studio.conf" "$@" 2>"$work/run.log"
}
png_size() { # width x height, from the file's header
	od -An -tu1 -j16 -N8 "$1" | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }'
}

# ---- the same run gives the same pictures ----
check "five frames" run --frames 5 --set "screen.device=$work/a%d.png" --stats "$work/a.jsonl"
equal "are five pictures" 5 "$(find "$work" -name 'a?.png' | wc -l)"
check "again" run --frames 5 --set "screen.device=$work/b%d.png" --set composite.threads=1
for i in 0 1 2 3 4; do
	same "frame $i is the same, with one thread too" "$work/a$i.png" "$work/b$i.png"
done
differ "the lamps move" "$work/a0.png" "$work/a4.png"
equal "the count of frames" 5 "$(number "$work/a.jsonl" frames)"
equal "the count of lights" 26 "$(number "$work/a.jsonl" lights)"
equal "all are used" 26 "$(number "$work/a.jsonl" lights_used)"
equal "nothing is dropped, cameras on demand wait" 0 "$(number "$work/a.jsonl" drops)"
check "statistics name stages and cameras" grep -qE \
	'"stage_ms":\{"decode":[0-9.]+,"sample":[0-9.]+,"people":[0-9.]+,"composite":[0-9.]+,"show":[0-9.]+\}.*"cameras":\[\{"name":"fisheye","situation":"fine"' \
	"$work/a.jsonl"
check "a threshold" run --frames 2 --set "screen.device=$work/t.png" --set lights.threshold=120 \
	--stats "$work/t.jsonl"
check "uses fewer lights ($(number "$work/t.jsonl" lights_used))" \
	test "$(number "$work/t.jsonl" lights_used)" -lt 26

# ---- a lamp where the dome is coarse ----
# an even sky of 64 x 32 pixels with one of radiance 1000, towards +X and 31 degrees high; rows count from the bottom
{
	printf 'PF\n64 32\n-1\n'
	for ((k = 0; k < 64 * 32; k++)); do
		[ $k -eq $((21 * 64 + 32)) ] && printf '\0\0zD\0\0zD\0\0zD' || printf '\0\0\200?\0\0\200?\0\0\200?'
	done
} >"$work/lamp.pfm"
check "a lamp in a coarse sky" run --frames 2 --set "screen.device=$work/lamp.png" --stats "$work/lamp.jsonl" \
	--set camera.fisheye.sim.source=panorama --set "camera.fisheye.sim.file=$work/lamp.pfm" \
	--set camera.fisheye.format=RGBF
equal "is named, by the node of its cell" '"coarse_lamp":{"azimuth":0.0,"height":26.6' \
	"$(tail -n 1 "$work/lamp.jsonl" | grep -oE '"coarse_lamp":\{"azimuth":[-0-9.]+,"height":[0-9.]+')"
equal "and as one that no section names, where it is" '"lamps_missing":[],"lamp_unnamed":{"azimuth":3' \
	"$(tail -n 1 "$work/lamp.jsonl" | grep -oE '"lamps_missing":.*"azimuth":[0-9]' || tail -n 1 "$work/lamp.jsonl")"
check "one that is named" run --frames 2 --set "screen.device=$work/lamp.png" --stats "$work/named.jsonl" \
	--set camera.fisheye.sim.source=panorama --set "camera.fisheye.sim.file=$work/lamp.pfm" \
	--set camera.fisheye.format=RGBF --set "lamp.there.position=1.7 0 1" --set lamp.there.radius=0.1 \
	--set "lamp.off.position=0 -1 1" --set lamp.off.radius=0.1
equal "is not, but one that is off" '"lamps_missing":["off"],"lamp_unnamed":null' \
	"$(tail -n 1 "$work/named.jsonl" | grep -oE '"lamps_missing":.*"lamp_unnamed":null' || tail -n 1 "$work/named.jsonl")"
check "the studio has none" grep -q '"coarse_lamp":null' "$work/a.jsonl"

# ---- views ----
check "all four" run --frames 1 --set "screen.device=$work/quad.png" --set screen.show=quad
equal "at twice the size" 96x64 "$(png_size "$work/quad.png")"
check "the fisheye" run --frames 1 --set "screen.device=$work/sky.png" --set screen.show=fisheye
equal "at its own size" 96x96 "$(png_size "$work/sky.png")"
check "a larger screen, fitted" run --frames 1 --set "screen.device=$work/large.png" \
	--set screen.width=200 --set screen.height=100 --set screen.scale=fit
equal "is filled" 200x100 "$(png_size "$work/large.png")"

# ---- buttons ----
buttons=(--set buttons.driver=script --set "buttons.script.file=$work/presses")
printf '0.2 threshold-set 255\n' >"$work/presses"
start "${buttons[@]}"
check "a button sets the threshold" until_true has threshold 255
check "so that no light is left" until_true has lights_used 0
stop
printf '0.2 quit\n' >"$work/presses"
check "another ends it" run --set screen.driver=null "${buttons[@]}"

# ---- signals: the video is whole ----
for signal in INT TERM; do
	rm -f "$work/clip.jsonl" "$work/clip.y4m"
	# A shell's background jobs ignore SIGINT, and what is ignored stays so.
	env --default-signal=INT "$INLAY" run --config "$work/studio.conf" \
		--set "screen.device=$work/clip.y4m" --stats "$work/clip.jsonl" 2>"$work/run.log" &
	inlay=$!
	check "it shows frames" until_true grep -qs '"frames":[1-9]' "$work/clip.jsonl"
	kill -$signal "$inlay"
	wait $inlay
	equal "SIG$signal ends it as it should" 0 $?
done
equal "the video begins as one" "YUV4MPEG2" "$(head -c 9 "$work/clip.y4m")"
header=$(head -n 1 "$work/clip.y4m" | wc -c)
frame=$((6 + 3 * 48 * 32))
equal "and holds whole frames" 0 $((($(stat -c %s "$work/clip.y4m") - header) % frame))
equal "as many as were shown" "$(number "$work/clip.jsonl" frames)" \
	$((($(stat -c %s "$work/clip.y4m") - header) / frame))

# ---- cameras that go ----
start --set camera.fisheye.sim.vanish_after=25
check "a camera that vanishes comes back" until_true says "$work/run.log" "camera fisheye: fine again"
stop
gone=$(said "$work/run.log" "camera fisheye: no device")
back=$(said "$work/run.log" "camera fisheye: fine again")
check "that it is back is said" test "$back" -ge 1
check "each time that it goes is said once ($gone, $back)" test $((gone - back)) -ge 0 -a $((gone - back)) -le 1
start --set camera.fisheye.driver=v4l2 --set camera.fisheye.device=/dev/video250
check "without a camera the background is shown" until_true more_frames 2
stop
equal "the camera is waited for, until a signal" 0 $?
equal "which is said once" 1 "$(grep -c 'camera fisheye: no device' "$work/run.log")"
check "and statistics name the situation" grep -q '"name":"fisheye","situation":"no device"' \
	"$work/live.jsonl"

# ---- a depth camera tells who is in front while depths come, feet while they do not ----
cp "$work/studio.conf" "$work/no-depth.conf"
cat >>"$work/studio.conf" <<'EOF'
[camera depth]
driver = sim
width = 96
height = 64
sim.view = perspective
sim.clock = frames
sim.walkers = 4
sim.depth_noise = 5
[depth]
camera = depth
[people]
occlude = yes
EOF
by_depth="who is in front is told by depth"
by_feet="who is in front is told by their feet"

for run in d e; do
	check "run $run" run --frames 5 --set "screen.device=$work/$run%d.png"
done
same "gives the same pictures" "$work/d4.png" "$work/e4.png"
check "a picture of the depths" "$INLAY" grab depth --config "$work/studio.conf" -o "$work/depth.png"
equal "is as large as they are" 96x64 "$(png_size "$work/depth.png")"

start --set camera.depth.sim.clock=real --set camera.depth.sim.stall_after=40
check "depth tells who is in front" until_true says "$work/run.log" "$by_depth"
check "until the depth camera stalls" until_true says "$work/run.log" "$by_feet"
check "then the kiosk goes on" frames_go_on
check "as is said of the camera" until_true says "$work/run.log" "camera depth: stalled"
stop
equal "it ends as it should" 0 $?

start --set camera.depth.driver=v4l2 --set camera.depth.device=/dev/video250
check "without the depth camera, feet tell" until_true says "$work/run.log" "$by_feet"
check "and frames are shown" until_true more_frames 2
check "the camera is waited for" until_true says "$work/run.log" "camera depth: no device"
equal "which is said once" 1 "$(said "$work/run.log" "camera depth: no device")"
stop
equal "and nothing ends" 0 $?

# What waiting cannot mend does not end it either.
start --set camera.depth.sim.view=fisheye
check "a camera that cannot measure depth" until_true says "$work/run.log" "sim: format Z16"
check "is done without" until_true says "$work/run.log" "$by_feet"
stop
equal "to the end" 0 $?

# One in 2.5 s.
start --set camera.depth.sim.clock=real --set camera.depth.rate=0.4
check "depths that are too old are not used" until_true says "$work/run.log" "$by_feet"
stop

# One that stands elsewhere.
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
start --set camera.depth.sim.clock=real --set "depth.calibration=$work/far.ini"
check "a calibrated depth camera tells who is in front" until_true says "$work/run.log" "$by_depth"
stop
equal "to the end, too" 0 $?
mv "$work/no-depth.conf" "$work/studio.conf"

# ---- figures for Prometheus ----
counts_pictures() {
	[ "$(sed -n 's/^inlay_frames_total //p' "$work/inlay.prom" 2>/dev/null)" -gt 0 ]
}
start --set "metrics.file=$work/inlay.prom"
check "a file for Prometheus has the pictures so far" until_true counts_pictures
stop
check "and cameras" grep -qx 'inlay_camera_fine{camera="fisheye",situation="fine"} 1' "$work/inlay.prom"
absent "and nothing beside it" "$work/inlay.prom.new"

# ---- nothing is allocated per frame ----
# By name and path, because LD_PRELOAD ends at a blank.
preload=(LD_LIBRARY_PATH="$(dirname "$counter")" LD_PRELOAD="$(basename "$counter")"
	ALLOCATIONS="$work/allocations")
if [ -e "$counter" ]; then
	allocations() { # WORD of what the counter says
		tr ' ' '\n' <"$work/allocations" | grep -A1 -x "$1" | tail -n 1
	}
	for show in composite quad; do
		check "$show for three seconds" env "${preload[@]}" "$INLAY" run --config "$work/studio.conf" \
			--frames 180 --set screen.driver=null --set screen.width=320 \
			--set screen.height=200 --set screen.scale=fit --set screen.rate=60 \
			--set screen.show=$show --stats "$work/s.jsonl"
		check "it turned $(allocations turns) times" test "$(allocations turns)" -gt 180
		equal "and allocated nothing once it had settled" 0 "$(allocations after)"
	done
	# The counter counts: pictures that are written to files do allocate.
	env "${preload[@]}" "$INLAY" run --config "$work/studio.conf" --frames 120 --set "screen.device=$work/now.png" \
		--set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real \
		--set camera.background.rate=60 2>"$work/run.log"
	check "writing files does ($(allocations after))" test "$(allocations after)" -gt 0
else
	fail "nothing is allocated per frame" < <(echo "$counter: missing")
fi

finish
