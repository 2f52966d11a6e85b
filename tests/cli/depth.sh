#!/bin/bash
# SPDX-License-Identifier: MIT
# inlay run with a depth camera: depths tell who is in front while they come, feet while they do not.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

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

# ---- the same run gives the same pictures ----
for run in a b; do
	check "run $run" "$INLAY" run --config "$work/studio.conf" --frames 5 --set "screen.device=$work/$run%d.png"
done
same "gives the same" "$work/a4.png" "$work/b4.png"
check "a picture of the depths" "$INLAY" grab depth --config "$work/studio.conf" -o "$work/depth.png"
differ "is one" "$work/depth.png" "$work/a4.png"

# ---- while it works, and when it does not ----
start --set camera.depth.sim.clock=real --set camera.depth.sim.stall_after=40
check "depth tells who is in front" until_true 20 says "$work/run.log" "$by_depth"
check "until the depth camera stalls" until_true 20 says "$work/run.log" "$by_feet"
shown=$(number "$work/live.jsonl" frames)
more_frames() {
	[ "$(number "$work/live.jsonl" frames)" -gt $((shown + 20)) ]
}
check "then the kiosk goes on" until_true 20 more_frames
check "as is said of the camera" until_true 20 says "$work/run.log" "camera depth: stalled"
stop
equal "it ends as it should" 0 $?

start --set camera.depth.driver=v4l2 --set camera.depth.device=/dev/video250
check "without the depth camera, feet tell" until_true 20 says "$work/run.log" "$by_feet"
equal "which is said once" 1 "$(said "$work/run.log" "camera depth: no device")"
stop
equal "and nothing ends" 0 $?

# What waiting cannot mend does not end it either.
start --set camera.depth.sim.view=fisheye
check "a camera that cannot measure depth" until_true 20 says "$work/run.log" "sim: format Z16"
check "is done without" until_true 20 says "$work/run.log" "$by_feet"
stop
equal "to the end" 0 $?

# One in 2.5 s.
start --set camera.depth.sim.clock=real --set camera.depth.rate=0.4
check "depths that are too old are not used" until_true 20 says "$work/run.log" "$by_feet"
stop

# ---- a camera that stands elsewhere ----
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
check "a calibrated depth camera tells who is in front" until_true 20 says "$work/run.log" "$by_depth"
stop
equal "to the end, too" 0 $?

# ---- mistakes ----
wrong() { # NAME WORDS OPTIONS...
	local name=$1 words=$2
	shift 2
	refused "$name" 1 "$words" "$INLAY" check --config "$work/studio.conf" "$@"
}
check "a depth camera is fine" "$INLAY" check --config "$work/studio.conf"
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
printf '[depth]\nunit = 0\n' >>"$work/studio.conf"
lines=$(grep -c '' "$work/studio.conf")
wrong "no unit" "studio.conf:$lines: [depth] unit: is \"0\", expected a number 0.001..1000 mm"

finish
