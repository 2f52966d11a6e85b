#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds a simulated machine's kernel from Debian's linux-source package, once, and prints the folder
# that holds it: the kernel, config and modules/lib/modules/VERSION.
#
#     build-kernel.sh uml|qemu-x86_64     build unless it is there already, print the folder
#
# The folder lies in the user's cache, outside any checkout, and is named by a hash of everything
# that goes into it. It appears by rename: an interrupted build leaves nothing.
set -euo pipefail

board=${1:-}
case $board in
uml) arch=um image=linux ;;
qemu-x86_64) arch=x86_64 image=arch/x86/boot/bzImage ;;
*)
	echo "build-kernel: unknown board \"$board\", expected uml or qemu-x86_64" >&2
	exit 2
	;;
esac
fragment=$(cd "$(dirname "$0")" && pwd)/$board/kernel.config
package=linux-source-6.1
tarball=/usr/src/$package.tar.xz
cache=${XDG_CACHE_HOME:-$HOME/.cache}/inlay
PATH=$PATH:/usr/sbin:/sbin # depmod, for an ordinary user

fail() {
	echo "build-kernel: $*" >&2
	exit 1
}

[ -r "$tarball" ] || fail "$tarball: not there; \`make deps\` installs Debian's package $package"
version=$(dpkg-query -W -f '${Version}' "$package")
key=$( (cat "$fragment" "$0" && echo "$version") | sha256sum | cut -c1-16)
result=$cache/kernel-$board-$key

if [ -e "$result" ]; then
	echo "$result"
	exit
fi

mkdir -p "$cache"
# Two builds at once would only be slow; the second finds the first one's result.
exec 9>"$cache/kernel.lock"
flock 9
if [ -e "$result" ]; then
	echo "$result"
	exit
fi

# The kernel's makefiles refuse a path with a space or a colon in it.
scratch=${TMPDIR:-/tmp}
case $scratch in *[[:space:]:]*) scratch=/tmp ;; esac
work=$(mktemp -d "$scratch/inlay-kernel.XXXXXX")
export TMPDIR=$work # nor do its scripts quote this one
staging=$(mktemp -d "$cache/.kernel-$key.XXXXXX")
trap 'rm -rf "$work" "$staging"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
log=$cache/kernel-$board.log

step() {
	local text=$1
	shift
	echo "  KERNEL  $text" >&2
	if ! "$@" >>"$log" 2>&1; then
		tail -n 30 "$log" >&2
		fail "$text failed; the whole log is $log"
	fi
}

unpack() {
	# Other architectures, the manual and the biggest drivers' code: half the bytes, never read.
	tar -C "$work" --strip-components=1 -xf "$tarball" \
		--exclude="$package/Documentation/*.rst" \
		--exclude="$package/drivers/gpu/drm/amd/*.[ch]" \
		--exclude="$package/drivers/net/ethernet/*.[ch]" \
		--exclude="$package/drivers/net/wireless/*.[ch]" \
		--exclude="$package/sound/*.[ch]" \
		--exclude="$package/tools/testing/*" \
		--exclude="$package/tools/perf/*"
}

# vivid's threads ask for a lock again and again until they have it. In simulated time, which passes only
# while all wait, whoever holds it would never be done: they are made to wait between.
mend_vivid() {
	local thread
	for thread in cap out touch; do
		sed -i '/mutex_trylock/,+2s/\bschedule();/schedule_timeout_uninterruptible(1);/w /dev/stdout' \
			"$work/drivers/media/test-drivers/vivid/vivid-kthread-$thread.c" | grep . || return
	done
}

check_config() {
	local missing
	missing=$(grep '^CONFIG_' "$fragment" | grep -vxFf "$work/.config" || true)
	if [ -n "$missing" ]; then
		printf 'these lines of %s did not take effect:\n%s\n' "$fragment" "$missing"
		return 1
	fi
}

: >"$log"
build=(make -C "$work" -s "ARCH=$arch" KBUILD_BUILD_USER=inlay "KBUILD_BUILD_HOST=$board")
jobs=${KERNEL_JOBS:-$(nproc)}
step "unpack $package $version" unpack
step "mend vivid" mend_vivid
step "configure" "${build[@]}" allnoconfig KCONFIG_ALLCONFIG="$fragment"
step "check the configuration" check_config
step "compile (once, some minutes; log: $log)" "${build[@]}" -j"$jobs" "${image##*/}" modules
step "install the modules" "${build[@]}" modules_install INSTALL_MOD_STRIP=1 \
	INSTALL_MOD_PATH="$work/install"

rm -f "$work"/install/lib/modules/*/{build,source}
cp "$work/$image" "$work/.config" "$staging/"
mv "$staging/.config" "$staging/config"
mkdir "$staging/modules"
cp -r "$work/install/lib" "$staging/modules/"
chmod 755 "$staging"
mv -T "$staging" "$result"
echo "$result"
