#!/bin/bash
# SPDX-License-Identifier: MIT
# Boots the images and holds them to what board/image/README.md promises; prints TAP.
#     INLAY=... BUILD=... tests/boot/run.sh [BOARD...]      (or BOARDS=; else qemu-x86_64)
# qemu-x86_64 is taken through everything; of the others it is shown that they come to the picture,
# or, for what QEMU cannot be, that what they hold is right. Everything left behind is in
# $BUILD/tests/boot/BOARD.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
# shellcheck disable=SC2086 # a list of words
[ $# -gt 0 ] || set -- ${BOARDS:-qemu-x86_64}
for board in "$@"; do
	case $board in
	raspberrypi) tests/boot/test_contents.sh "$board" ;;
	qemu-x86_64) tests/boot/test_archive.sh && tests/boot/test_mend.sh &&
		tests/boot/test_picture.sh "$board" && tests/boot/test_power.sh "$board" ;;
	*) tests/boot/test_picture.sh "$board" ;;
	esac || failed=1
done
[ -z "${failed:-}" ]
