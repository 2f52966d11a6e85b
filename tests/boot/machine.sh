# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by the boot tests: one machine at a time, booted from an image, with a root's shell on its
# second serial port and QEMU's monitor beside it.
. board/image/emulator.sh

machine= # process id of QEMU
beside=() # QEMU's words for what else is plugged in, found before the disk

# machine_start BOARD IMAGE OUT [KERNEL WORD...]: what it says is left in OUT.
machine_start() {
	local board=$1 image=$2
	out=$3
	shift 3
	mkdir -p "$out"
	rm -f "$out"/{shell,monitor}.{in,out}
	mkfifo "$out"/{shell,monitor}.in
	for log in shell monitor; do
		: >"$out/$log.log"
		ln -s "$log.log" "$out/$log.out"
	done
	exec 7<>"$out/shell.in" 8<>"$out/monitor.in"
	# On a busy host the kernel would find its timer too slow to be one, and stop.
	[ "$board" != qemu-x86_64 ] || set -- no_timer_check "$@"
	emulator_of "$board" "$image" "build/image/$board" "$@" || return 1
	local second=(-serial chardev:shell)
	[ "$board" != qemu-arm64 ] || second=(-device "pci-serial,chardev=shell") # it has only one
	"${emulator[0]}" "${beside[@]}" "${emulator[@]:1}" -display none -vga none -device virtio-gpu-pci \
		-serial "file:$out/console.log" \
		-chardev "pipe,id=shell,path=$out/shell" "${second[@]}" \
		-chardev "pipe,id=monitor,path=$out/monitor" -mon chardev=monitor,mode=control \
		</dev/null >"$out/qemu.log" 2>&1 7>&- 8>&- &
	machine=$!
	echo '{"execute":"qmp_capabilities"}' >&8
	echo 0 >"$out/asked"
}

alive() {
	kill -0 "$machine" 2>/dev/null
}

# within SECONDS COMMAND...: tries until it succeeds; fails at the limit, or when the machine is gone.
within() {
	local limit=$((SECONDS + $1))
	shift
	until "$@"; do
		[ $SECONDS -lt $limit ] && alive || return 1
		sleep 0.1
	done
}

# shell SECONDS COMMAND: runs it in the machine, prints what it prints, returns its exit code.
shell() {
	within "$1" grep -q 'inlay# ' "$out/shell.log" || {
		echo "no shell within $1 s"
		return 124
	}
	local asked=$(($(cat "$out/asked") + 1)) # in a file: shell is called in subshells too
	echo $asked >"$out/asked"
	# The terminal echoes the command: its marks must not look like those that are printed. What was typed
	# ahead has its prompt before the first of them.
	printf 'echo "<""begun %d>"; { %s\n} 2>&1; echo "<""ended %d $?>"\n' $asked "$2" $asked >&7
	within "$1" grep -q "^<ended $asked [0-9]*>" "$out/shell.log" || {
		echo "no answer within $1 s to: $2"
		return 124
	}
	tr -d '\r' <"$out/shell.log" |
		sed -e "1,/<begun $asked>/d" -e "/^<ended $asked /,\$d"
	return "$(sed -n "s/^<ended $asked \([0-9]*\)>.*/\1/p" "$out/shell.log")"
}

# shell_on_disk IMAGE: the same for a board whose kernel's command line lies on its disk.
shell_on_disk() {
	local entry
	entry=$(mtype -i "$1@@1M" ::/loader/entries/inlay.conf) || return
	sed '/^options/s/$/ console=ttyS0 systemd.wants=inlay-shell@ttyS1.service/' <<<"$entry" |
		mcopy -o -i "$1@@1M" - ::/loader/entries/inlay.conf
}

# screendump FILE.ppm
screendump() {
	rm -f "$1"
	echo "{\"execute\":\"screendump\",\"arguments\":{\"filename\":\"$(realpath -m "$1")\"}}" >&8
	within 10 test -s "$1"
}

# Processor time that the emulator has taken so far, in seconds: unlike the clock, hardly a matter of
# what else the host does.
processor_time() {
	awk -v hertz="$(getconf CLK_TCK)" '{ printf "%.1f", ($14 + $15) / hertz }' "/proc/$machine/stat"
}

power_cut() {
	kill -KILL "$machine" 2>/dev/null
	wait "$machine" 2>/dev/null
	machine=
}

# The machine switches itself off.
switched_off() { # seconds
	local limit=$((SECONDS + $1))
	while alive; do
		[ $SECONDS -lt $limit ] || return 1
		sleep 0.1
	done
	wait "$machine" 2>/dev/null
	machine=
}

machine_end() {
	[ -z "$machine" ] || power_cut
}
