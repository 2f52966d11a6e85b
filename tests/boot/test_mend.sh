#!/bin/bash
# SPDX-License-Identifier: MIT
# What an image does with a partition of the state that cannot be mounted, on files that stand for
# partitions: what is the kiosk's own is mended, and nothing else is written to.
#     test_mend.sh
. tests/vm/guest/tap.sh
PATH=$PATH:/usr/sbin:/sbin
folder=${BUILD:?is not set: expected a folder to write in}/tests/boot/mend
rm -rf "$folder"
mkdir -p "$folder/bin"
partition=$folder/partition

# Whether a file system was made is also seen where nothing could have been written.
cat >"$folder/bin/mkfs.ext4" <<-'END_'
	#!/bin/sh
	echo "$@" >>"$MADE"
	exec /usr/sbin/mkfs.ext4 "$@"
END_
chmod 755 "$folder/bin/mkfs.ext4"

mend() { # partition
	: >"$folder/made"
	MADE=$folder/made PATH=$folder/bin:$PATH board/image/root/usr/lib/inlay/mend "$1" \
		>"$folder/log" 2>&1
}
empty() {
	rm -f "$partition"
	truncate -s 64M "$partition"
}
with_state() { # mkfs.ext4 option...: a partition as board/image/image.sh makes it, with a state in it
	empty
	mkfs.ext4 -q -F -b 1024 -m 0 -L inlay-data "$@" "$partition" &&
		echo "threshold = 96" >"$folder/state" &&
		debugfs -w -R "write $folder/state state" "$partition" >/dev/null 2>&1
}
garbage() { # first KiB, number of KiB
	yes garbage 2>/dev/null |
		dd of="$partition" bs=1024 seek="$1" count="$2" iflag=fullblock conv=notrunc status=none
}
mended() { # description
	if mend "$partition" && e2fsck -f -n "$partition" >>"$folder/log" 2>&1 &&
		[ ! -s "$folder/made" ] &&
		[ "$(debugfs -R 'cat state' "$partition" 2>/dev/null)" = "threshold = 96" ]; then
		ok "$1"
	else
		not_ok "$1" <"$folder/log"
	fi
}
refused() { # description, reason
	local before
	before=$(sha256sum <"$partition")
	if mend "$partition"; then
		not_ok "$1: it says so" <"$folder/log"
	fi
	matches "$1: it says why" "^<3>$partition $2: it is left as it is\$" "$(cat "$folder/log")"
	equal "$1: nothing is written" "$before" "$(sha256sum <"$partition")"
}

with_state
mended "one that is sound is left so"
with_state
garbage 3 30
mended "a table of groups that a power cut has spoilt is mended, and the state kept"
with_state
garbage 1 1
mended "so is a superblock"
with_state
debugfs -w -R "feature FEATURE_I31" "$partition" >/dev/null 2>&1
refused "a feature that this version does not know" "cannot be mended"
with_state -L somebody
refused "somebody's file system" "holds no file system of the kiosk's"
empty
mkfs.vfat -n STICK "$partition" >/dev/null
refused "a file system of another kind" "holds no file system of the kiosk's"
empty
garbage 0 64
refused "what is not known" "holds no file system of the kiosk's"
empty
garbage 1023 1
refused "a first MiB that is not empty to its end" "holds no file system of the kiosk's"

empty
check "on an empty partition a file system is made" mend "$partition"
equal "which is the kiosk's" "inlay-data" "$(blkid -p -o value -s LABEL "$partition")"

# Reading this file fails with an I/O error, and blkid says of it what it says of an empty disk.
if mend /proc/self/mem; then
	not_ok "a partition that cannot be read: it says so" <"$folder/log"
fi
matches "a partition that cannot be read: it says why" '^<3>/proc/self/mem cannot be read' \
	"$(cat "$folder/log")"
equal "no file system is made there" "" "$(cat "$folder/made")"
