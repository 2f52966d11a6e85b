#!/bin/bash
# SPDX-License-Identifier: MIT
# Hours of the screen: by a clock that is played, so that nights pass in a second.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
player=$(dirname "$INLAY")/tests/cli/tools/wall_clock.so
saturday=3654979200 # 2085-10-27 00:00 UTC, a Saturday; summer time ends on the next day
clock() { # SECONDS
	echo "$1" >"$work/time.new"
	mv "$work/time.new" "$work/time"
}
tell() {
	"$INLAY" control --socket "$work/socket" "$@"
}
status_says() { # WORDS
	tell status | grep -qF -- "$1"
}
answers() {
	tell status >/dev/null 2>&1
}
# begin SECONDS OPTIONS...: a kiosk whose clock shows this time. By name and path, because LD_PRELOAD
# ends at a blank.
begin() {
	clock "$1"
	shift
	LD_LIBRARY_PATH=$(dirname "$player") LD_PRELOAD=$(basename "$player") WALL_CLOCK=$work/time \
		start --set "control.socket=$work/socket" "$@"
	check "it answers" until_true answers
}
number_of() { # KEY of status; of the first camera where cameras have it
	tell status | grep -oE "\"$1\":[-0-9.]*" | head -n 1 | cut -d: -f2
}
frames_come() {
	local before
	before=$(number_of frames)
	until_true more "$before"
}
more() {
	[ "$(number_of frames)" -gt "$1" ]
}
hours=(--set "screen.hours=mon-fri 09:00-18:30, sat 10-14" --set "screen.time_zone=CET-1CEST,M3.5.0,M10.5.0/3")

refused "hours that are none" 1 '[screen] hours: is not understood from "to 5" on, expected' \
	"$INLAY" run --config "$work/studio.conf" --set "screen.hours=9 to 5" --frames 1
printf '\n[screen]\nhours = mon-fri 09:00-25:00\n' | cat "$work/studio.conf" - >"$work/odd.conf"
refused "with the file and its line" 1 "odd.conf:$(grep -n hours "$work/odd.conf" | cut -d: -f1): [screen] hours" \
	"$INLAY" run --config "$work/odd.conf" --frames 1
printf '\n[screen]\nhours = mon-fri 09:00-18:00 ; sat 10-14\n' | cat "$work/studio.conf" - >"$work/odd.conf"
refused "a Saturday that is a comment" 1 \
	"odd.conf:$(grep -n hours "$work/odd.conf" | cut -d: -f1): [screen] hours: goes on behind \";\"" \
	"$INLAY" check --config "$work/odd.conf"
sed -i 's/; sat.*/; Saturdays too?/' "$work/odd.conf"
equal "any other comment is none" 0 "$("$INLAY" check --config "$work/odd.conf" 2>&1 | grep -c odd.conf:)"
refused "a zone that is none" 1 '[screen] time_zone: is "Europe/Berln", which is no time zone' \
	"$INLAY" run --config "$work/studio.conf" --set screen.time_zone=Europe/Berln --frames 1

if [ ! -e "$player" ]; then
	fail "the clock is played" < <(echo "$player: missing")
	finish
fi

# ---- a night ----
begin $((saturday + 9 * 3600)) "${hours[@]}"
check "within its hours it shows frames" frames_come
check "status says until when" status_says '"rest":false,"hours_next":"sat 14:00","local_time":"sat '
check "and what a Raspberry Pi says of its power" status_says '"undervoltage":'
clock $((saturday + 12 * 3600))
check "after them it rests" until_true status_says '"screen":"off","rest":true,"hours_next":"mon 09:00"'
check "as the log says" says "$work/run.log" "at rest until mon 09:00: the screen is off, the cameras are closed"
check "the screen is switched off" says "$work/run.log" "null display: switched off"
frames=$(number_of frames)
sleep 1.2
equal "no picture is made" "$frames" "$(number_of frames)"
check "nothing is troubled" status_says '"name":"fisheye","situation":"fine"'
equal "a command is done, and says that nobody sees it" "ok, but the screen is at rest" "$(tell view fisheye)"
check "which does not wake it" status_says '"view":"fisheye","pose":0'
refused "nor is there a picture of it" 1 "the screen is at rest" tell snapshot "$work/dark.png"
check "it still rests" status_says '"rest":true'
equal "it is woken" ok "$(tell wake)"
check "and shows frames" frames_come
check "the log says for how long" says "$work/run.log" "awake for 10 minutes"
clock $((saturday + 4 * 86400 + 8 * 3600)) # Wednesday
tell view composite >/dev/null
check "a clock that jumps into the hours" frames_come
clock $((saturday - 86400 + 20 * 3600)) # back, into Friday's night
check "and back: it stays awake, as it was woken" frames_come
stop
equal "without a fault" 0 $?
equal "nothing was complained of" 0 "$(grep -c "camera .*:" "$work/run.log")"

# ---- a television that stays black ----
begin $((saturday + 9 * 3600)) "${hours[@]}" --set screen.hours_off=black --set "screen.cec=$work/cec"
check "the television is told to wake" until_true says "$work/run.log" "[screen] cec: $work/cec: the television is not told to wake"
clock $((saturday + 12 * 3600))
check "after its hours it rests, and the signal stays" until_true status_says '"screen":"fine","rest":true'
check "as the log says" says "$work/run.log" "the screen is black, the cameras are closed"
check "the television is told to go to standby" until_true says "$work/run.log" "not told to go to standby"
clock $((saturday + 2 * 86400 + 9 * 3600))
check "in the morning it shows frames" frames_come
equal "that no television is there is said once" 1 "$(said "$work/run.log" "not told to wake")"
equal "the screen was never switched off" 0 "$(said "$work/run.log" "switched off")"
stop

# ---- a start by night; the cameras' descriptors ----
begin $((saturday + 86400)) "${hours[@]}"
check "a kiosk that starts by night rests" status_says '"screen":"off","rest":true'
closed=$(descriptors)
equal "and opens no camera" 0 "$(number_of frames)"
clock $((saturday + 2 * 86400 + 9 * 3600)) # Monday, winter time since Sunday: 10:00 there
check "in the morning it shows frames" frames_come
check "as the log says" says "$work/run.log" "awake until mon 18:30"
for night in 1 2 3; do
	clock $((saturday + 2 * 86400 + 20 * 3600))
	check "night $night" until_true status_says '"rest":true'
	check "its cameras are closed" until_true descriptors_are_at_most "$closed"
	clock $((saturday + 3 * 86400 + 9 * 3600))
	check "day $night" frames_come
done
# Winter time: 8:30 UTC is 9:30, which was 10:30 two days before.
clock $((saturday + 3 * 86400 + 17 * 3600 + 1740))
check "18:29 in winter" until_true status_says '"rest":false'
clock $((saturday + 3 * 86400 + 17 * 3600 + 1800))
check "18:30 in winter" until_true status_says '"rest":true'
stop
equal "it ends at rest" 0 $?

# ---- no clock ----
begin 40 "${hours[@]}"
check "a clock that starts at 1970 does not count" frames_come
check "nor says when hours begin" status_says '"rest":false,"hours_next":""'
clock $((saturday + 86400))
check "until it is set" until_true status_says '"rest":true'
stop

# ---- reload ----
cp "$work/studio.conf" "$work/plain.conf"
conf() { # HOURS
	printf '\n[screen]\nhours = %s\n' "$1" | cat "$work/plain.conf" - >"$work/studio.conf.new"
	mv "$work/studio.conf.new" "$work/studio.conf"
}
conf "sun 0-24"
begin $((saturday + 86400 + 3600)) --set screen.time_zone=UTC0
check "a kiosk within its hours" frames_come
conf "sun 4:00-5:00"
kill -HUP "$inlay"
check "other hours are taken at once" until_true status_says '"rest":true,"hours_next":"sun 04:00"'
conf ""
kill -HUP "$inlay"
check "and none" frames_come
stop

# ---- buttons ----
conf "mon 9-10"
press() { # NAME: a button, once
	echo "0 view-next" >"$work/$1"
	conf "mon 9-10"
	printf '[buttons]\ndriver = script\nscript.file = %s\n' "$work/$1" >>"$work/studio.conf"
	kill -HUP "$inlay"
}
begin $((saturday + 86400)) --set screen.time_zone=UTC0
check "it rests" status_says '"rest":true'
press first
check "a button wakes it" until_true status_says '"rest":false'
check "and does nothing else" status_says '"view":"composite"'
press second
check "the next press does" until_true status_says '"view":"before"'
check "and frames come" frames_come
stop

# ---- a screen that cannot be switched off ----
conf "mon 9-10"
begin $((saturday + 86400)) --set screen.time_zone=UTC0 --set screen.driver=file \
	--set "screen.device=$work/night.png"
check "it rests, too" until_true status_says '"rest":true'
check "and is black" until_true test -s "$work/night.png"
stop
cat >"$work/black.py" <<'END'
import struct, sys, zlib
data = open(sys.argv[1], "rb").read()
rows, at = b"", 8
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at : at + 8])
    rows += data[at + 8 : at + 8 + size] if kind == b"IDAT" else b""
    at += size + 12
sys.exit(any(zlib.decompress(rows).replace(b"\1", b"\0").replace(b"\2", b"\0").replace(b"\4", b"\0")))
END
check "wholly" python3 "$work/black.py" "$work/night.png"

# ---- a basis that is replaced by night, and lost ----
loses_its_basis() { # COMMAND...: what becomes of the file once it has been taken
	cp "$work/box.inlay" "$work/own.inlay"
	begin $((saturday + 9 * 3600)) "${hours[@]}" --set "basis.file=$work/own.inlay"
	check "a kiosk with its own basis" frames_come
	clock $((saturday + 12 * 3600))
	check "rests" until_true status_says '"rest":true'
	cp "$work/box.inlay" "$work/own.new"
	mv "$work/own.new" "$work/own.inlay"
	kill -HUP "$inlay"
	check "another basis is taken by night" until_true says "$work/run.log" "basis of 26 lights, 1 pose"
	"$@"
	clock $((saturday + 2 * 86400 + 9 * 3600))
	check "in the morning it shows frames without: $1" frames_come
	stop
	equal "and ends in order" 0 $?
}
loses_its_basis truncate -s 100 "$work/own.inlay"
loses_its_basis cp "$work/studio.conf" "$work/own.inlay"
loses_its_basis rm "$work/own.inlay"

finish
