#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds inlay for the machine that an image is for.
#     board/image/programs.sh ARCH BUILD [MAKE ARGUMENT...]
# For a foreign machine: Debian's cross compiler, against headers and libraries that are unpacked
# from that machine's own packages (in ~/.cache/inlay) and never run.
set -euo pipefail
cd "$(dirname "$0")/../.."
architecture=$1 build=$2
shift 2
arguments=("$@" "BUILD=$build")

if [ "$architecture" != "$(dpkg --print-architecture)" ]; then
	triplet=$(dpkg-architecture -a"$architecture" -qDEB_HOST_MULTIARCH)
	mapfile -t headers < <(grep -v '^#' board/image/headers)
	tar=$(board/image/debian.sh --for "$architecture" --unconfigured "${headers[@]}")
	sysroot=${tar%.tar}
	if [ ! -d "$sysroot" ]; then
		staging=$(mktemp -d "$sysroot.XXXXXX")
		trap 'rm -rf "$staging"' EXIT
		tar -C "$staging" --exclude=./dev -xf "$tar"
		# Links that say "from the root" would lead out of it.
		find "$staging" -type l -lname '/*' | while read -r link; do
			ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" \
				"$staging$(readlink "$link")")" "$link"
		done
		chmod 755 "$staging"
		mv -T "$staging" "$sysroot"
	fi
	libraries=$sysroot/usr/lib/$triplet
	export PKG_CONFIG_SYSROOT_DIR=$sysroot
	export PKG_CONFIG_LIBDIR=$libraries/pkgconfig:$sysroot/usr/share/pkgconfig
	arguments+=("CC=$triplet-gcc" "CXX=$triplet-g++" "CFLAGS=--sysroot=$sysroot"
		"CXXFLAGS=--sysroot=$sysroot" "AR=$triplet-ar"
		"LDFLAGS=--sysroot=$sysroot -Wl,-rpath-link,$libraries"
		"RUNNER=$(command -v "qemu-$(dpkg-architecture -a"$architecture" \
			-qDEB_HOST_GNU_CPU)-static") -L $sysroot")
fi
make --no-print-directory -j"$(nproc)" "${arguments[@]}" image-programs
