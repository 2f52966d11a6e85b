#!/bin/bash
# SPDX-License-Identifier: MIT
# make install and make uninstall: what is put where, and whether it says what the programs say.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"
cd "$(dirname "$0")/../.." || exit 1
build=$(realpath --relative-to=. "$(dirname "$INLAY")")

# The tests run below a make of their own, whose choices hold here too, but not its jobs.
MAKEFLAGS=$(sed -E 's/(^| )(-j[0-9]*|--jobserver-[a-z]+=[^ ]*)//g' <<<"${MAKEFLAGS:-}")
export MAKEFLAGS
make_here() { make --no-print-directory BUILD="$build" "$@"; }
listed() { (cd "$1" && find . -type f -printf '%m %P\n' | sort -k2); }

touch "$work/stamp"
dest="$work/a system"
check "make install" make_here install DESTDIR="$dest" PREFIX=/usr
cat >"$work/expected" <<'END'
644 etc/inlay/kiosk.conf
755 usr/bin/inlay
755 usr/bin/inlay-bake
755 usr/bin/inlay-calibrate
755 usr/lib/inlay/back-off.sh
644 usr/lib/systemd/system/inlay.service
644 usr/lib/sysusers.d/inlay.conf
644 usr/lib/tmpfiles.d/inlay.conf
644 usr/lib/udev/rules.d/70-inlay.rules
644 usr/share/bash-completion/completions/inlay
644 usr/share/bash-completion/completions/inlay-bake
644 usr/share/bash-completion/completions/inlay-calibrate
644 usr/share/doc/inlay-bake/bake/README.md
644 usr/share/doc/inlay-bake/examples/box.obj
644 usr/share/doc/inlay-bake/examples/box.scene
644 usr/share/doc/inlay/examples/kiosk.conf
644 usr/share/man/man1/inlay-bake.1
644 usr/share/man/man1/inlay-calibrate.1
644 usr/share/man/man1/inlay.1
644 usr/share/man/man5/inlay-scene.5
644 usr/share/man/man5/inlay.conf.5
644 usr/share/zsh/site-functions/_inlay
644 usr/share/zsh/site-functions/_inlay-bake
644 usr/share/zsh/site-functions/_inlay-calibrate
END
listed "$dest" >"$work/listed"
same "puts these files below DESTDIR, whose name holds a blank" "$work/expected" "$work/listed"
equal "and none of them elsewhere" "" \
	"$(find /etc /usr/local /usr/lib/systemd /usr/lib/udev /usr/lib/inlay /usr/share/man /var/lib/inlay \
		-newer "$work/stamp" -path '*inlay*' 2>/dev/null)"
same "the program is the one that was built" "$INLAY" "$dest/usr/bin/inlay"

# ---- the configuration ----
"$INLAY" check --print-config --config "$dest/etc/inlay/kiosk.conf" >"$work/installed" 2>&1
"$INLAY" check --sample >"$work/sample.conf"
"$INLAY" check --print-config --config "$work/sample.conf" >"$work/defaults" 2>&1
diff "$work/defaults" "$work/installed" | sed -n 's/^> //p' | sort >"$work/differs"
grep '^[a-z].* = ' board/appliance.conf | sed "s|= object|= $dest/etc/inlay/object|" |
	sort >"$work/expected"
same "it is the defaults but for what an appliance needs" "$work/expected" "$work/differs"
printf '[state]\nfiel = /var/lib/inlay/state\n' >"$work/wrong"
equal "a key that the program lacks would have stopped the build" \
	"appliance: the sample has no key for [state]fiel =" \
	"$(awk -f board/appliance.awk "$work/wrong" "$work/sample.conf" 2>&1 >/dev/null)"

# ---- manual pages ----
pages="$dest/usr/share/man"
renders() { # a page, without a warning
	local said
	said=$(MANWIDTH=100 man --warnings -l "$1" 2>&1 >"$work/page") && [ -z "$said" ] &&
		[ -s "$work/page" ]
}
# Options stand at the beginning of a line of --help, behind two blanks.
options_of() { # program, command
	"$1" "$2" --help | grep -oE '^  (-[a-z], )?-[a-z-]+' | grep -oE -e '-[a-z-]+' | sort -u
}
commands_of() { # program
	"$1" --help | sed -n 's/^  \([a-z][a-z-]*\) .*/\1/p'
}
for program in inlay inlay-bake inlay-calibrate; do
	page="$pages/man1/$program.1"
	check "$program.1 shows without a warning" renders "$page"
	missing=
	for command in $(commands_of "$dest/usr/bin/$program"); do
		sed -n "/^   $program $command\$/,/^\(   $program .*\|[A-Z].*\)\$/p" "$work/page" \
			>"$work/section"
		for option in $(options_of "$dest/usr/bin/$program" "$command"); do
			grep -qE -e "^ *(-., )?$option(,| |\$)" "$work/section" ||
				missing="$missing $command $option"
		done
	done
	equal "and holds every option of every command" "" "$missing"
done
check "inlay.conf.5 shows without a warning" renders "$pages/man5/inlay.conf.5"
missing=$(grep -oE '^(; )?[a-z][a-z0-9_.]* =' "$work/sample.conf" | tr -d ';=' | sort -u | while read -r key; do
	grep -qE "^ *$key( = | \(must be given\))" "$work/page" || echo "$key"
done)
equal "and holds every key" "" "$missing"
equal "man kiosk.conf shows it" inlay.conf.5 "$(readlink "$pages/man5/kiosk.conf.5")"
check "inlay-scene.5 shows without a warning" renders "$pages/man5/inlay-scene.5"
missing=$("$INLAY_BAKE" render --print-scene | grep -oE '^(; )?[a-z][a-z0-9_]* =' | tr -d ';=' |
	sort -u | while read -r key; do
	grep -qE "^ *$key( = | \(must be given\))" "$work/page" || echo "$key"
done)
equal "and holds every key" "" "$missing"
check "the sample scene bakes" "$INLAY_BAKE" render --size 32x24 --samples 1 --quiet \
	-o "$work/box.inlay" "$dest/usr/share/doc/inlay-bake/examples/box.scene"
printf '.TH X 1\n.SH NAME\nx \\- y\n.nosuch\n' >"$work/bad.1"
if renders "$work/bad.1"; then
	fail "a wrong page is noticed" </dev/null
else
	pass "a wrong page is noticed"
fi
for page in "$pages"/man?/*; do
	if command -v mandoc >/dev/null; then
		check "mandoc likes ${page##*/}" mandoc -Tlint -Wwarning "$page"
	fi
done

# ---- completion ----
completed() { # program, words...: what bash offers for the last of them
	bash --norc --noprofile -c '
		compopt() { :; } # outside of a completion it only complains
		. "$1/usr/share/bash-completion/completions/$2"
		entry=$(complete -p "$2" | grep -oE "[-]F [^ ]+")
		shift
		COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
		${entry#-F }
		printf "%s\n" "${COMPREPLY[@]}"' - "$dest" "$@"
}
equal "inlay ru<TAB>" run "$(completed inlay ru)"
equal "inlay run --fr<TAB>" --frames "$(completed inlay run --fr)"
equal "inlay run --set lights.threshold_s<TAB>" lights.threshold_step= \
	"$(completed inlay run --set lights.threshold_s)"
equal "inlay run --set camera.camera2.dr<TAB>" camera.camera2.driver= \
	"$(completed inlay run --set camera.camera2.dr)"
{
	printf '%s\n' status snapshot
	sed -n '/action_names\[\] = {/,/^}/p' hal/device/buttons.c | grep -oE '"[a-z-]+"' | tr -d '"'
} | grep -vx none | sort >"$work/expected"
completed inlay control "" | grep '^[a-z]' | sort >"$work/offered"
same "bash offers everything that a kiosk can be told" "$work/expected" "$work/offered"
equal "inlay control snapshot <TAB> is left to file names" "" "$(completed inlay control snapshot "")"
equal "inlay run --config <TAB> is left to file names" "" "$(completed inlay run --config "")"
for program in inlay inlay-bake inlay-calibrate; do
	commands_of "$dest/usr/bin/$program" | sort >"$work/expected"
	completed "$program" "" | grep '^[a-z]' | sort >"$work/offered"
	same "bash offers the commands of $program" "$work/expected" "$work/offered"
	for command in $(commands_of "$dest/usr/bin/$program"); do
		(
			echo --help
			options_of "$dest/usr/bin/$program" "$command"
		) | sort -u >"$work/expected"
		completed "$program" "$command" - | sort -u >"$work/offered"
		same "bash offers every option of $program $command" "$work/expected" "$work/offered"
		sed -n "/^\t$command)\$/,/;;/p" "$dest/usr/share/zsh/site-functions/_$program" |
			grep -oE "^	*'[*]?-[a-z-]+" | grep -oE -e '-[a-z-]+' | sort -u >"$work/offered"
		same "zsh knows every option of $program $command" "$work/expected" "$work/offered"
	done
done
loader=/usr/share/bash-completion/bash_completion
if [ -r $loader ]; then
	equal "bash-completion finds it" "complete -o default -F _inlay inlay" \
		"$(XDG_DATA_DIRS="$dest/usr/share" bash --norc -c \
			". $loader; _completion_loader inlay; complete -p inlay" 2>&1)"
fi
if command -v zsh >/dev/null; then
	for program in inlay inlay-bake inlay-calibrate; do
		equal "zsh finds _$program" "_$program" "$(zsh -f -c \
			"fpath=('$dest/usr/share/zsh/site-functions' \$fpath)
			autoload -U compinit && compinit -D -u && autoload +X _$program &&
			print \$_comps[$program]" 2>&1)"
	done
fi

# ---- the unit ----
# It names programs by their whole paths, which are there below a PREFIX of our own.
prefix=$(mktemp -d "${TMPDIR:-/tmp}/inlay-prefix.XXXXXX")
trap 'rm -rf "$work" "$prefix"' EXIT
check "make install to another PREFIX" make_here install DESTDIR="$work/other" PREFIX="$prefix"
cp -r "$work/other$prefix/." "$prefix"
unit=$prefix/lib/systemd/system/inlay.service
verified() { MANPATH="$pages:" systemd-analyze verify "$1" 2>&1; }
if command -v systemd-analyze >/dev/null; then
	equal "systemd-analyze finds no fault with the unit" "" "$(verified "$unit")"
	sed 's/^WatchdogSec=.*/WatchdogSecs=10/' "$unit" >"$prefix/wrong.service"
	check "and would with a wrong one" grep -q WatchdogSecs < <(verified "$prefix/wrong.service")
	exposure=$(systemd-analyze security --offline=true "$unit" |
		sed -n 's/.*Overall exposure level.*: \([0-9.]*\).*/\1/p')
	echo "# exposure $exposure of 10"
	check "it is exposed by less than 2 of 10" awk -v is="$exposure" \
		'BEGIN { exit !(is != "" && is < 2) }'
fi

# Starts that follow closely, on a clock of our own.
mkdir "$work/fake" "$work/memory"
echo 1000 >"$work/now"
cat >"$work/fake/date" <<'END'
#!/bin/sh
cat "$NOW"
END
cat >"$work/fake/sleep" <<'END'
#!/bin/sh
echo "$1" >"$NOW.slept"
echo $(($(cat "$NOW") + $1)) >"$NOW"
END
chmod +x "$work/fake/date" "$work/fake/sleep"
check "a leak ends the kiosk and not the machine" grep -q '^MemoryMax=[1-8][0-9]%$' \
	"$dest/usr/lib/systemd/system/inlay.service"
put_off() { # how long the kiosk ran before each start: by how much each was put off
	for ran in "$@"; do
		echo $(($(cat "$work/now") + ran)) >"$work/now"
		echo 0 >"$work/now.slept"
		NOW="$work/now" RUNTIME_DIRECTORY="$work/memory" PATH="$work/fake:$PATH" \
			timeout 120 "$dest/usr/lib/inlay/back-off.sh" 2>/dev/null || echo failed
		printf '%d ' "$(cat "$work/now.slept")"
	done
}
equal "starts in a row are put off longer and longer" "0 0 2 4 8 16 30 30 " \
	"$(put_off 0 1 1 1 1 1 1 1)"
equal "and not after a minute that went well" "0 0 2 " "$(put_off 60 1 1)"
equal "nor when the clock is set back" "0 " "$(put_off -500)"
put_off 60 1 1 >/dev/null
for nonsense in "" " " x "1 2 3" "08 08" "$(cat "$work/now") x" "$(cat "$work/now") 08" \
	"99999999999999999999 1" "-1 -1" "a[0] b"; do
	echo "$nonsense" >"$work/memory/back-off"
	equal "what it remembers is \"$nonsense\": it begins anew" "0 0 2 " "$(put_off 1 1 1)"
done
printf '1 \0\377' >"$work/memory/back-off"
equal "or bytes: it begins anew" "0 0 2 " "$(put_off 1 1 1)"
ln -sf /dev/full "$work/memory/back-off"
equal "where it cannot remember each start is put off a little" "5 5 5 " "$(put_off 1 1 1)"
rm "$work/memory/back-off"
mkdir "$work/memory/back-off"
equal "nor into a folder" "5 5 " "$(put_off 1 1)"
rmdir "$work/memory/back-off"

# ---- again, and away ----
make_here install DESTDIR="$dest" PREFIX=/usr
equal "installed again it is the same" "" "$(listed "$dest" | diff - "$work/listed")"
echo "; mine" >>"$dest/etc/inlay/kiosk.conf"
cp "$dest/etc/inlay/kiosk.conf" "$work/mine"
equal "a changed configuration is kept" "install: $dest/etc/inlay/kiosk.conf was changed and is kept" \
	"$(make_here install DESTDIR="$dest" PREFIX=/usr 2>&1)"
same "as it was" "$work/mine" "$dest/etc/inlay/kiosk.conf"
equal "make uninstall keeps it too" "uninstall: $dest/etc/inlay/kiosk.conf was changed and is kept" \
	"$(make_here uninstall DESTDIR="$dest" PREFIX=/usr 2>&1)"
equal "and nothing else" "644 etc/inlay/kiosk.conf" "$(listed "$dest")"
make_here uninstall DESTDIR="$work/other" PREFIX="$prefix"
equal "an unchanged one goes" "" "$(listed "$work/other")"
finish
