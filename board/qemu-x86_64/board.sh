# SPDX-License-Identifier: MIT
# shellcheck shell=bash disable=SC2034
# The simulated PC: the kernel that the device tests use, given to QEMU directly.
architecture=amd64

board_files() { # root, boot, out
	local kernel
	kernel=$(board/build-kernel.sh qemu-x86_64)
	cp -r "$kernel/modules/lib/modules" "$1/usr/lib/"
	cp "$kernel/bzImage" "$3/kernel"
	# What the kiosk's unit has loaded is built in.
	ln -s /dev/null "$1/etc/systemd/system/modprobe@drm.service"
	ln -s /dev/null "$1/etc/systemd/system/modprobe@videodev.service"
}
