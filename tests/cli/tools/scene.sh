# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by the tests of this folder: counts checks in TAP, and bakes a small scene to work with.
#
# $INLAY and $INLAY_BAKE name the programs. Everything is written below $work, whose name holds a
# blank, and which is removed at the end.

: "${INLAY:?the program inlay}" "${INLAY_BAKE:?the program inlay-bake}"
work=$(mktemp -d "${TMPDIR:-/tmp}/inlay cli.XXXXXX")
# Not by a child that is ended before it has become the program it starts.
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT
count=0
failed=0

pass() {
	count=$((count + 1))
	echo "ok $count - $1"
}
fail() { # name; why on stdin
	count=$((count + 1))
	failed=1
	echo "not ok $count - $1"
	sed 's/^/# /'
}
# check NAME COMMAND...: the command succeeds.
check() {
	local name=$1 output
	shift
	if output=$("$@" 2>&1); then
		pass "$name"
	else
		fail "$name" < <(printf '%s\n' "failed: $*" "$output")
	fi
}
# equal NAME EXPECTED ACTUAL
equal() {
	if [ "$2" = "$3" ]; then
		pass "$1"
	else
		fail "$1" < <(printf '%s\n' "expected: $2" "is:       $3")
	fi
}
# same NAME FILE FILE: byte by byte.
same() {
	check "$1" cmp "$2" "$3"
}
# differ NAME FILE FILE
differ() {
	if cmp -s "$2" "$3"; then
		fail "$1" < <(echo "$2 and $3 are the same")
	else
		pass "$1"
	fi
}
# refused NAME CODE WORDS COMMAND...: exits with CODE, says one line that begins with the name of one of
# our programs and holds WORDS, on stderr and nothing on stdout.
refused() {
	local name=$1 code=$2 words=$3 out err is
	shift 3
	out=$("$@" 2>"$work/stderr" </dev/null)
	is=$?
	err=$(cat "$work/stderr")
	if [ $is -ne "$code" ]; then
		fail "$name" < <(printf '%s\n' "exit code $is, expected $code, of: $*" "$err")
	elif [ -n "$out" ] || [ "$(grep -c '' "$work/stderr")" -ne 1 ] ||
		[[ ! $err =~ ^inlay(-bake|-calibrate)?:\  || $err != *"$words"* ]]; then
		fail "$name" < <(printf '%s\n' "expected one line: inlay...: ... $words" \
			"stderr: $err" "stdout: $out")
	else
		pass "$name"
	fi
}
# absent NAME FILE...: none of them is there, nor a temporary one beside them.
absent() {
	local name=$1 left=
	shift
	for file in "$@"; do
		left+=$(find "$(dirname "$file")" -maxdepth 1 -name "*$(basename "$file")*")
	done
	equal "$name" "" "$left"
}
# number FILE KEY: of the last line; the run's own come before those of its cameras. find_number: in $found, which
# starts no process.
found=
find_number() {
	local lines=()
	mapfile -t lines 2>/dev/null <"$1"
	found=
	[ ${#lines[@]} -gt 0 ] && [[ ${lines[-1]} =~ \"$2\":([-0-9.e+]*) ]] && found=${BASH_REMATCH[1]}
}
number() {
	find_number "$@"
	echo "$found"
}
# until_true COMMAND...: waits for an event. Whoever waits for what never comes is told after two minutes, on
# the busiest machine.
exec {pause}<> <(:)
until_true() {
	local limit=$((SECONDS + 120))
	until "$@"; do
		[ $SECONDS -lt $limit ] || return 1
		read -rt 0.1 -u "$pause" || : # a sleep that starts no program
	done
}
# says LOG WORDS...: a line of it holds them; said LOG WORDS: in how many lines.
says() {
	local text=
	{ read -rd '' text <"$1"; } 2>/dev/null
	[[ $text == *"$2"* ]]
}
said() {
	grep -cF -- "$2" "$1"
}
# start OPTIONS...: inlay run in the background, on clocks of its own; what it says is in
# $work/run.log, its statistics in $work/live.jsonl, its process is $inlay. finish() ends it.
inlay=
start() {
	rm -f "$work/live.jsonl"
	: >"$work/run.log" # or the words of the one before would be found in it
	# nohup leaves hang-ups ignored
	env --default-signal=HUP "$INLAY" run --config "$work/studio.conf" --set screen.driver=null \
		--set camera.fisheye.sim.clock=real --set camera.background.sim.clock=real \
		--stats "$work/live.jsonl" "$@" 2>>"$work/run.log" &
	inlay=$!
}
# more_frames NUMBER: it has shown more than so many.
more_frames() {
	find_number "$work/live.jsonl" frames
	[ "${found:-0}" -gt "$1" ]
}
shows_frames() {
	until_true more_frames 0
}
frames_go_on() { # it shows more than now
	find_number "$work/live.jsonl" frames
	until_true more_frames "${found:-0}"
}
alive() {
	kill -0 "$inlay" 2>/dev/null
}
# stop: ends it as a service manager does; its exit code is left.
stop() {
	local code
	kill -TERM "$inlay" 2>/dev/null
	wait "$inlay"
	code=$?
	inlay=
	return $code
}
descriptors() {
	find "/proc/$inlay/fd" -mindepth 1 | wc -l
}
# descriptors_are_at_most NUMBER: files that are read just now come and go.
descriptors_are_at_most() {
	[ "$(descriptors)" -le "$1" ]
}
# flip FILE BYTE: one bit of it.
flip() {
	local byte
	byte=$(od -An -tu1 -j"$2" -N1 "$1")
	printf '%b' "\\x$(printf %02x $((byte ^ 16)))" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none
}
# has KEY VALUE: the last line of statistics says so.
has() {
	find_number "$work/live.jsonl" "$1"
	[ "$found" = "$2" ]
}
# has_lines NUMBER: at least so many of statistics.
has_lines() {
	local lines=()
	mapfile -t lines 2>/dev/null <"$work/live.jsonl"
	[ ${#lines[@]} -ge "$1" ]
}
finish() {
	[ -z "$inlay" ] || kill -KILL "$inlay" 2>/dev/null
	echo "1..$count"
	exit $failed
}

# A box on a ground plane, 48 x 32 pixels, 26 lights.
cat >"$work/box.obj" <<'END'
v -0.3 0 -0.3
v 0.3 0 -0.3
v 0.3 0 0.3
v -0.3 0 0.3
v -0.3 0.6 -0.3
v 0.3 0.6 -0.3
v 0.3 0.6 0.3
v -0.3 0.6 0.3
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
END
cat >"$work/box.scene" <<'END'
[camera]
position = 0 -3 1.5
look_at = 0 0 0.2
field_deg = 40
width = 48
height = 32
[dome]
frequency = 2
[render]
samples = 4
bounces = 1
[ground]
[object box]
file = box.obj
[material paint]
colour = 0.7 0.3 0.2
END
"$INLAY_BAKE" render --no-preview "$work/box.scene" -o "$work/box.inlay" >"$work/bake.log" 2>&1 || {
	sed 's/^/# /' "$work/bake.log"
	echo "Bail out! the scene was not baked"
	exit 1
}

# The studio through two simulated cameras; every run gives the same pictures.
cat >"$work/studio.conf" <<'END'
[basis]
file = box.inlay
[camera fisheye]
driver = sim
width = 96
height = 96
sim.view = fisheye
sim.clock = frames
sim.exposure = 0.2
[camera background]
driver = sim
width = 48
height = 32
sim.view = perspective
sim.clock = frames
[fisheye]
gain = 5
[composite]
threads = 2
[screen]
driver = file
END
