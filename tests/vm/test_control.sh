#!/bin/bash
# SPDX-License-Identifier: MIT
# The control socket of a real kiosk that is not root: who may command it, and that no client can
# harm it.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh

# The kiosk is daemon, of the group games besides; the visitor is nobody.
place=/run/control-test
socket=$place/socket
mkdir -p $place
chown daemon:daemon $place
chmod 755 $place "$VM_OUT"
as() { # user, groups (one, or none), command...
	local user=$1 groups=(--clear-groups)
	[ "$2" = none ] || groups=(--groups "$2")
	shift 2
	setpriv --reuid "$user" --regid "$(id -g "$user")" "${groups[@]}" "$@"
}
as_member() { # the group is the first of the process
	setpriv --reuid nobody --regid games --clear-groups "$@"
}

cat >$place/kiosk.conf <<END
[basis]
file = $BUILD/tests/vm/live/live.inlay
[camera fisheye]
driver = sim
width = 96
height = 96
rate = 5
sim.view = fisheye
[camera background]
driver = sim
width = 160
height = 120
rate = 5
[screen]
driver = null
[control]
socket = $socket
group = games
END

# kiosk NAME: starts one
kiosk() {
	setpriv --reuid daemon --regid daemon --groups games \
		"$INLAY" run --config $place/kiosk.conf >"$VM_OUT/$1.log" 2>&1 &
	running=$!
}
tell() { # as whoever the first words say
	"$@" >"$VM_OUT/told" 2>&1
}
answers() {
	"$INLAY" control --socket $socket status >"$VM_OUT/status" 2>&1
}
figure() { # of the status
	answers && grep -oE "\"$1\":[-0-9.a-z\"]*" "$VM_OUT/status" | head -n 1 | cut -d: -f2
}
ended() {
	! kill -0 $running 2>/dev/null
}
refused() { # description, words, command...
	local description=$1 words=$2 code
	shift 2
	tell "$@"
	code=$?
	equal "$description" 1 $code
	matches "which is said" "$words" "$(cat "$VM_OUT/told")"
}

kiosk first
check "root gets an answer" eventually answers
equal "the socket is the group's" "srw-rw---- daemon games" "$(stat -c '%A %U %G' $socket)"

# ---- who may ----
commands=("$INLAY" control --socket "$socket")
check "the kiosk's own user may" tell as daemon none "${commands[@]}" threshold-up
check "a member of the group may" tell as nobody games "${commands[@]}" threshold-up
check "and one whose first group it is" tell as_member "${commands[@]}" threshold-up
equal "three steps of the threshold" 24 "$(figure threshold)"
refused "nobody else may connect" "you may not use the kiosk.s socket" as nobody none "${commands[@]}" threshold-up
chmod 666 $socket
refused "nor would it help if the socket were everybody's" "this user may not, expected root" \
	as nobody none "${commands[@]}" threshold-up
chmod 660 $socket
check "the configuration names the socket, too" tell as nobody games "$INLAY" control \
	--config $place/kiosk.conf threshold-set 40
equal "and nobody else has stepped" 40 "$(figure threshold)"
refused "a misspelt command is one with the nearest" 'did you mean "view-next"' \
	"${commands[@]}" veiw-next

# ---- what the screen shows ----
# The client writes it where the kiosk's user may not, and may not write where only the kiosk may.
own=$place/visitor
mkdir -p $own
chown nobody $own
chmod 700 $own
check "a member gets a picture of the screen" tell as nobody games "${commands[@]}" snapshot $own/shown.png
equal "which is its own" nobody "$(stat -c %U $own/shown.png)"
refused "into the kiosk's folder" "cannot be written: Permission denied" \
	as nobody games "${commands[@]}" snapshot $place/shown.png
refused "and nobody else" "you may not use the kiosk.s socket" as nobody none "${commands[@]}" snapshot $own/other.png

# ---- two kiosks ----
first=$running
kiosk second
check "a second kiosk on the same socket ends" eventually ended
matches "and says why" "another kiosk listens" "$(cat "$VM_OUT/second.log")"
running=$first
check "the first goes on" answers

# ---- clients that mean no good ----
frames=$(figure frames)
timeout 60 python3 - $socket >"$VM_OUT/hostile" 2>&1 <<'END'
import socket, sys

def client():
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(20)
    s.connect(sys.argv[1])
    return s

def ask(s, text):
    s.sendall(text)
    return s.recv(65536)

halves = [client() for _ in range(8)]
for s in halves:
    s.sendall(b"view-")
print("ninth", ask(client(), b"status\n")[:1])
endless = client()
try:
    while True:
        endless.sendall(b"x" * 100)
except OSError:
    print("endless cut off")
flood = client()
try:
    while True:
        flood.sendall(b"object\n" * 100)
except OSError:
    print("flood cut off")
deaf = client()
try:
    while True:
        deaf.sendall(b"status\n")
except OSError:
    print("deaf cut off")
print("after", ask(client(), b"status\n")[:1])
END
for word in "ninth b'{'" "endless cut off" "flood cut off" "deaf cut off" "after b'{'"; do
	matches "hostile clients: ${word% b*}" "^$word" "$(cat "$VM_OUT/hostile")"
done
# shellcheck disable=SC2317 # called by eventually
more_frames() {
	[ "$(figure frames)" -gt "$frames" ]
}
check "and pictures go on" eventually more_frames

# ---- a kiosk that died ----
kill -KILL $running
eventually ended
refused "a dead kiosk is no kiosk" "no kiosk listens .* Connection refused" "${commands[@]}" status
kiosk third
check "another takes its socket's place" eventually answers
tell "${commands[@]}" quit
check "and is told to end" eventually ended
check "which removes the socket" test ! -e $socket
