#!/bin/bash
# SPDX-License-Identifier: MIT
# The Debian packages of what was built in BUILD, into OUT: OUT/inlay_VERSION_ARCH.deb and
# OUT/inlay-bake_VERSION_ARCH.deb.
#     SOURCE_DATE_EPOCH=... board/debian/build.sh BUILD VERSION ARCH OUT
# The same programs make the same packages, bit for bit, whoever calls this, when and where.
set -euo pipefail
: "${SOURCE_DATE_EPOCH:?the date of what is packed}"
export SOURCE_DATE_EPOCH
build=$1 version=$2 arch=$3 out=$4
here=$PWD/board/debian
export LC_ALL=C.UTF-8 TZ=UTC DEB_HOST_ARCH=$arch
umask 022
kind=$(dpkg-architecture -a"$arch" -qDEB_HOST_GNU_TYPE 2>/dev/null)
stage=$PWD/$build/stage
rm -rf "$stage"
mkdir -p "$stage/debian" "$out"

# Whoever gives the packages to others puts a name and an address in place of control's.
maintainer=${DEB_MAINTAINER:-$(sed -n 's/^Maintainer: //p' "$here/control")}

# What dpkg-gencontrol and dpkg-shlibdeps read: a source folder with nothing but these.
sed "s|^Maintainer: .*|Maintainer: $maintainer|" "$here/control" >"$stage/debian/control"
cat >"$stage/debian/changelog" <<-CHANGES
	inlay ($version) stable; urgency=medium

	  * Release $version.

	 -- $maintainer  $(date -R -u -d "@$SOURCE_DATE_EPOCH")
CHANGES
{
	printf '%s\n' "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/" "" \
		"Files: *" "$(sed -n 's/^Copyright (c) /Copyright: /p' LICENSE)" "License: Expat"
	sed '1,/^Copyright/d' LICENSE | sed '1{/^$/d}; s/^$/./; s/^/ /'
} >"$stage/debian/copyright"

pack() { # package
	local package=$1 root=$stage/$1 doc=$stage/$1/usr/share/doc/$1
	DESTDIR=$root PREFIX=/usr board/install.sh install "$build" "$package"
	"$kind-strip" --strip-unneeded --remove-section=.comment --remove-section=.note \
		"$root/usr/bin/"*
	find "$root/usr/share/man" -type f -exec gzip -9n {} +
	find "$root/usr/share/man" -type l | while read -r link; do
		ln -s "$(readlink "$link").gz" "$link.gz"
		rm "$link"
	done
	# Debian's zsh looks for completions of packages in a folder of its own.
	mkdir -p "$root/usr/share/zsh/vendor-completions" "$doc" "$root/DEBIAN"
	mv "$root/usr/share/zsh/site-functions/"* "$root/usr/share/zsh/vendor-completions/"
	rmdir "$root/usr/share/zsh/site-functions"
	install -m 644 "$stage/debian/copyright" "$doc/copyright"
	gzip -9nc "$stage/debian/changelog" >"$doc/changelog.gz"

	for script in postinst prerm postrm; do
		[ ! -e "$here/$package.$script" ] ||
			install -m 755 "$here/$package.$script" "$root/DEBIAN/$script"
	done
	(
		cd "$root"
		[ ! -d etc ] || find etc -type f -printf '/%p\n' | sort >DEBIAN/conffiles
		find . -path ./DEBIAN -prune -o -type f -printf '%P\0' | sort -z |
			xargs -0 md5sum >DEBIAN/md5sums
	)
	chmod 644 "$root/DEBIAN/md5sums"
	(
		cd "$stage"
		dpkg-shlibdeps -O "$package/usr/bin/"* >substvars
		dpkg-gencontrol -p"$package" -P"$package" -Tsubstvars -fdebian/files
	)
	dpkg-deb --root-owner-group -Zxz --build "$root" "$out" >/dev/null
	echo "$out/${package}_${version}_$arch.deb"
}
pack inlay
pack inlay-bake
