# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034
# QEMU's generic 64-bit Arm machine ("virt"): Debian's kernel and initramfs, given to QEMU directly.
architecture=arm64
packages=(linux-image-arm64 initramfs-tools)
before=board/image/initramfs

board_files() { # root, boot, out
	cp "$1"/boot/vmlinuz-* "$3/kernel"
	cp "$1"/boot/initrd.img-* "$3/initrd"
	rm -rf "${1:?}"/boot/* "$1"/vmlinuz* "$1"/initrd.img*
}
