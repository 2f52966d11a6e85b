#!/bin/bash
# SPDX-License-Identifier: MIT
# An image that QEMU cannot start: what is on its partitions, and its own program at work under
# qemu-user, which must make the same picture as this machine's, bit for bit.
#     test_contents.sh BOARD
. tests/vm/guest/tap.sh
. tests/boot/scene.sh
board=$1
PATH=$PATH:/usr/sbin:/sbin
image=build/image/$board/inlay.img
folder=$BUILD/tests/boot/$board
rm -rf "$folder"
mkdir -p "$folder"

has() { # file on INLAY
	mdir -b -i "$image@@1M" "::/$1"
}
for file in config.txt cmdline.txt start4.elf fixup4.dat bcm2711-rpi-4-b.dtb vmlinuz initrd.img \
	kiosk.conf; do
	check "the firmware's partition has $file" has $file
done
matches "it starts the kernel that is there" '^kernel=vmlinuz' \
	"$(mtype -i "$image@@1M" ::/config.txt)"
table=$(sfdisk -d "$image")
matches "and that finds its root on this image, not on one of the same label" \
	"root=PARTUUID=$(sed -n 's/^label-id: 0x//p' <<<"$table")-02 ro" \
	"$(mtype -i "$image@@1M" ::/cmdline.txt)"
matches "a partition table that every model reads" '^label: dos' "$table"

read -r start size < <(sed -n 's/.*img2 : start= *\([0-9]*\), size= *\([0-9]*\),.*/\1 \2/p' <<<"$table")
dd if="$image" bs=512 skip="$start" count="$size" status=none conv=sparse of="$folder/root.ext4"
check "the root is sound" e2fsck -f -n "$folder/root.ext4"
root=$folder/root
mkdir "$root"
fakeroot debugfs -R "rdump / $root" "$folder/root.ext4" >"$folder/rdump" 2>&1
equal "its systemd starts the kiosk" inlay.target \
	"$(readlink "$root/etc/systemd/system/default.target")"
check "its kernel has the driver of the machine's watchdog" \
	grep -q '/bcm2835_wdt\.ko' "$root"/usr/lib/modules/*/modules.dep
check "which its systemd feeds" grep -q '^RuntimeWatchdogSec=' "$root/etc/systemd/system.conf.d/inlay.conf"
equal "a keyboard cannot start it anew" /dev/null \
	"$(readlink "$root/etc/systemd/system/ctrl-alt-del.target")"
check "nor give its kernel orders" grep -q '^kernel.sysrq = 0$' "$root/etc/sysctl.d/inlay.conf"

arm() {
	qemu-aarch64-static -cpu cortex-a72 -L "$root" "$root/usr/bin/inlay" "$@"
}
matches "its inlay runs on a Raspberry Pi 4's processor" '^inlay [0-9]' "$(arm --version 2>&1)"
demo=$root/usr/share/inlay/demo
sed "s|/usr/share|$(realpath "$root")&|" "$root/etc/inlay/kiosk.conf" >"$folder/kiosk.conf"
check "it finds nothing wrong with its configuration" arm check --config "$folder/kiosk.conf"

still_scene_pictures "$folder"
compose() {
	local out=$1
	shift
	"$@" still --config board/image/demo.conf --basis "$demo/cow.inlay" \
		--fisheye "$folder/fisheye.png" --background "$folder/background.png" -o "$out"
}
check "it composites" compose "$folder/arm.png" arm
check "so does this machine's" compose "$folder/here.png" "$INLAY"
check "both are the same, bit for bit" cmp "$folder/arm.png" "$folder/here.png"
