#!/bin/bash
# SPDX-License-Identifier: MIT
# Puts what `make` built where a system looks for it, or takes it away again.
#     board/install.sh install|uninstall BUILD [PACKAGE]
# BUILD is the folder that it was built in. PACKAGE: inlay or inlay-bake alone. Everything goes below
# $DESTDIR, programs and their data below $PREFIX; `make install` says so.
set -eu
what=$1 build=$2 only=${3:-}
destdir=${DESTDIR:-} prefix=${PREFIX:-/usr/local}
settings=/etc/inlay/kiosk.conf

# package, mode, source, target. Of mode link source is what the link says, beside its target.
files() {
	cat <<-END
		inlay 755 $build/inlay $prefix/bin/inlay
		inlay 755 board/systemd/back-off.sh $prefix/lib/inlay/back-off.sh
		inlay 644 board/systemd/inlay.service $prefix/lib/systemd/system/inlay.service
		inlay 644 board/udev/70-inlay.rules $prefix/lib/udev/rules.d/70-inlay.rules
		inlay 644 board/sysusers/inlay.conf $prefix/lib/sysusers.d/inlay.conf
		inlay 644 board/tmpfiles/inlay.conf $prefix/lib/tmpfiles.d/inlay.conf
		inlay 644 $build/share/kiosk.conf $settings
		inlay 644 config/kiosk.conf $prefix/share/doc/inlay/examples/kiosk.conf
		inlay 644 $build/share/inlay.1 $prefix/share/man/man1/inlay.1
		inlay 644 $build/share/inlay.conf.5 $prefix/share/man/man5/inlay.conf.5
		inlay link inlay.conf.5 $prefix/share/man/man5/kiosk.conf.5
		inlay 644 $build/share/inlay.bash $prefix/share/bash-completion/completions/inlay
		inlay 644 $build/share/_inlay $prefix/share/zsh/site-functions/_inlay
		inlay-bake 755 $build/inlay-bake $prefix/bin/inlay-bake
		inlay-bake 644 $build/share/inlay-bake.1 $prefix/share/man/man1/inlay-bake.1
		inlay-bake 644 $build/share/inlay-scene.5 $prefix/share/man/man5/inlay-scene.5
		inlay-bake 644 bake/README.md $prefix/share/doc/inlay-bake/bake/README.md
		inlay-bake 644 bake/demo/box.obj $prefix/share/doc/inlay-bake/examples/box.obj
		inlay-bake 644 bake/demo/box.scene $prefix/share/doc/inlay-bake/examples/box.scene
		inlay-bake 644 $build/share/inlay-bake.bash $prefix/share/bash-completion/completions/inlay-bake
		inlay-bake 644 $build/share/_inlay-bake $prefix/share/zsh/site-functions/_inlay-bake
		inlay-bake 755 $build/inlay-calibrate $prefix/bin/inlay-calibrate
		inlay-bake 644 $build/share/inlay-calibrate.1 $prefix/share/man/man1/inlay-calibrate.1
		inlay-bake 644 $build/share/inlay-calibrate.bash $prefix/share/bash-completion/completions/inlay-calibrate
		inlay-bake 644 $build/share/_inlay-calibrate $prefix/share/zsh/site-functions/_inlay-calibrate
	END
}

put() { # mode, source, target
	local target=$destdir$3
	if [ "$1" = link ]; then
		mkdir -p "${target%/*}"
		ln -sfn "$2" "$target"
		return
	fi
	if [ "$3" = "$settings" ] && [ -e "$target" ] && ! cmp -s "$2" "$target"; then
		echo "install: $target was changed and is kept"
		return
	fi
	install -D -m "$1" "$2" "$target"
	# The unit names its programs by their whole paths.
	if [ "${3##*/}" = inlay.service ]; then
		sed -i "s|=/usr/|=$prefix/|" "$target"
	fi
}

take_away() { # source, target
	local target=$destdir$2
	if [ "$2" = "$settings" ] && ! cmp -s "$1" "$target"; then
		[ ! -e "$target" ] || echo "uninstall: $target was changed and is kept"
		return
	fi
	rm -f "$target"
}

case "$what" in
install | uninstall) ;;
*)
	echo "install: \"$what\" is unknown, expected install or uninstall" >&2
	exit 2
	;;
esac
umask 022
while read -r package mode source target; do
	[ -z "$only" ] || [ "$only" = "$package" ] || continue
	if [ "$what" = install ]; then
		put "$mode" "$source" "$target"
	else
		take_away "$source" "$target"
	fi
done < <(files)

if [ "$what" = uninstall ]; then
	for folder in "$prefix/lib/inlay" "$prefix/share/doc/inlay/examples" \
		"$prefix/share/doc/inlay" "$prefix/share/doc/inlay-bake/bake" \
		"$prefix/share/doc/inlay-bake/examples" "$prefix/share/doc/inlay-bake" /etc/inlay; do
		rmdir --ignore-fail-on-non-empty "$destdir$folder" 2>/dev/null || :
	done
elif [ -z "$destdir" ]; then
	cat <<-END
		Once, as root:
		    systemd-sysusers && systemd-tmpfiles --create
		    udevadm control --reload && udevadm trigger
		    systemctl daemon-reload
		and when inlay check --config $settings has nothing to say:
		    systemctl enable --now inlay
	END
fi
