#!/bin/bash
# SPDX-License-Identifier: MIT
# A basis of several poses: baked, shared out, shown, switched and faded.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

bake=$INLAY_BAKE
sed 's/^frequency = 2/frequency = 1/' "$work/box.scene" >"$work/turn.scene" # six lights
cat >>"$work/turn.scene" <<'END'
[poses]
count = 5
[keyframe front]
object = box
[keyframe left]
object = box
pose = 2
rotate = 0 0 40
position = -0.3 0 0
[keyframe round]
object = box
pose = 5
rotate = 0 0 90
END
turn="$work/turn.inlay"
render=("$bake" render "$work/turn.scene" --quiet)

check "all poses are baked" "${render[@]}" -o "$turn"
check "info counts them" grep -q " 5 poses" <("$bake" info "$turn")
check "and names them" grep -qx "poses: 0=front 1 2=left 3 4" <("$bake" info "$turn")
"${render[@]}" --threads 1 -o "$work/again.inlay"
same "the same file from one thread" "$turn" "$work/again.inlay"
for k in 1 2 3 4; do
	"${render[@]}" --shard $k/4 -o "$work/$k.shard"
done
check "shards of all poses merge" "$bake" merge "$work"/{4,2,1,3}.shard -o "$work/merged.inlay"
same "to the same file" "$turn" "$work/merged.inlay"
head -c $(($(stat -c %s "$work/2.shard") - 100)) "$work/2.shard" >"$work/cut.shard"
if "$bake" merge "$work"/{1,cut,3,4}.shard -o "$work/no.inlay" 2>"$work/stderr"; then
	fail "a shard that ends in its last pose" </dev/null
else
	check "a shard that ends in its last pose" grep -q "ends too early" "$work/stderr"
fi

# ---- each pose alone ----
"$bake" truth "$work/turn.scene" --panorama "$work/none.hdr" --pose back -o "$work/no.png" 2>"$work/stderr"
check "a pose that is not there" grep -q "no pose \"back\", expected a number 0..4" "$work/stderr"
still=("$INLAY" still --config "$work/studio.conf" --background "$work/background.png" --lights "$work/lights")
"$INLAY" run --config "$work/studio.conf" --set screen.driver=file --set screen.show=before \
	--set "screen.device=$work/background.png" --frames 1 2>/dev/null
for ((k = 0; k < 6; k++)); do
	echo "0.$((k % 7)) 0.3 0.$((k % 5))"
done >"$work/lights"
alone=0
for pose in 0 2 4; do
	"${render[@]}" --pose $pose -o "$work/alone.inlay"
	alone=$((alone + $(stat -c %s "$work/alone.inlay")))
	"${still[@]}" --basis "$work/alone.inlay" -o "$work/alone.png"
	check "pose $pose of many is shown" "${still[@]}" --basis "$turn" --pose $pose -o "$work/pose.png"
	same "as alone" "$work/alone.png" "$work/pose.png"
done
# Values keep no more digits than their errors allow, so that poses pack.
bytes=$(stat -c %s "$turn")
check "5 poses take at most half of what 5 files do: $bytes, 3 files $alone" \
	test $((bytes * 3 * 2)) -le $((alone * 5))
"${render[@]}" --pose left -o "$work/named.inlay"
"${render[@]}" --pose 2 -o "$work/number.inlay"
same "by name as by number" "$work/named.inlay" "$work/number.inlay"
refused "one too many" 1 "pose 5 is not in the basis, expected 0..4" "${still[@]}" --basis "$turn" --pose 5 \
	-o "$work/no.png"

# ---- what is made of one pose ----
pictures() { # NAME OPTIONS...
	local name=$1
	shift
	"$bake" pictures "$work/turn.scene" --frequency 1 --samples 2 --size 16x12 --quiet \
		--object "$work/$name%d.pfm" --ground "$work/ground%d.pfm" --coverage "$work/$name.pfm" "$@"
}
check "pictures of the first pose" pictures first
check "of a pose by name" pictures left --pose left
same "which stands as the first" "$work/first0.pfm" "$work/left0.pfm"
check "of a pose by number" pictures last --pose 4
differ "which does not" "$work/first0.pfm" "$work/last0.pfm"
refused_bake() { # NAME WORDS COMMAND...
	local name=$1 words=$2
	shift 2
	if "$@" >/dev/null 2>"$work/stderr"; then
		fail "$name" </dev/null
	else
		check "$name" grep -q -- "$words" "$work/stderr"
	fi
}
refused_bake "pictures of no pose" 'no pose "back", expected a number 0..4' pictures no --pose back
report() {
	"$bake" report --quiet --size 48x36 --samples 4 --truth-samples 32 --frequency 1 --repeat 1 \
		--panorama "$work/flat.pfm" -o "$work/report" "$@"
}
{
	printf 'PF\n2 1\n-1.0\n'
	printf '\0\0\200\077%.0s' {1..6}
} >"$work/flat.pfm"
"${render[@]}" --pose 4 --frequency 1 --size 48x36 -o "$work/last.inlay"
check "a report of a pose" report "$work/turn.scene" --pose 4
check "says so" grep -q " Pose: 4\." "$work/report/report.html"
figures=$(grep -o "[0-9]* of them changed by the object, of which [0-9]*" "$work/report/report.html")
check "and is of it: $figures" grep -q "covers $((${figures%% *} - ${figures##* })) pixels" \
	<("$bake" info "$work/last.inlay")
refused_bake "a report of no pose" 'no pose "back"' report "$work/turn.scene" --pose back

# ---- a running kiosk ----
is_shown() { # POSE
	tell status | grep -q "\"pose_shown\":$1,"
}
tell() {
	"$INLAY" control --socket "$work/socket" "$@"
}
is_at() { # POSE
	tell status | grep -q "\"pose\":$1,"
}
start --set "basis.file=$turn" --set "control.socket=$work/socket"
check "frames are shown" shows_frames
equal "pose next" ok "$(tell pose next)"
check "and done" is_at 1
equal "pose-next" ok "$(tell pose-next)"
check "which has a name" grep -q '"pose":2,"pose_name":"left"' <(tell status)
equal "pose prev" ok "$(tell pose prev)"
check "and done" is_at 1
equal "pose NUMBER" ok "$(tell pose 4)"
check "is shown soon after" until_true is_shown 4
equal "pose-next goes round" ok "$(tell pose-next)"
check "and done" is_at 0
equal "pose-prev too" ok "$(tell pose-prev)"
check "and done" is_at 4
equal "pose NAME" ok "$(tell pose left)"
check "and done" is_at 2
check "and shown" until_true is_shown 2
refused "a pose that the basis does not have" 1 'no pose "right", expected a number 0..4 or a name' tell pose right
refused "no pose" 1 "pose needs a value" tell pose
check "the kiosk goes on" is_at 2
stop
equal "and ends" 0 $?

# ---- the timeline: pictures by the cameras' clock ----
movie() { # FILE OPTIONS...
	local file=$1
	shift
	"$INLAY" run --config "$work/studio.conf" --set "basis.file=$turn" --set screen.driver=file \
		--set camera.background.rate=20 --set camera.fisheye.rate=20 \
		--set "screen.device=$work/$file" "$@" 2>"$work/run.log"
}
check "a timeline" movie loop.y4m --set poses.timeline=loop --set poses.rate=10 --frames 12
check "the same again" movie loop2.y4m --set poses.timeline=loop --set poses.rate=10 --frames 12
same "shows the same" "$work/loop.y4m" "$work/loop2.y4m"
check "back and forth" movie swing.y4m --set poses.timeline=swing --set poses.rate=10 --frames 12
differ "is another" "$work/loop.y4m" "$work/swing.y4m"
check "faded" movie fade.y4m --set poses.timeline=loop --set poses.rate=10 --set poses.fade=yes --frames 12
differ "is another" "$work/loop.y4m" "$work/fade.y4m"
refused "a timeline that is none" 1 "[poses] timeline" "$INLAY" run --config "$work/studio.conf" \
	--set poses.timeline=sideways --frames 1
finish
