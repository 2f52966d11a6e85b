#!/bin/bash
# SPDX-License-Identifier: MIT
# make deb: what the packages hold and need, that they are the same whenever they are made, and that
# they install, run and leave in a root of Debian's own.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
cd "$(dirname "$0")/../.." || exit 1
arch=$(dpkg --print-architecture)
version=$(sed -n 's/^VERSION := //p' Makefile)
debs=build/deb
kiosk=$debs/inlay_${version}_$arch.deb
bake=$debs/inlay-bake_${version}_$arch.deb

skip() {
	count=$((count + 1))
	echo "ok $count - $1 # SKIP $2"
}
# The tests run below a make of their own; its choices of compiler and build folder are not the
# packages'.
make_debs() { env -u MAKEFLAGS -u MAKELEVEL -u BUILD make --no-print-directory -j2 deb-built; }

rm -f "$kiosk" "$bake"
check "make deb" make_debs
check "leaves the package of the kiosk" test -s "$kiosk"
check "and that of the offline programs" test -s "$bake"

# A library that is not found must not make a kiosk without it.
check "a part that is missing stops it" grep -q "finds no library for WITH_KMS" < <(
	env -u MAKEFLAGS -u MAKELEVEL make --no-print-directory WITH_KMS=0 deb-whole 2>&1
)

# ---- what they hold ----
contents() { # mode, owner and path of what is no folder
	dpkg-deb -c "$1" | awk '$1 !~ /^d/ { print $1, $2, substr($6, 2) }' | LC_ALL=C sort -k3
}
contents "$kiosk" >"$work/listed"
cat >"$work/expected" <<'END'
-rw-r--r-- root/root /etc/inlay/kiosk.conf
-rwxr-xr-x root/root /usr/bin/inlay
-rwxr-xr-x root/root /usr/lib/inlay/back-off.sh
-rw-r--r-- root/root /usr/lib/systemd/system/inlay.service
-rw-r--r-- root/root /usr/lib/sysusers.d/inlay.conf
-rw-r--r-- root/root /usr/lib/tmpfiles.d/inlay.conf
-rw-r--r-- root/root /usr/lib/udev/rules.d/70-inlay.rules
-rw-r--r-- root/root /usr/share/bash-completion/completions/inlay
-rw-r--r-- root/root /usr/share/doc/inlay/changelog.gz
-rw-r--r-- root/root /usr/share/doc/inlay/copyright
-rw-r--r-- root/root /usr/share/doc/inlay/examples/kiosk.conf
-rw-r--r-- root/root /usr/share/man/man1/inlay.1.gz
-rw-r--r-- root/root /usr/share/man/man5/inlay.conf.5.gz
lrwxrwxrwx root/root /usr/share/man/man5/kiosk.conf.5.gz
-rw-r--r-- root/root /usr/share/zsh/vendor-completions/_inlay
END
same "the kiosk's holds these files" "$work/expected" "$work/listed"
contents "$bake" >"$work/listed"
cat >"$work/expected" <<'END'
-rwxr-xr-x root/root /usr/bin/inlay-bake
-rwxr-xr-x root/root /usr/bin/inlay-calibrate
-rw-r--r-- root/root /usr/share/bash-completion/completions/inlay-bake
-rw-r--r-- root/root /usr/share/bash-completion/completions/inlay-calibrate
-rw-r--r-- root/root /usr/share/doc/inlay-bake/bake/README.md
-rw-r--r-- root/root /usr/share/doc/inlay-bake/changelog.gz
-rw-r--r-- root/root /usr/share/doc/inlay-bake/copyright
-rw-r--r-- root/root /usr/share/doc/inlay-bake/examples/box.obj
-rw-r--r-- root/root /usr/share/doc/inlay-bake/examples/box.scene
-rw-r--r-- root/root /usr/share/man/man1/inlay-bake.1.gz
-rw-r--r-- root/root /usr/share/man/man1/inlay-calibrate.1.gz
-rw-r--r-- root/root /usr/share/man/man5/inlay-scene.5.gz
-rw-r--r-- root/root /usr/share/zsh/vendor-completions/_inlay-bake
-rw-r--r-- root/root /usr/share/zsh/vendor-completions/_inlay-calibrate
END
same "the offline programs' holds these" "$work/expected" "$work/listed"
dpkg-deb -e "$kiosk" "$work/kiosk"
equal "the configuration is the person's own" /etc/inlay/kiosk.conf "$(cat "$work/kiosk/conffiles")"
equal "the version is the program's" "$version" "$(dpkg-deb -f "$kiosk" Version)"

# ---- what they need ----
# Decoders, zstd, the camera, screen and button libraries, text, systemd: nothing of a desktop or a baker.
lean='libc6|libcairo2|libcamera[0-9.]*|libdrm2|libevdev2|libgcc-s1|libgpiod[23]|libinih1'
lean+='|libopenexr-3-1-30|libjpeg62-turbo|libpng16-16|libstdc\+\+6|libsystemd0|libudev1|libwebp7|libxxhash0|libyuv0|libzstd1'
lean+='|default-systemd-sysusers|fonts-dejavu-core|init-system-helpers'
needs() { # names alone; of alternatives the first; t64 is Debian 13's mark
	dpkg-deb -f "$1" Depends | tr ',' '\n' | awk '{ sub(/t64$/, "", $1); print $1 }' | sort -u
}
equal "the kiosk needs nothing but these" "" "$(needs "$kiosk" | grep -vxE "$lean")"
check "the offline programs would fail that" test -n "$(needs "$bake" | grep -vxE "$lean")"
check "which need Embree" grep -q '^libembree' < <(needs "$bake")
check "and OpenCV" grep -q '^libopencv-calib3d' < <(needs "$bake")

# ---- what the distribution's own critic says ----
if command -v lintian >/dev/null; then
	# Without an address of its own the project has no maintainer to write to.
	equal "lintian has nothing to object" "" "$(lintian --allow-root --fail-on none \
		--suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog \
		"$kiosk" "$bake" 2>"$work/lintian.log")"
else
	skip "lintian has nothing to object" "lintian is not installed"
fi

# ---- the same, whoever makes them ----
date=$(git log -1 --format=%ct 2>/dev/null || stat -c %Y Makefile)
again=build/deb/again
rm -rf $again
cp -r "build/deb/$arch" $again
(
	umask 077
	SOURCE_DATE_EPOCH=$date LC_ALL=C TZ=Asia/Tokyo board/debian/build.sh $again "$version" "$arch" \
		$again/out
) >"$work/again.log" 2>&1
same "packed again elsewhere the kiosk's is the same, bit for bit" "$kiosk" \
	$again/out/"${kiosk##*/}"
same "and the offline programs'" "$bake" $again/out/"${bake##*/}"
SOURCE_DATE_EPOCH=$((date - 86400)) board/debian/build.sh $again "$version" "$arch" $again/out \
	>"$work/again.log" 2>&1
differ "it would differ with another date" "$kiosk" $again/out/"${kiosk##*/}"
rm -rf $again

# ---- in a root of Debian's own ----
# Everything it needs is in the root before, so that dpkg alone is asked.
if [ "$(id -u)" != 0 ] || ! command -v mmdebstrap >/dev/null; then
	skip "installed in a root of Debian's own" "needs root and mmdebstrap"
	finish
fi
root=$work/root
mkdir "$root"
# shellcheck disable=SC2046 # a list of words
if ! tar=$(board/image/debian.sh systemd udev $(needs "$kiosk" | grep -v default-) 2>"$work/root.log") ||
	! tar -C "$root" -xf "$tar" 2>>"$work/root.log"; then
	fail "a root of Debian's own" <"$work/root.log"
	finish
fi
# dpkg marks what it does with links of its own; what the package leaves is all the rest.
everything() {
	(cd "$root" && find . -path ./var/lib/dpkg -prune -o -path ./var/log -prune -o \
		-path ./var/cache -prune -o -path ./run -prune -o -path ./dev -prune -o -print | sort)
}
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C "$@"; }
everything >"$work/before"
cp "$kiosk" "$root/inlay.deb"
check "dpkg -i" inside dpkg -i /inlay.deb
equal "the program runs" "inlay $version" "$(inside inlay --version)"
equal "there is a user for it" inlay "$(inside id -un inlay)"
for group in inlay gpio video render input; do
	check "and the group $group" inside getent group $group
done
equal "sysusers finds no fault" "" "$(systemd-sysusers --root="$root" --dry-run 2>&1 | grep -i inlay)"
equal "its unit is not enabled" disabled "$(inside systemctl is-enabled inlay.service 2>&1)"
equal "systemd-analyze finds no fault with it there" "" \
	"$(inside systemd-analyze verify --man=no inlay.service 2>&1 | grep inlay)"
systemd-tmpfiles --root="$root" --create inlay.conf
equal "its folder for state is its user's" "inlay inlay 750" \
	"$(inside stat -c '%U %G %a' /var/lib/inlay)"

echo "; mine" >>"$root/etc/inlay/kiosk.conf"
inside systemctl enable inlay.service >/dev/null 2>&1
check "installed again over a changed configuration" inside dpkg -i /inlay.deb
equal "which is kept" "; mine" "$(tail -n 1 "$root/etc/inlay/kiosk.conf")"
equal "and the unit is as enabled as it was" enabled \
	"$(inside systemctl is-enabled inlay.service 2>&1)"

echo "threshold = 40" >"$root/var/lib/inlay/state"
check "dpkg --remove" inside dpkg --remove inlay
check "keeps the configuration" test -e "$root/etc/inlay/kiosk.conf"
check "dpkg --purge" inside dpkg --purge inlay
rm "$root/inlay.deb"
everything >"$work/after"
equal "leaves the state, and the user whose it is" "./var/lib/inlay ./var/lib/inlay/state" \
	"$(comm -13 "$work/before" "$work/after" | grep -v '^./etc/\(passwd\|group\|g\?shadow\)-$' |
		tr '\n' ' ' | sed 's/ $//')"
finish
