#!/bin/bash
# SPDX-License-Identifier: MIT
# Unpacks Debian packages into a root of their own, once, and prints the tar file that holds it.
#
#     debian.sh [--for ARCH] [--unconfigured] [--components "main ..."] [--before FOLDER] PACKAGE...
#
# The release is the host's own, and its packages come from where the host's apt gets them; the root's own
# sources.list says the same. A host whose apt names no archive of its release leaves it to mmdebstrap.
# --before FOLDER    copied over the root before the packages are configured (initramfs settings)
# --unconfigured     packages are only unpacked: for headers and libraries to link with
#
# The tar lies in the user's cache, named by a hash of everything asked for, and appears by rename.
set -euo pipefail

architecture=$(dpkg --print-architecture)
components=main
before=
variant=essential
while :; do
	case "${1:-}" in
	--for) architecture=$2 && shift 2 ;;
	--components) components=$2 && shift 2 ;;
	--before) before=$(cd "$2" && pwd) && shift 2 ;;
	--unconfigured) variant=extract && shift ;;
	*) break ;;
	esac
done
cache=${XDG_CACHE_HOME:-$HOME/.cache}/inlay

fail() {
	echo "debian: $*" >&2
	exit 1
}

# shellcheck source=/dev/null
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
[ -n "$suite" ] || fail "/etc/os-release names no Debian release: expected Debian 12 or later"

# Where the host's apt would look for this release now, with the components that are wanted here. Others
# name their archives after the release too; those have other components, or more in their names.
sources() {
	apt-get update --print-uris |
		sed -nE "s#^'(.*)/dists/($suite(|-updates|-security))/main/binary-.*#deb \1 \2 $components#p" |
		sort -u
}
sources=$(sources)

key=$( (
	cat "$0"
	echo "$sources"
	echo "$suite $architecture $components $variant $*"
	[ -z "$before" ] || (cd "$before" && find . -type f | sort | xargs cat)
) | sha256sum | cut -c1-16)
result=$cache/debian-$architecture-$key.tar
if [ -e "$result" ]; then
	echo "$result"
	exit
fi

mkdir -p "$cache"
exec 9>"$cache/.debian-$key.lock"
flock 9 # the second of two finds the first one's result
if [ -e "$result" ]; then
	echo "$result"
	exit
fi

# Packages of another architecture run their own scripts: the kernel must know how.
if [ "$variant" != extract ] && [ "$architecture" != "$(dpkg --print-architecture)" ]; then
	"$(dirname "$0")/foreign.sh" "$architecture"
fi

staging=$(mktemp -d "$cache/.debian-$key.XXXXXX")
trap 'rm -rf "$staging"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
log=$cache/debian-$architecture-$key.log

# The host's proxy serves the download and is not kept.
apt-config dump | grep -E '^Acquire::(https?|ftp)::Proxy|^Acquire::Check' >"$staging/apt.conf" || true

mode=unshare # an ordinary user's own namespace
[ "$(id -u)" != 0 ] || mode=root
options=(
	"--mode=$mode" "--variant=$variant" "--architectures=$architecture" --format=tar
	--include="$(IFS=, && echo "$*")"
	--aptopt="$staging/apt.conf"
	--dpkgopt=path-exclude=/usr/share/man/* --dpkgopt=path-exclude=/usr/share/locale/*
	--dpkgopt=path-exclude=/usr/share/info/* --dpkgopt=path-exclude=/usr/share/doc/*
	--dpkgopt=path-include=/usr/share/doc/*/copyright
)
if [ "$variant" != extract ]; then
	[ -z "$before" ] || options+=(--essential-hook="copy-in '$before'/. /")
	options+=(--customize-hook='rm -f "$1"/etc/apt/apt.conf.d/99mmdebstrap')
fi
echo "  DEBIAN  $suite $architecture (once; log: $log)" >&2
if ! mmdebstrap "${options[@]}" "$suite" "$staging/root.tar" ${sources:+-} <<<"$sources" \
	>"$log" 2>&1; then
	tail -n 20 "$log" >&2
	if [ "$mode" = unshare ] && grep -q -i -E 'subuid|newuidmap|unshare' "$log"; then
		fail "an ordinary user needs unprivileged user namespaces, newuidmap (package uidmap) and" \
			"a line in /etc/subuid and /etc/subgid; or run this as root"
	fi
	fail "mmdebstrap failed; the whole log is $log"
fi
mv -T "$staging/root.tar" "$result"
rm -f "$cache/.debian-$key.lock"
echo "$result"
