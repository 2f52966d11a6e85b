#!/bin/bash
# SPDX-License-Identifier: MIT
# SIGHUP: the configuration is read again while the pictures go on.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
conf=$work/studio.conf
plain=$(grep -v "^threads" "$conf") # [composite] is the checks' own
# reload TEXT: the file with these lines more; waits until the kiosk has said what it thinks of it.
reload() {
	local before
	before=$(said "$work/run.log" "the configuration ")
	printf '%s\n%s\n' "$plain" "$1" >"$conf.new"
	mv "$conf.new" "$conf"
	hang_up
	until_true more_said "$before"
}
more_said() {
	[ "$(said "$work/run.log" "the configuration ")" -gt "$1" ]
}
hang_up() {
	kill -HUP "$inlay"
}
waits_for() { # KEY
	says "$work/run.log" "$1: takes effect at the next start"
}

start
check "it shows frames" shows_frames
check "it is read again" reload "[lights]
threshold = 90"
check "another threshold counts" until_true has threshold 90
check "a lens and its black level are taken" reload "[lights]
threshold = 100
[fisheye]
field = 85
black_level = 3"
check "the kiosk goes on" until_true has threshold 100
check "other threads, another kernel, view and scale" reload "[composite]
threads = 1
kernel = c
[screen]
show = quad
scale = fit
information = yes
[lights]
threshold = 110"
check "the kiosk goes on" until_true has threshold 110
equal "nothing is complained of" 0 "$(said "$work/run.log" "takes effect")"

# ---- what cannot be changed ----
check "a file that also changes what cannot be" reload "[camera background]
rate = 50
[screen]
width = 99
[basis]
pose = 0
[scene]
camera = fisheye
[lights]
threshold = 120"
for key in "[camera background] rate" "[scene] camera"; do
	check "$key is named" waits_for "$key"
done
check "[screen] width too" waits_for "[screen] width"
check "the rest counts" until_true has threshold 120

# ---- what is wrong ----
check "a wrong file" reload "[lights]
threshold = 300
[screen]
shwo = quad"
check "every fault is named" says "$work/run.log" "[lights] threshold"
check "the second too" says "$work/run.log" 'did you mean "show"'
check "the old one stays" until_true says "$work/run.log" "the old one stays"
check "a lens that is none" reload "[fisheye]
focal = 5 0"
check "a pose that is none" reload "[basis]
pose = 8"
check "is named" says "$work/run.log" "[basis] pose: is 8"
check "a kernel that is none, and more beside it" reload "[composite]
kernel = abacus
threads = 4
[lights]
threshold = 125"
check "is named" says "$work/run.log" 'none called "abacus"'
check "a patch of ground outside, and more threads" reload "[background]
ground_patch = 40 2 4000 10
[composite]
threads = 4"
check "is named" says "$work/run.log" "ground_patch: reaches to 4040, 12"
equal "none of them is said to be in force" 5 "$(said "$work/run.log" "the old one stays")"
check "it draws on, scaled, by as many threads as before" frames_go_on
equal "the threshold is what it was" 120 "$(number "$work/live.jsonl" threshold)"
mv "$conf" "$conf.away"
hang_up
check "a file that has gone" until_true says "$work/run.log" "No such file"
check "it runs on" alive
mv "$conf.away" "$conf"

# ---- buttons, socket, state ----
printf '0 threshold-set 130\n' >"$work/presses"
check "buttons can be added" reload "[buttons]
driver = script
script.file = $work/presses"
check "and work" until_true has threshold 130
check "a socket and a state file too" reload "[control]
socket = $work/socket
[state]
file = $work/state"
check "the socket works" until_true "$INLAY" control --socket "$work/socket" threshold-set 140
check "the state is kept" until_true grep -qsx 'threshold = 140' "$work/state"
check "status is JSON" sh -c '"$1" control --socket "$2" status | python3 -m json.tool' \
	- "$INLAY" "$work/socket"
check "the socket goes again" reload ""
check "from the folder too" test ! -e "$work/socket"

# ---- again and again ----
check "it goes on" frames_go_on
before=$(descriptors)
stayed=$(said "$work/run.log" "the old one stays")
times=8
[ -z "${INLAY_THOROUGH:-}" ] || times=25
for i in $(seq $times); do
	reload "[lights]
threshold = $i
[composite]
threads = $((1 + i % 3))
[control]
socket = $work/socket$((i % 2))" || break
done
check "it is read $times times" until_true has threshold $times
equal "the old one never stayed" "$stayed" "$(said "$work/run.log" "the old one stays")"
check "the socket goes once more" reload ""
check "it goes on" frames_go_on
check "descriptors do not grow" until_true descriptors_are_at_most "$before"
stop
equal "it ends in order" 0 $?

# ---- another basis in place of the one in use ----
again() { # hangs up, and waits until the kiosk has said what it thinks of it
	local before
	before=$(said "$work/run.log" "the configuration ")
	hang_up
	until_true more_said "$before"
}
lit() {
	[ "$(number "$work/live.jsonl" lights_used)" -gt 0 ]
}
printf '%s\n' "$plain" >"$conf"
own=$work/own.inlay
check "a preview" "$INLAY_BAKE" render --quiet --preview --frequency 1 "$work/box.scene" -o "$own"
start --set "basis.file=$own"
check "it shows frames" shows_frames
check "of a preview" says "$work/run.log" "6 lights, 1 pose, a preview"
check "the finished bake" "$INLAY_BAKE" render --quiet "$work/box.scene" -o "$own"
check "it still shows the preview" until_true has lights 6
check "a reload" again
check "shows the finished bake" until_true has lights 26
check "whose lights it measures" until_true lit
equal "and says so once" 1 "$(said "$work/run.log" "basis of 26 lights, 1 pose")"
check "a reload with the same file" again
equal "reads it no second time" 1 "$(said "$work/run.log" "basis of 26 lights, 1 pose")"
check "and it goes on" frames_go_on
before=$(descriptors)
head -c 5000 "$own" >"$own.new" && mv "$own.new" "$own"
check "half a file" again
check "is named" says "$work/run.log" "[basis] file: $own"
check "the old one stays" says "$work/run.log" "the old one stays"
check "it goes on" frames_go_on
"$INLAY_BAKE" render --quiet --no-preview --size 24x16 "$work/box.scene" -o "$own"
check "a bake of another size" again
check "is named" says "$work/run.log" "is of 24x16 pixels, expected 48x32 as before"
rm "$own"
check "none at all" again
equal "is not complained of" 2 "$(said "$work/run.log" "the old one stays")"
check "it goes on" frames_go_on
cp "$work/box.inlay" "$own"
check "the same again, as another file" again
equal "counts" 2 "$(said "$work/run.log" "basis of 26 lights, 1 pose")"
check "and it goes on" frames_go_on
check "descriptors do not grow" until_true descriptors_are_at_most "$before"
stop
equal "it ends in order" 0 $?

# ---- no frame is lost: cameras on demand, every frame of theirs in a video ----
printf '%s\n' "$plain" >"$conf"
rm "$work/live.jsonl"
"$INLAY" run --config "$conf" --set "screen.device=$work/clip.y4m" \
	--stats "$work/live.jsonl" 2>"$work/run.log" &
inlay=$!
shows_frames
for i in $(seq 10); do
	reload "[fisheye]
field = $((85 + i % 2))
[composite]
threads = $((1 + i % 2))" || break
done
stop
equal "it ends in order" 0 $?
equal "no frame is lost" 0 "$(number "$work/live.jsonl" drops)"
shown=$(number "$work/live.jsonl" frames)
taken=$(tail -n 1 "$work/live.jsonl" | grep -oE '"fisheye","situation":"fine","frames":[0-9]+' | cut -d: -f3)
check "of $taken that a camera gave, $shown are shown, and at most two on their way" \
	test $((taken - shown)) -ge 0 -a $((taken - shown)) -le 2

# ---- what takes long to read is read beside the pictures ----
goes_on_while_reading() { # NAME TEXT FILE: which the kiosk begins to read
	local holder
	holder=$(dirname "$INLAY")/tests/cli/tools/held_file.so
	printf '%s\n' "$plain" >"$conf"
	LD_LIBRARY_PATH=$(dirname "$holder") LD_PRELOAD=$(basename "$holder") HELD_FILE=$3 start
	check "it shows frames before it reads $1" shows_frames
	printf '%s\n' "$2" >"$conf"
	hang_up
	check "while it reads $1 the pictures go on" frames_go_on
	hang_up
	check "after a second signal too" frames_go_on
	equal "nothing is said" 0 "$(said "$work/run.log" "the configuration ")"
	touch "$3.go"
	check "it is read in the end" until_true more_said 0
	check "and once more for the second signal" until_true more_said 1
	equal "both are in force" 2 "$(said "$work/run.log" "the configuration has been read again")"
	stop
	equal "it ends in order" 0 $?
}
cp "$work/box.inlay" "$work/long.inlay"
printf '%s\n' "$plain" >"$conf"
"$INLAY" run --config "$conf" --frames 1 --set "screen.device=$work/mask.png" 2>/dev/null
goes_on_while_reading "a mask" "$plain
[people]
occlude = yes
mask = $work/mask.png" "$work/mask.png"
goes_on_while_reading "a basis" "${plain/box.inlay/long.inlay}" "$work/long.inlay"

# ---- the terminal it was started from goes: that is the end, and no reload ----
printf '%s\n' "$plain" >"$conf"
rm "$work/live.jsonl"
python3 "$(dirname "$0")/tools/terminal.py" "$work/live.jsonl" "$INLAY" run --config "$conf" \
	--set screen.driver=null --stats "$work/live.jsonl" 2>"$work/run.log"
equal "without its terminal it ends in order" 0 $?
check "having shown frames" test "$(number "$work/live.jsonl" frames)" -gt 0
finish
