#!/bin/bash
# SPDX-License-Identifier: MIT
# What happens to a kiosk in months: it runs out of descriptors, is started twice,
# its cameras fall silent, take their time, send rubbish. Nothing of it ends the program.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
total() { # KEY: its sum over all lines
	grep -oE "\"$1\":[0-9]+" "$work/live.jsonl" | cut -d: -f2 | awk '{ s += $1 } END { print s + 0 }'
}

# ---- a misspelt camera ----
start --set camera.fishey.width=96
check "a camera that no view names is said" until_true says "$work/run.log" "camera fishey: no view"

# ---- its basis file is copied over, cut short, taken away ----
stop
cp "$work/box.inlay" "$work/own.inlay"
start --set "basis.file=$work/own.inlay"
check "a kiosk with a file of its own" shows_frames
cp "$work/box.obj" "$work/own.inlay"
check "something else copied over it: it goes on" frames_go_on
: >"$work/own.inlay"
check "cut short: it goes on" frames_go_on
rm "$work/own.inlay"
check "taken away: it goes on" frames_go_on

# ---- started twice ----
stop
start --set "control.socket=$work/socket"
check "one kiosk runs" shows_frames
refused "a second one is refused in one line" 1 "socket" timeout 120 "$INLAY" run \
	--config "$work/studio.conf" --set screen.driver=null --set "control.socket=$work/socket"
check "the first does not mind" frames_go_on
check "and still answers" "$INLAY" control --socket "$work/socket" threshold-set 33
stop

# ---- no descriptor is left when a camera has to be opened again ----
# A camera that warms up: green frames, and then too bright ones, are no light.
start --set camera.fisheye.sim.warm_up=60 --set camera.fisheye.format=YUYV
check "a camera that warms up" until_true grep -qs '"settling":true' "$work/live.jsonl"
settled() {
	tail -n 1 "$work/live.jsonl" | grep -q '"name":"fisheye".*"settling":false,"unsettled":[0-9].*"name":"background"'
}
check "and settles" until_true settled
check "which took at least as long as it warmed up" test "$(number "$work/live.jsonl" unsettled)" -ge 50
stop

# A plug with a bad contact: few lines, and a count.
losses() {
	grep -oE '"losses":[0-9]+' "$work/live.jsonl" | tail -n 2 | head -n 1 | cut -d: -f2
}
lost_often() {
	[ "$(losses)" -ge 7 ]
}
start --set camera.fisheye.sim.vanish_after=3
check "a camera that comes and goes each second" until_true lost_often
equal "is logged four times" 4 "$(said "$work/run.log" "camera fisheye: no device")"
equal "and when it came back" 4 "$(said "$work/run.log" "camera fisheye: fine again")"
stop

start --set camera.fisheye.sim.vanish_after=100
check "a camera that will vanish" shows_frames
before=$(descriptors)
hard=$(ulimit -Hn)
prlimit --pid "$inlay" --nofile="3:$hard"
check "no descriptor is left: it is said" until_true says "$work/run.log" "Too many open files"
check "the background goes on" frames_go_on
kill -HUP "$inlay"
check "nor can the configuration be read" until_true says "$work/run.log" "the old one stays"
equal "the camera's trouble is said once" 1 "$(said "$work/run.log" "camera fisheye: broken")"
prlimit --pid "$inlay" --nofile="256:$hard"
check "with descriptors it comes back" until_true says "$work/run.log" "camera fisheye: fine again"
check "none has leaked" until_true descriptors_are_at_most "$before" # it vanishes again and again
stop

# ---- cameras that fall silent, send rubbish ----
start --set camera.background.sim.stall_after=50
check "a camera that will stall" shows_frames
check "is named" until_true says "$work/run.log" "camera background: stalled"
check "the light goes on" frames_go_on
check "given up, it is opened again" until_true says "$work/run.log" "camera background: fine again"
stop
fine=$(said "$work/run.log" "camera background: fine again") # it stalls again 4 s after each
stalled=$(said "$work/run.log" "camera background: stalled")
check "each stall is said once" test "$stalled" -le $((fine + 1))
start --set camera.fisheye.sim.corrupt_every=3
check "every third frame is rubbish" shows_frames
until_true has_lines 3
check "which is counted" test "$(total broken)" -gt 0
equal "and no trouble" 0 "$(said "$work/run.log" "camera fisheye: broken")"
stop

# ---- a screen whose refresh never comes, one that is pulled out ----
for fault in stall vanish; do
	start --set screen.driver=null --set screen.null.${fault}_after=20
	check "a screen that will $fault" shows_frames
	check "is named" until_true says "$work/run.log" "screen: null display: "
	check "opened again, it shows more" until_true says "$work/run.log" "screen: fine again"
	check "and goes on" frames_go_on
	stop
	equal "it ends well then" 0 $?
done

# ---- the console is switched away under the last frame of a run that counts them ----
check "a frame that nobody saw is shown again" timeout 120 "$INLAY" run --config "$work/studio.conf" \
	--set screen.driver=null --set screen.null.hide_after=4 --frames 5

# ---- statistics that nobody reads, files that may not be larger ----
mkfifo "$work/unread"
check "statistics that nobody reads hold up nothing" timeout -k 1 120 "$INLAY" run \
	--config "$work/studio.conf" --set screen.driver=null --frames 3 --stats "$work/unread"
limited() { # COMMAND...: no file of more than 1024 bytes
	(ulimit -f 1 && exec timeout -k 1 120 "$@")
}
check "statistics that may not grow end nothing" limited "$INLAY" run --config "$work/studio.conf" \
	--set screen.driver=null --set screen.rate=10 --frames 30 --stats "$work/small.jsonl"
equal "they end with a line" "}" "$(tail -c 2 "$work/small.jsonl")"
refused "a video that may not grow ends it in one line" 1 "File too large" limited "$INLAY" run \
	--config "$work/studio.conf" --frames 3 --set "screen.device=$work/small.y4m"
refused "a basis that may not grow is one line" 1 "File too large" limited "$INLAY_BAKE" render \
	"$work/box.scene" --quiet -o "$work/small.inlay"
absent "and nothing is left of either" "$work/small.y4m" "$work/small.inlay"

# ---- a camera that takes its time: a pipe that nobody writes to ----
mkfifo "$work/live.y4m"
pipe=(--set camera.fisheye.sim.source=files --set "camera.fisheye.sim.file=$work/live.y4m")
start "${pipe[@]}"
check "a camera that takes its time does not hold up the other" shows_frames
check "it is named" until_true says "$work/run.log" "camera fisheye:"
stop
equal "ended in the middle of opening it ends in order" 0 $?

# ---- light that cannot be right is said, after ten seconds in which it was ----
start --set fisheye.camera=background --set fisheye.field=30
check "no image circle where the lens has one is said" until_true says "$work/run.log" \
	"has no image circle where its lens has one"
stop
start --set fisheye.centre="24 48"
check "lights outside of the picture are said" until_true says "$work/run.log" \
	"lights lie outside of the fisheye's picture"
stop

# A lens without corners shows no circle; then the ground tells. Three kiosks at once: the rug's reflectance and the
# exposures as calibrated, the fisheye covered, the cameras exchanged.
printf '[light]\ngain = 10\n' >"$work/gain.ini"
frames() { # NAME OPTIONS...: a kiosk with a lens that fills the picture; its process is in $!
	local name=$1
	shift
	"$INLAY" run --config "$work/studio.conf" --set screen.driver=null --set camera.fisheye.width=48 \
		--set camera.fisheye.height=32 --set "camera.fisheye.sim.focal=20 20" --set "fisheye.focal=20 20" \
		--set camera.fisheye.sim.exposure=0.1 --set "fisheye.light=$work/gain.ini" \
		--set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real \
		--set "background.ground_patch=16 20 12 6" --set "background.ground_reflectance=0.68 0.59 0.45" \
		"$@" 2>"$work/$name.log" &
}
frames right
others=($!)
frames covered --set camera.fisheye.sim.exposure=0.002
others+=($!)
frames exchanged --set fisheye.camera=background --set background.camera=fisheye
others+=($!)
check "a covered fisheye is said" until_true says "$work/covered.log" "brighter than the measured light"
check "exchanged cameras are, by the ground" until_true says "$work/exchanged.log" \
	"darker than the measured light makes it: are the cameras exchanged"
kill "${others[@]}"
wait "${others[@]}"
grep -v "lights lie outside" "$work/right.log" | grep "light:" | sed 's/^/# /'
check "as calibrated there is no doubt of the ground" test "$(said "$work/right.log" "measured light")" = 0

# ---- no camera at all: the screen says so ----
"$INLAY" run --config "$work/studio.conf" --set screen.width=320 --set screen.height=240 \
	--set camera.fisheye.driver=v4l2 --set camera.fisheye.device=/dev/video250 \
	--set camera.background.driver=v4l2 --set camera.background.device=/dev/video251 \
	--frames 3 --set "screen.device=$work/none.png" 2>"$work/run.log"
equal "without any camera it runs" 0 $?
equal "each is named" 2 "$(said "$work/run.log" "no device")"
"$INLAY" run --config "$work/studio.conf" --set screen.width=320 --set screen.height=240 \
	--set camera.fisheye.driver=v4l2 --set camera.fisheye.device=/dev/video250 \
	--set camera.background.driver=v4l2 --set camera.background.device=/dev/video251 \
	--set screen.trouble=no --frames 3 --set "screen.device=$work/black.png" 2>"$work/run.log"
differ "on the screen too, unless that is not wanted" "$work/none.png" "$work/black.png"
finish
