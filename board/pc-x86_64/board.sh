# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034
# A PC that starts from a stick by UEFI: Debian's kernel behind systemd's boot loader.
architecture=amd64
components="main non-free-firmware"
packages=(linux-image-amd64 initramfs-tools systemd-boot-efi firmware-amd-graphics
	firmware-misc-nonfree)
before=board/image/initramfs
config_mib=512 # of which a basis file takes most

board_files() { # root, boot, out, root_id
	mkdir -p "$2/EFI/BOOT" "$2/loader/entries"
	cp "$1/usr/lib/systemd/boot/efi/systemd-bootx64.efi" "$2/EFI/BOOT/BOOTX64.EFI"
	cp "$1"/boot/vmlinuz-* "$2/vmlinuz"
	cp "$1"/boot/initrd.img-* "$2/initrd"
	rm -rf "${1:?}"/boot/* "$1"/vmlinuz* "$1"/initrd.img*
	# A space held down while it starts opens the menu. The command line is not for whoever has a
	# keyboard: it can open a root's shell.
	printf 'timeout 0\neditor no\n' >"$2/loader/loader.conf"
	cat >"$2/loader/entries/inlay.conf" <<-END
		title inlay
		linux /vmlinuz
		initrd /initrd
		options root=PARTUUID=$4 ro rootfstype=ext4 quiet loglevel=3 vt.global_cursor_default=0 panic=10
	END
}
