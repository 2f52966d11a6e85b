#!/bin/bash
# SPDX-License-Identifier: MIT
# Choices made with the buttons, and what was learned of the place without people, survive a power cut at
# any moment.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
state=$work/kept/state
mkdir "$work/kept"
keep=(--set "state.file=$state" --set state.interval=0)
press=(--set buttons.driver=script --set "buttons.script.file=$work/presses")
run() {
	timeout 600 "$INLAY" run --config "$work/studio.conf" --set screen.driver=null \
		--stats "$work/run.jsonl" "$@" 2>"$work/run.log"
}

# ---- over an end in order ----
printf '0.1 threshold-set 40\n0.2 view-next\n0.3 quit\n' >"$work/presses"
check "buttons choose" run "${keep[@]}" "${press[@]}" --set state.interval=3600
check "the threshold is kept" grep -qx 'threshold = 40' "$state"
check "so is the view" grep -qx 'view = before' "$state"
check "the next run" run "${keep[@]}" --frames 3
equal "begins with it" 40 "$(number "$work/run.jsonl" threshold)"
check "over what the configuration says" run "${keep[@]}" --frames 3 --set lights.threshold=7
equal "which does not count" 40 "$(number "$work/run.jsonl" threshold)"
printf '0.1 threshold-set 2.5%%\n0.3 quit\n' >"$work/presses"
check "a percentage is chosen" run "${keep[@]}" "${press[@]}"
check "and kept as one" grep -qx 'threshold = 2.5%' "$state"
check "the next start" run "${keep[@]}" --frames 3
check "begins with it" grep -q '"threshold":2.5,"threshold_unit":"percent"' "$work/run.jsonl"

# ---- over a power cut, wherever it falls ----
for i in $(seq 400); do echo "0.$(printf %03d "$i") threshold-set $((i % 256))"; done >"$work/presses"
# Ten times the moment is another one, in milliseconds; INLAY_THOROUGH: a hundred times.
whole=0
moments=$(seq 3 9 90)
[ -z "${INLAY_THOROUGH:-}" ] || moments=$(seq 0 99)
for i in $moments; do
	rm -f "$state"
	start "${keep[@]}" "${press[@]}"
	until_true test -e "$state"
	sleep "0.$(printf %03d "$i")"
	kill -KILL "$inlay"
	wait "$inlay" 2>/dev/null
	run "${keep[@]}" --frames 1 && ! grep -q 'state:' "$work/run.log" &&
		grep -qE '^threshold = [0-9]+$' "$state" && whole=$((whole + 1))
done
inlay=
equal "killed while it writes, the file is whole each time" "$(wc -w <<<"$moments")" $whole

# ---- files that are wrong ----
printf '[chosen]\nthreshold = 40\nview = sideways\n' >"$state"
check "a damaged file is no reason not to start" run "${keep[@]}" --frames 2
check "it is named with its line" says "$work/run.log" "$state:3: [chosen] view"
equal "and ignored whole" 0 "$(number "$work/run.jsonl" threshold)"
printf '[chosen]\nthreshold = 41\npose = 5\n' >"$state"
check "nor is a pose that is no more" run "${keep[@]}" --frames 2
check "which is said" says "$work/run.log" "pose is 5, expected 0..0"
equal "what else is kept counts" 41 "$(number "$work/run.jsonl" threshold)"
printf '[chosen]\nview = scene\n' >"$state"
check "nor a view that has no camera" run "${keep[@]}" --frames 2
check "which is said too" says "$work/run.log" "view is scene, but no camera"

rm "$state"
mkfifo "$state"
refused "a pipe, which the state would replace" 1 "\"$state\" is a folder, pipe or device" \
	"$INLAY" run --config "$work/studio.conf" "${keep[@]}" --frames 2
check "it is still there" test -p "$state"
rm "$state"

# ---- folders that are wrong ----
rm -rf "$work/kept"
printf '0.1 threshold-set 50\n0.3 threshold-set 51\n' >"$work/presses"
check "a missing folder is no reason not to start" run "${keep[@]}" --frames 1
check "it is said, before anything is chosen" says "$work/run.log" "what is chosen cannot be kept"
start "${keep[@]}" "${press[@]}"
check "a missing folder is said" until_true says "$work/run.log" "state: $state: cannot be written"
check "the kiosk goes on" until_true has threshold 51
until_true has_lines 4
equal "it is said at the start, and once when it is tried" 2 "$(said "$work/run.log" "cannot be written")"
mkdir "$work/kept"
check "when there is one the file is written" until_true grep -qsx 'threshold = 51' "$state"
check "which is said" until_true says "$work/run.log" "is written again"
stop
equal "it ends in order" 0 $?

# ==== the place without people ====
rm -rf "$work/kept"
mkdir "$work/kept"
place=$state.place
keep=(--set people.occlude=yes --set "state.file=$state" --set state.interval=0)
# knows FILE: its last line says that nearly all of the place is known.
knows() {
	awk -v learned="$(number "$1" learned)" 'BEGIN { exit !(learned > 0.95) }'
}
knows_nothing() {
	equal "$1" 0 "$(awk -v learned="$(number "$work/run.jsonl" learned)" 'BEGIN { print (learned > 0.1) }')"
}

# ---- over an end in order ----
check "two frames teach nothing" run "${keep[@]}" --frames 2
absent "and leave nothing" "$place"
check "four seconds of frames" run "${keep[@]}" --frames 100 --set state.interval=3600
check "teach the place" knows "$work/run.jsonl"
check "which is kept at the end" test -s "$place"
check "the next run" run "${keep[@]}" --frames 2
check "knows it at once" knows "$work/run.jsonl"
check "and says from where" says "$work/run.log" "the place is known from $place"

# ---- over a power cut, wherever it falls ----
whole=0
cp "$place" "$work/good"
is_written() { # it has another number than before
	[ -e "$place" ] && [ "$(stat -c %i "$place")" != "$before" ]
}
moments="50 350 700"
[ -z "${INLAY_THOROUGH:-}" ] || moments=$(seq 0 50 950)
for i in $moments; do
	before=$(stat -c %i "$place")
	start "${keep[@]}" --set camera.background.sim.clock=frames --set camera.fisheye.sim.clock=frames
	until_true is_written
	sleep "0.$(printf %03d "$i")"
	kill -KILL "$inlay"
	wait "$inlay" 2>/dev/null
	run "${keep[@]}" --frames 2 && ! grep -q 'learned anew' "$work/run.log" &&
		knows "$work/run.jsonl" && whole=$((whole + 1))
done
inlay=
equal "killed while it writes, the file is whole each time" "$(wc -w <<<"$moments")" $whole
equal "and nothing else is left" "state.place" "$(ls "$work/kept")"

# ---- files that are wrong ----
damage() { # NAME WORDS OPTION...
	local name=$1 words=$2
	shift 2
	check "$name is no reason not to start" run "${keep[@]}" --frames 2 "$@"
	check "$name is named: $words" says "$work/run.log" "people: $place: $words"
	check "$name: what happens is said" says "$work/run.log" "; the place is learned anew"
	equal "$name: in one sentence" 1 "$(said "$work/run.log" "people:")"
	knows_nothing "$name is not used"
	cp "$work/good" "$place"
}
flip "$place" 50000
damage "a damaged file" "is damaged, its checksum differs"
head -c 60000 "$work/good" >"$place"
damage "a truncated file" "has 60000 bytes, expected"
(cat "$work/good" && echo more) >"$place"
damage "a longer file" "has "
: >"$place"
damage "an empty file" "has 0 bytes, expected"
seq 10000 >"$place"
damage "another file" "is not the picture of a place"
damage "another camera's" "is of another camera, or of its place before" --set background.vflip=yes
damage "another transfer's" "is of lights elsewhere or of another transfer function" --set background.transfer=linear
sed 's/position = 0 -3 1.5/position = 0 -3.1 1.5/' "$work/box.scene" >"$work/moved.scene"
sed 's/frequency = 2/frequency = 3/' "$work/box.scene" >"$work/finer.scene"
sed 's/width = 48/width = 64/' "$work/box.scene" >"$work/wider.scene"
for scene in moved finer wider; do
	"$INLAY_BAKE" render --no-preview "$work/$scene.scene" -o "$work/$scene.inlay" >/dev/null 2>&1
done
damage "that of a camera which was moved" "is of another camera, or of its place before" \
	--set "basis.file=$work/moved.inlay"
damage "another dome's" "is of 26 lights, expected 46" --set "basis.file=$work/finer.inlay"
damage "another size's" "is of 48x32 pixels, expected 64x32" --set "basis.file=$work/wider.inlay" \
	--set camera.background.width=64
rm "$place"
mkfifo "$place"
check "a pipe is no reason not to start" run "${keep[@]}" --frames 2
check "it is named" says "$work/run.log" "$place: not a regular file but a named pipe, expected one to read; the place is learned anew"
rm "$place"
cp "$work/good" "$place"
check "another basis of the same camera and lights" cp "$work/box.inlay" "$work/same.inlay"
check "finds the same place" run "${keep[@]}" --frames 2 --set "basis.file=$work/same.inlay"
check "which it knows" knows "$work/run.jsonl"

# ---- forget and learn ----
press=(--set buttons.driver=script --set "buttons.script.file=$work/presses")
gone() {
	[ ! -e "$place" ]
}
printf '1 forget\n' >"$work/presses"
start "${keep[@]}" "${press[@]}" --set state.interval=3600
check "forget removes the file" until_true gone
stop
equal "it ends in order" 0 $?
printf '1 learn\n' >"$work/presses"
start "${keep[@]}" "${press[@]}"
check "learn has it written" until_true test -s "$place"
stop
equal "it ends in order, too" 0 $?

# ---- a reload ----
cp "$work/good" "$place"
cp "$work/studio.conf" "$work/other.conf"
printf '[people]\nocclude = no\n[state]\nfile = %s\n' "$state" >>"$work/other.conf"
rm -f "$work/live.jsonl"
env --default-signal=HUP "$INLAY" run --config "$work/other.conf" --set screen.driver=null --stats "$work/live.jsonl" \
	--set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real 2>"$work/run.log" &
inlay=$!
shows_frames
sed -i 's/occlude = no/occlude = yes/' "$work/other.conf"
kill -HUP "$inlay"
check "people are looked for from a reload on" until_true says "$work/run.log" "the place is known from"
check "in the place that is known" until_true knows "$work/live.jsonl"
kill -HUP "$inlay"
read_twice() {
	[ "$(said "$work/run.log" "has been read again")" = 2 ]
}
check "another reload" until_true read_twice
equal "leaves it alone" 1 "$(said "$work/run.log" "the place is known from")"
stop
equal "it ends in order" 0 $?

# ---- disks that are full, folders that are not there or not for writing ----
full() ( # a limit on the size of files stands for a full disk
	trap '' XFSZ
	ulimit -f 64
	run "${keep[@]}" --frames 100
)
rm "$place"
check "a full disk is no reason to end" full
check "it is said" says "$work/run.log" "people: $place: "
equal "once" 1 "$(said "$work/run.log" "what was learned of the place is not kept")"
absent "nothing is left" "$place"
cp "$work/good" "$place"
check "a disk that is full later" full
same "leaves the file of before" "$work/good" "$place"
for folder in gone "${SEALED:-/sys}"; do
	[ "$folder" = gone ] && folder=$work/gone
	check "a folder that cannot be written is no reason to end: $folder" run "${keep[@]}" --frames 100 \
		--set "state.file=$folder/state"
	equal "it is said once: $folder" 1 "$(said "$work/run.log" "what was learned of the place is not kept")"
done
finish
