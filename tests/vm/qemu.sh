#!/bin/bash
# SPDX-License-Identifier: MIT
# The simulated machine in QEMU (no KVM needed): a kernel of its own, an initramfs of busybox and
# guest/init, the host's files over 9p. boot.sh says how it is called.
# shellcheck source=tests/vm/boot.sh
. "$(dirname "$0")/boot.sh"

kernel=$("$source_dir/board/build-kernel.sh" qemu-x86_64)
write_start "$@" >"$job/start"

# The initramfs: busybox and the script beside this one.
mkdir -p "$scratch/root/bin"
cp /bin/busybox "$scratch/root/bin/busybox"
install -m 755 "$here/guest/init" "$scratch/root/init"
(cd "$scratch/root" && find . | cpio -o -H newc -R 0:0 --quiet | gzip -1) >"$scratch/initramfs"

comma() { # QEMU's options write a comma in a value as two
	printf '%s' "${1//,/,,}"
}

# What the guest writes to its second serial port is read by QEMU's own monitor (QMP, one command a
# line), whose answers are left in the job folder: a test photographs the screen by itself.
mkfifo "$scratch/monitor.in"
ln -s "$job/monitor.log" "$scratch/monitor.out"
echo >"$job/monitor.log"

# no_timer_check: on a busy host the kernel would find its timer too slow to be one, and stop.
# The guest's fourth serial port is for QEMU's own VNC server, to which a test connects it: it asks for
# a window of another size, which to virtio-gpu is another screen, or for none. (The third would share
# its interrupt with the first, which is always open; this one does with the second.)
boot qemu-system-x86_64 \
	-accel "tcg,thread=multi" -cpu max -smp 2 -m 1024 \
	-nodefaults -no-reboot -display none -vga none -device "virtio-gpu-pci,id=gpu,max_outputs=2" \
	-kernel "$kernel/bzImage" -initrd "$scratch/initramfs" \
	-append "console=ttyS0 quiet panic=-1 mitigations=off no_timer_check -- qemu" \
	-virtfs "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap" \
	-virtfs "local,path=$(comma "$job"),mount_tag=job,security_model=none" \
	-chardev "stdio,id=console,signal=off" -serial chardev:console \
	-chardev "pipe,id=monitor,path=$scratch/monitor" -mon "chardev=monitor,mode=control" \
	-chardev "file,id=guest,path=$scratch/monitor.in" -serial chardev:guest -serial null \
	-chardev "null,id=window" -vnc "unix:$scratch/window" -serial chardev:window
