#!/bin/bash
# SPDX-License-Identifier: MIT
# The power is cut again and again while the state is being written: each time the machine comes up
# again with one of the values that were chosen, its disk sound, its root untouched.
#     test_power.sh BOARD
. tests/vm/guest/tap.sh
. tests/boot/machine.sh
. tests/boot/scene.sh
board=$1
cuts=${CUTS:-10}
seed=${SEED:-$RANDOM}
RANDOM=$seed
folder=$BUILD/tests/boot/$board-power
rm -rf "$folder"
mkdir -p "$folder"
image=$folder/disk.img
PATH=$PATH:/usr/sbin:/sbin
trap machine_end EXIT

cp --sparse=always "build/image/$board/inlay.img" "$image"
# part NUMBER: copies a partition of the image out.
part() {
	local start size
	read -r start size < <(sfdisk -d "$image" |
		sed -n "s/.*img$1 : start= *\([0-9]*\), size= *\([0-9]*\),.*/\1 \2/p")
	dd if="$image" bs=512 skip="$start" count="$size" status=none conv=sparse of="$folder/part-$1"
}
part 2
before=$(sha256sum <"$folder/part-2")
check "a person's configuration goes onto the partition INLAY" still_scene "$image" "$folder"

# start: boots and waits for the picture.
start() {
	machine_start "$board" "$image" "$folder" systemd.wants=inlay-shell@ttyS1.service &&
		shell 120 'systemctl start inlay' # waits for the start that is under way
}
threshold() { # as the kiosk itself says it
	shell 60 'inlay control --socket /run/inlay/control status' |
		sed -n 's/.*"threshold": *\([0-9.]*\).*/\1/p'
}
# One connection that never rests; returns when the first press is answered.
press() {
	shell 60 "rm -f /run/pressed; perl -MSocket -e '
		socket(S, AF_UNIX, SOCK_STREAM, 0) && connect(S, sockaddr_un(\"/run/inlay/control\")) or die;
		for (;;) { for (\$t = 8; \$t < 256; \$t += 8) {
			syswrite(S, \"threshold-set \$t\\n\"); <S> =~ /^ok/ or die; \$| = 1; print \"\$t\\n\" } }
		' >/run/pressed & until test -s /run/pressed; do kill -0 \$! || break; sleep 0.1; done; test -s /run/pressed"
}
showing() {
	shown "$folder" "$1"
}

echo "# seed $seed"
bad=0 sound=0 shows=0 written=0
for ((cut = 0; cut <= cuts; cut++)); do
	start >"$folder/start" || {
		cat "$folder/start" "$folder/console.log" | tail -n 40 | not_ok "it comes up after cut $cut"
		exit
	}
	now=$(threshold)
	# Thresholds are chosen from 0 8 16 ... 248 only: anything else was never written.
	awk "BEGIN { exit !(\"$now\" != \"\" && $now % 8 == 0 && $now >= 0 && $now < 256) }" || {
		bad=$((bad + 1))
		echo "# after cut $cut the threshold is \"$now\""
	}
	[ "${now:-0}" = 0 ] || written=$((written + 1))
	within 30 showing "${now:-0}" && shows=$((shows + 1))
	[ $cut -lt $cuts ] || break
	# Presses without end, then the cut at a moment that nobody knows.
	check "presses arrive before cut $((cut + 1))" press
	sleep "$((RANDOM % 3)).$((RANDOM % 10))"
	power_cut
	part 3
	# The journal is replayed, and then nothing may be left to mend.
	e2fsck -p "$folder/part-3" >"$folder/fsck-$cut" 2>&1
	[ $? -le 1 ] && e2fsck -f -n "$folder/part-3" >>"$folder/fsck-$cut" 2>&1 && sound=$((sound + 1))
done
equal "after each of $cuts power cuts the state is one that was chosen" 0 $bad
holds "and not only the first one" "$written > 0"
equal "the partition of the state is sound" "$cuts" $sound
equal "the screen shows what inlay still makes with that threshold" $((cuts + 1)) $shows
shell 5 'systemctl poweroff' >/dev/null
check "it switches itself off in order" switched_off 60
part 2
equal "the root is as it was, bit for bit" "$before" "$(sha256sum <"$folder/part-2")"
