# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced: how QEMU is told to be the board, in $emulator. KVM is used where it is there and wanted
# (ACCEL=kvm); plain emulation is the rule, because it works everywhere alike.
#
#     emulator_of BOARD IMAGE FOLDER [WORD...]
#
# FOLDER: where `make image` left the image's companions (a kernel). WORDs go to the kernel's command
# line, for boards whose kernel QEMU is given directly.
# shellcheck disable=SC2054 # the commas are QEMU's
emulator_of() {
	local board=$1 image=$2 folder=$3
	shift 3
	local root line
	root=$(PATH=$PATH:/usr/sbin sfdisk --part-uuid "$image" 2) || return
	line="quiet panic=-1 root=PARTUUID=${root,,} ro rootfstype=ext4 rootwait $*"
	local firmware=/usr/share/OVMF disk="file=$image,format=raw,if=none,id=disk"

	case $board in
	qemu-x86_64)
		emulator=(qemu-system-x86_64 -accel "${ACCEL:-tcg,thread=multi}" -cpu max
			-kernel "$folder/kernel"
			-append "console=ttyS0 mitigations=off init=/usr/lib/systemd/systemd $line"
			-device virtio-blk-pci,drive=disk -device i6300esb)
		;;
	pc-x86_64) # a stick in a PC with UEFI
		emulator=(qemu-system-x86_64 -accel "${ACCEL:-tcg,thread=multi}" -cpu max -machine q35
			-drive "if=pflash,format=raw,readonly=on,file=$firmware/OVMF_CODE_4M.fd"
			-drive "if=pflash,format=raw,snapshot=on,file=$firmware/OVMF_VARS_4M.fd"
			-device qemu-xhci -device usb-storage,drive=disk
			-global ICH9-LPC.noreboot=off) # its watchdog may start it anew
		;;
	qemu-arm64)
		emulator=(qemu-system-aarch64 -accel "${ACCEL:-tcg,thread=multi}" -machine virt
			-cpu cortex-a72 -kernel "$folder/kernel" -initrd "$folder/initrd"
			-append "console=ttyAMA0 $line" -device virtio-blk-pci,drive=disk
			-device i6300esb)
		;;
	*)
		echo "emulator: QEMU cannot be a $board: expected qemu-x86_64, pc-x86_64 or qemu-arm64" >&2
		return 1
		;;
	esac
	emulator+=(-smp 2 -m 1024 -nodefaults -no-reboot -drive "$disk")
}
