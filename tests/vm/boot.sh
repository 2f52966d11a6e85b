#!/bin/bash
# SPDX-License-Identifier: MIT
# Boots the simulated machine and runs a command in it, as root, on the host's own files (read-only
# below, whatever is written above them is forgotten).
#
#     boot.sh [--shell] [--seconds LIMIT] JOB COMMAND...
#
# JOB is a folder that both see (the guest as /run/job); console.log is left there. Exit code: the
# command's, 124 when the limit passed and the machine was switched off, 125 when it stopped
# before the command ended. --shell connects the terminal to the machine's serial port.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
shell=0
limit=1200

while :; do
	case "${1:-}" in
	--shell) shell=1 ;;
	--seconds)
		limit=$2
		shift
		;;
	*) break ;;
	esac
	shift
done
mkdir -p "$1"
job=$(cd "$1" && pwd)
shift

kernel=$("$source_dir/board/qemu-x86_64/build-kernel.sh")

scratch=$(mktemp -d /tmp/inlay-vm.XXXXXX)
qemu=
stop() {
	if [ -n "$qemu" ]; then
		kill "$qemu" 2>/dev/null || true # timeout hands it on to QEMU
	fi
	rm -rf "$scratch"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Whole, because a configuration elsewhere names files in it, too.
[ -z "${BUILD:-}" ] || BUILD=$(cd "$source_dir" && realpath -ms "$BUILD")

# What the guest's first script needs to know, quoted by bash for bash.
{
	echo "export VM_KERNEL=$(printf %q "$kernel")"
	echo "export VM_JOB_OUTSIDE=$(printf %q "$job")"
	echo "export VM_WINDOW=$scratch/window"
	for name in BUILD INLAY INLAY_BAKE INLAY_SHARED_DATA; do
		[ -z "${!name:-}" ] || echo "export $name=$(printf %q "${!name}")"
	done
	echo "export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/run"
	echo "export LC_ALL=C.UTF-8 XDG_RUNTIME_DIR=/run TMPDIR=/run"
	echo "cd $(printf %q "$source_dir")"
	printf '%q ' "$@"
	echo
	echo 'echo $? >/run/job/exit-code'
} >"$job/start"
rm -f "$job/exit-code"

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
options=(
	-accel "tcg,thread=multi" -cpu max -smp 2 -m 1024
	-nodefaults -no-reboot -display none -vga none -device "virtio-gpu-pci,id=gpu,max_outputs=2"
	-kernel "$kernel/bzImage" -initrd "$scratch/initramfs"
	-append "console=ttyS0 quiet panic=-1 mitigations=off no_timer_check"
	-virtfs "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap"
	-virtfs "local,path=$(comma "$job"),mount_tag=job,security_model=none"
	-chardev "pipe,id=monitor,path=$scratch/monitor" -mon "chardev=monitor,mode=control"
	-chardev "file,id=guest,path=$scratch/monitor.in"
	-chardev "null,id=window" -vnc "unix:$scratch/window"
)

if [ "$shell" = 1 ]; then
	qemu-system-x86_64 "${options[@]}" -chardev stdio,id=console,signal=off \
		-serial chardev:console -serial chardev:guest \
		-serial null -serial chardev:window
else
	# In the background, so that a signal to this script is acted on at once.
	timeout --signal=KILL "$limit" qemu-system-x86_64 "${options[@]}" \
		-serial "file:$job/console.log" -serial chardev:guest \
		-serial null -serial chardev:window \
		</dev/null >"$job/qemu.log" 2>&1 &
	qemu=$!
	code=0
	wait "$qemu" || code=$?
	qemu=
	if [ "$code" -eq 137 ]; then
		echo "boot: the machine was switched off after $limit s" >&2
		exit 124
	fi
	[ "$code" -eq 0 ] || cat "$job/qemu.log" >&2
fi

if [ ! -s "$job/exit-code" ]; then
	echo "boot: the machine stopped before its work was done; see $job/console.log" >&2
	exit 125
fi
exit "$(cat "$job/exit-code")"
