# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Sourced by uml.sh and qemu.sh: what both simulated machines have in common. Each boots and runs a
# command in it, as root, on the host's own files (read-only below, whatever is written above them is
# forgotten).
#
#     uml.sh|qemu.sh [--shell] [--seconds LIMIT] JOB COMMAND...
#
# JOB is a folder that both see (the guest as /run/job); console.log is left there. Exit code: the
# command's, 124 when the limit passed and the machine was switched off, 125 when it stopped
# before the command ended. --shell connects the terminal to the machine's console.
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

scratch=$(mktemp -d /tmp/inlay-vm.XXXXXX)
machine=
stop() {
	if [ -n "$machine" ]; then
		kill "$machine" 2>/dev/null || true # timeout hands it on to the machine
		wait "$machine" 2>/dev/null || true
	fi
	rm -rf "$scratch"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

kernel= # its folder; the machine sets it
# Whole, because a configuration elsewhere names files in it, too.
[ -z "${BUILD:-}" ] || BUILD=$(cd "$source_dir" && realpath -ms "$BUILD")

# write_start COMMAND...: what the guest's first script needs to know, quoted by bash for bash.
write_start() {
	echo "export VM_KERNEL=$(printf %q "$kernel")"
	echo "export VM_JOB_OUTSIDE=$(printf %q "$job")"
	echo "export VM_WINDOW=$scratch/window"
	for name in BUILD INLAY INLAY_BAKE INLAY_CALIBRATE INLAY_SHARED_DATA INLAY_SEED VM_PATIENCE; do
		[ -z "${!name:-}" ] || echo "export $name=$(printf %q "${!name}")"
	done
	echo "export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/run"
	echo "export LC_ALL=C.UTF-8 XDG_RUNTIME_DIR=/run TMPDIR=/run"
	echo "cd $(printf %q "$source_dir")"
	printf '%q ' "$@"
	echo
	echo 'echo $? >/run/job/exit-code'
}

# boot MACHINE...: runs it until it stops, and leaves with the exit code that its command left.
boot() {
	local code=0
	if [ "$shell" = 1 ]; then
		"$@" || code=$?
	else
		# In the background, so that a signal to this script is acted on at once.
		timeout --kill-after=20 "$limit" "$@" </dev/null >"$job/console.log" 2>&1 &
		machine=$!
		wait "$machine" || code=$?
		machine=
	fi
	if [ "$code" -eq 124 ] || [ "$code" -eq 137 ]; then
		echo "boot: the machine was switched off after $limit s" >&2
		exit 124
	fi
	if [ ! -s "$job/exit-code" ]; then
		echo "boot: the machine stopped before its work was done; see $job/console.log" >&2
		exit 125
	fi
	exit "$(cat "$job/exit-code")"
}
