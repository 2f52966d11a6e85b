#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds the image of one board from Debian packages and the programs: build/image/BOARD/inlay.img
#
#     BUILD=... board/image/image.sh BOARD        BUILD: the folder of the programs for that board
#
# The disk has three partitions (board/image/README.md says why):
#     INLAY        FAT   what the board boots from, kiosk.conf; mounted read-only
#     inlay-root   ext4  the system and the programs; never written
#     inlay-data   ext4  the state
# Everything is made by fakeroot: an ordinary user's image is the same as root's.
set -euo pipefail
cd "$(dirname "$0")/../.."
board=${1:?expected a board}
build=${BUILD:?is not set: expected the folder of the programs}
PATH=$PATH:/usr/sbin:/sbin
here=board/image
out=build/image/$board

fail() {
	echo "image: $*" >&2
	exit 1
}

[ -r "board/$board/board.sh" ] || fail "no board \"$board\": expected one of those in board/README.md"
for tool in mmdebstrap fakeroot sfdisk mkfs.ext4 mkfs.vfat mcopy; do
	command -v $tool >/dev/null ||
		fail "$tool is not installed: \`make image\` installs what it needs, or board/deps.sh image"
done

# What a board says of itself (board/qemu-x86_64/board.sh is the plainest):
architecture=  # Debian's word
packages=()    # besides board/image/packages
components=main
before=        # folder copied over the root before the packages are configured
config_mib=64  # of the partition INLAY
table=gpt      # or dos, for firmware that reads no other
# board_files ROOT BOOT OUT ROOT_ID: adds to the root, fills the partition INLAY (a folder), and leaves
# beside the image what its emulator needs. The kernel finds its root by PARTUUID=ROOT_ID.
board_files() { :; }
# shellcheck source=/dev/null
. "board/$board/board.sh"

# Every image has its own: a label may be on any stick that is plugged in.
if [ "$table" = gpt ]; then
	root_id=$(cat /proc/sys/kernel/random/uuid)
else
	disk_id=$(od -An -N4 -tx4 /dev/urandom | tr -d ' ')
	root_id=$disk_id-02
fi

mapfile -t shared < <(grep -v '^#' $here/packages)
base=$($here/debian.sh --for "$architecture" --components "$components" \
	${before:+--before "$before"} "${shared[@]}" "${packages[@]}")

mkdir -p "$out"
staging=$(mktemp -d "$out/.staging.XXXXXX")
trap 'rm -rf "$staging"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Runs under fakeroot, which remembers whose each file is.
fill() {
	local root=$staging/root boot=$staging/boot
	mkdir "$root" "$boot"
	tar -C "$root" -xf "$base"
	DESTDIR=$PWD/$root PREFIX=/usr board/install.sh install "$build" inlay
	cp -r --no-preserve=ownership $here/root/. "$root/"
	echo inlay >"$root/etc/hostname"
	printf '127.0.0.1 localhost inlay\n::1 localhost\n' >"$root/etc/hosts"
	rm -f "$root/etc/resolv.conf"
	rm -rf "$root/var/log" "$root/var/tmp"
	ln -s ../run/log "$root/var/log" # nothing below the root is written
	ln -s ../tmp "$root/var/tmp"
	: >"$root/etc/machine-id" # one for each boot, in memory
	rm -rf "$root"/var/cache/{apt,debconf,fontconfig}/* "$root"/var/lib/apt/lists/* \
		"$root"/boot/initrd.img*.old
	systemd-sysusers --root="$root"
	local unit
	while read -r unit; do
		ln -sf /dev/null "$root/etc/systemd/system/$unit"
	done < <(grep -v '^#' $here/masked-units)
	# Nothing is written by hand in tables that these would read; debug's is the command line's.
	local generator
	mkdir -p "$root/etc/systemd/system-generators"
	for generator in "$root"/usr/lib/systemd/system-generators/*; do
		case ${generator##*/} in
		systemd-debug-generator | systemd-run-generator) ;;
		*) ln -s /dev/null "$root/etc/systemd/system-generators/${generator##*/}" ;;
		esac
	done
	ln -sf inlay.target "$root/etc/systemd/system/default.target"
	fc-cache -s -y "$PWD/$root" 2>/dev/null || true # else each start would look through all fonts

	mkdir -p "$root/usr/share/inlay/demo" "$root/etc/inlay" "$root/var/lib/inlay"
	cp build/image/demo/{cow.inlay,fisheye.y4m,background.y4m} "$root/usr/share/inlay/demo/"
	cp $here/demo.conf "$root/etc/inlay/kiosk.conf"
	cp $here/demo.conf "$boot/kiosk.conf"
	cp $here/INLAY.txt "$boot/README.txt"
	board_files "$root" "$boot" "$staging" "$root_id"

	local owner
	owner=$(awk -F: '$1 == "inlay" { print $3 ":" $4 }' "$root/etc/passwd")
	[ -n "$owner" ] || fail "the programs brought no user inlay (sysusers)"
	# Its block size says where the copy of its superblock is that usr/lib/inlay/mend looks at.
	mkfs.ext4 -q -F -b 1024 -m 0 -L inlay-data -E "root_owner=$owner" "$staging/data.ext4" 64M
	# No journal: nothing is ever written. Room for nothing more, either.
	mkfs.ext4 -q -F -m 0 -L inlay-root -O ^has_journal,^metadata_csum_seed -d "$root" \
		"$staging/root.ext4" $(($(du -s --apparent-size -m "$root" | cut -f1) * 23 / 20 + 16))M
	truncate -s "${config_mib}M" "$staging/boot.fat"
	mkfs.vfat -F 32 -n INLAY "$staging/boot.fat" >/dev/null
	mcopy -s -m -Q -i "$staging/boot.fat" "$boot"/* ::/
}

# Every library that the programs name must be in the root: a list of packages forgets quietly.
linked() {
	local library missing=""
	for library in $(readelf -d "$build/inlay" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
		[ -n "$(find "$staging/root/usr/lib" -name "$library" -print -quit)" ] ||
			missing="$missing $library"
	done
	[ -z "$missing" ] || fail "no package in $here/packages brings$missing"
}

# The parts, one MiB apart at least, behind one partition table.
assemble() {
	local image=$staging/inlay.img at=1 part size types=(U L L)
	local names=(INLAY inlay-root inlay-data) script="label: $table"
	[ "$table" = gpt ] || { types=(c L L) && script+=$'\n'"label-id: 0x$disk_id"; }
	local parts=(boot.fat root.ext4 data.ext4) i
	for i in 0 1 2; do
		part=$staging/${parts[i]}
		size=$((($(stat -c %s "$part") + 1048575) / 1048576))
		script+=$'\n'"start=${at}MiB, size=${size}MiB, type=${types[i]}"
		[ "$table" != gpt ] || script+=", name=${names[i]}"
		[ "$table.$i" != gpt.1 ] || script+=", uuid=$root_id"
		dd if="$part" of="$image" bs=1M seek=$at conv=sparse,notrunc status=none
		at=$((at + size))
	done
	truncate -s $((at + 1))M "$image"
	sfdisk -q "$image" <<<"$script"
}

echo "  IMAGE   $out/inlay.img"
export board build here staging base config_mib root_id
fakeroot bash -euo pipefail -c "$(declare -f fail fill board_files); fill"
linked
assemble
rm -rf "${staging:?}"/{root,boot} "$staging"/*.ext4 "$staging"/*.fat
mv -f "$staging"/* "$out/"
