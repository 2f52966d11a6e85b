# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034
# A Raspberry Pi: its firmware reads the FAT partition, starts Debian's kernel and hands it the
# device tree of the model that it finds.
architecture=arm64
components="main non-free-firmware"
packages=(linux-image-arm64 initramfs-tools raspi-firmware)
before=board/image/initramfs
config_mib=512
table=dos # which every model reads

board_files() { # root, boot, out, root_id
	cp "$1"/usr/lib/raspi-firmware/{start4.elf,fixup4.dat} "$2/"
	cp "$1"/usr/lib/linux-image-*/broadcom/bcm27*-rpi-*.dtb "$2/"
	[ -e "$2/bcm2711-rpi-4-b.dtb" ] || fail "the kernel has no device tree of a Raspberry Pi 4"
	cp "$1"/boot/vmlinuz-* "$2/vmlinuz"
	cp "$1"/boot/initrd.img-* "$2/initrd.img"
	rm -rf "${1:?}"/boot/* "$1"/vmlinuz* "$1"/initrd.img*
	cat >"$2/config.txt" <<-END
		# The firmware's own settings.
		arm_64bit=1
		kernel=vmlinuz
		initramfs initrd.img followkernel
		upstream_kernel=1
		enable_uart=1
		disable_splash=1
		disable_overscan=1
	END
	echo "root=PARTUUID=$4 ro rootfstype=ext4 rootwait quiet loglevel=3" \
		"vt.global_cursor_default=0 console=tty1 panic=10" >"$2/cmdline.txt"
}
