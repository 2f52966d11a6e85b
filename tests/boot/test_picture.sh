#!/bin/bash
# SPDX-License-Identifier: MIT
# An image comes to the picture by itself: how long that takes, what is on the screen, and that the
# kiosk is there for good: restarted when it hangs, stopped in order, the root never written.
#     test_picture.sh BOARD
. tests/vm/guest/tap.sh
. tests/boot/machine.sh
. tests/boot/scene.sh
board=$1
case $board in
qemu-x86_64) tty=ttyS1 patience=300 ;;
pc-x86_64) tty=ttyS1 patience=900 ;;
qemu-arm64) tty=ttyS0 patience=900 ;;
esac
folder=$BUILD/tests/boot/$board
rm -rf "$folder"
mkdir -p "$folder"
image=$folder/disk.img
trap machine_end EXIT

# ---- as it is delivered: its own configuration, the demo ----
cp --sparse=always "build/image/$board/inlay.img" "$image"
place_of() { # number of a partition: its first sector and how many it has
	PATH=$PATH:/usr/sbin sfdisk -d "$image" |
		sed -n "s/.*img$1 : start= *\([0-9]*\), size= *\([0-9]*\),.*/\1 \2/p"
}
sum_of() { # number of a partition
	local start size
	read -r start size < <(place_of "$1")
	dd if="$image" bs=512 skip="$start" count="$size" status=none | sha256sum
}
before=$(sum_of 2)
[ "$board" != pc-x86_64 ] || shell_on_disk "$image" # its command line is on the disk
# Somebody's disk with the same names on it, which the kernel finds first.
decoy() { # file
	truncate -s 8M "$1"
	PATH=$PATH:/usr/sbin sfdisk -q "$1" <<-END
		label: gpt
		size=1MiB, name=INLAY
		size=1MiB, name=inlay-root
		size=1MiB, name=inlay-data
	END
}
decoy "$folder/decoy.img"
beside=(-drive "file=$folder/decoy.img,format=raw,if=none,id=decoy" -device "virtio-blk-pci,drive=decoy")
machine_start "$board" "$image" "$folder" "systemd.wants=inlay-shell@$tty.service"

up() { # READY=1 comes with the first picture that is on the screen
	shell "$patience" 'systemctl start inlay' # waits for the start that is under way
}
if ! up >"$folder/up"; then
	cat "$folder/up" "$folder/console.log" | tail -n 40 | not_ok "it comes to the picture"
	exit
fi
ok "it comes to the picture"
used=$(processor_time)
first_us=$(shell 60 'systemctl show inlay -p ActiveEnterTimestampMonotonic' | cut -d= -f2)
holds "that moment is known" "${first_us:-0} > 0"
echo "# $board: first composited frame $(awk "BEGIN { printf \"%.2f\", $first_us / 1e6 }") s after" \
	"the kernel started (budget on qemu-x86_64: 5 s), $used s of processor time;" \
	"$(nproc) processors, load $(cut -d' ' -f1 /proc/loadavg), acceleration ${ACCEL:-none}"
shell 60 'systemd-analyze --no-pager; systemd-analyze --no-pager critical-chain inlay.service' |
	sed 's/^/# /'
equal "nothing failed on the way" running "$(shell 60 'systemctl is-system-running --wait')"
equal "the kiosk is nobody special" inlay \
	"$(shell 60 'stat -c %U /proc/$(systemctl show -P MainPID inlay)')"
matches "the root is read-only" '^ro,' "$(shell 60 "awk '\$2 == \"/\" { print \$4 }' /proc/mounts")"
if shell 60 'touch /probe /etc/inlay/probe' >/dev/null; then
	echo "a file could be made" | not_ok "neither it nor the configuration can be written"
else
	ok "neither it nor the configuration can be written"
fi
equal "a keyboard gives the kernel no orders" 0 "$(shell 60 'cat /proc/sys/kernel/sysrq')"
# What the kernel makes of ctrl-alt-del, as often as would start the machine anew at once.
equal "nor does it start the machine anew" active \
	"$(shell 60 'for press in 1 2 3 4 5 6 7 8 9; do kill -INT 1; done; sleep 1; systemctl is-active inlay')"
[ "$board" != pc-x86_64 ] || matches "nor changes its command line" '^editor no$' \
	"$(mtype -i "$image@@1M" ::/loader/loader.conf)"
[ "$board" = qemu-x86_64 ] || {
	screendump "$folder/screen.ppm"
	check "its screen shows the demo" test "$("$BUILD/tests/vm/tools/picture" colour "$folder/screen.ppm" \
		600 300 80 80 | head -n 1)" != "0 0 0 0 0 0"
}

# ---- hung: the watchdog has it started again ----
shell 60 'kill -STOP $(systemctl show -P MainPID inlay)'
check "a kiosk that hangs is started again" \
	shell "$patience" 'until [ "$(systemctl show -P NRestarts inlay)" -ge 1 ]; do sleep 0.1; done'
check "and shows a picture again" up
# ---- switched off in order ----
shell 5 'systemctl poweroff' >/dev/null
check "it switches itself off in order" switched_off "$patience"
equal "the root is as it was delivered, bit for bit" "$before" "$(sum_of 2)"

# ---- on the partition of the state lies something else, and later systemd itself stands still ----
yes garbage | dd of="$image" bs=512 seek="$(place_of 3 | cut -d' ' -f1)" count=128 iflag=fullblock \
	conv=notrunc status=none
before=$(sum_of 3)
machine_start "$board" "$image" "$folder" "systemd.wants=inlay-shell@$tty.service"
check "it comes to the picture without a place for its state" up
matches "and says why" "holds no file system of the kiosk's" \
	"$(shell 60 'journalctl --no-pager -p err -u inlay-prepare')"
# Its driver may come after systemd first looked for one; systemd looks again from time to time.
check "systemd has taken the machine's watchdog" \
	shell "$patience" 'until ls -l /proc/1/fd | grep /dev/watchdog; do sleep 1; done'
# Where the processor is busy, one signal was seen to be without effect, and answers take their time: until
# there is none for long. The machine may be gone by then.
shell "$patience" 'until kill -SEGV 1; ! timeout 30 systemctl show -P Version; do sleep 2; done' >/dev/null
check "the machine's own watchdog starts it anew" switched_off "$patience"
matches "and nothing else does" '"event": "WATCHDOG"' "$(cat "$folder/monitor.log")"
equal "what lay there is untouched" "$before" "$(sum_of 3)"
