#!/bin/bash
# SPDX-License-Identifier: MIT
# Starts a board's image in QEMU: its screen in a window where there is a desktop, a root's shell on
# this terminal (board qemu-x86_64, qemu-arm64). What is changed in the machine is forgotten.
#     board/image/boot.sh BOARD
set -euo pipefail
cd "$(dirname "$0")/../.."
board=${1:?expected a board}
. board/image/emulator.sh
[ -e "build/image/$board/inlay.img" ] || {
	echo "boot: build/image/$board/inlay.img is not there: make image BOARD=$board" >&2
	exit 1
}
tty=ttyS0
[ "$board" != qemu-arm64 ] || tty=ttyAMA0
emulator_of "$board" "build/image/$board/inlay.img" "build/image/$board" \
	"systemd.wants=inlay-shell@$tty.service"
display=none
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
	if "${emulator[0]}" -display help | grep -q gtk; then
		display=gtk
	else
		echo "boot: no window without Debian's package qemu-system-gui" >&2
	fi
fi
echo "boot: ctrl-a x ends the machine" >&2
exec "${emulator[@]}" -snapshot -display "$display" -vga none -device virtio-gpu-pci \
	-serial mon:stdio
