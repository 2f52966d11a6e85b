#!/bin/sh
# SPDX-License-Identifier: MIT
# Sees to it that this kernel runs another architecture's programs, by qemu-user-static.
#     board/image/foreign.sh arm64
set -eu
case $1 in
arm64) name=qemu-aarch64 ;;
*)
	echo "foreign: \"$1\" is unknown, expected arm64" >&2
	exit 2
	;;
esac
table=/proc/sys/fs/binfmt_misc
if [ "$(id -u)" = 0 ] && [ ! -e $table/register ]; then
	mount -t binfmt_misc binfmt_misc $table
fi
[ ! -e $table/$name ] || exit 0
line=$(cat "/usr/lib/binfmt.d/$name.conf" 2>/dev/null) || {
	echo "foreign: /usr/lib/binfmt.d/$name.conf is not there: expected package qemu-user-static" >&2
	exit 1
}
if ! printf '%s' "$line" >$table/register; then
	echo "foreign: this kernel is not told yet how to run $1 programs: as root, once," >&2
	echo "    systemctl restart systemd-binfmt    (or $0 $1)" >&2
	exit 1
fi 2>/dev/null
