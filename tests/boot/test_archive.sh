#!/bin/bash
# SPDX-License-Identifier: MIT
# Where the packages of an image come from: from where this machine's apt gets them, and from nowhere
# else. mmdebstrap is played by a script that keeps what it was told.
#     test_archive.sh
. tests/vm/guest/tap.sh
folder=$(realpath -m "${BUILD:?is not set: expected a folder to write in}/tests/boot/archive")
rm -rf "$folder"
mkdir -p "$folder"/{bin,lists,cache}
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")

cat >"$folder/bin/mmdebstrap" <<'END'
#!/bin/bash
printf '%s\n' "$@" >"$TOLD/arguments"
cat >"$TOLD/sources"
for argument; do
	[[ $argument != */root.tar ]] || { : >"$argument" && cp -r "${argument%/*}" "$TOLD/beside"; }
done
END
chmod 755 "$folder/bin/mmdebstrap"
cat >"$folder/apt.conf" <<END
Dir::Etc::sourcelist "$folder/sources.list";
Dir::Etc::sourceparts "/dev/null";
Dir::State::lists "$folder/lists";
END

fetch() { # a line of this machine's sources.list...
	rm -rf "$folder/beside"
	printf '%s\n' "$@" >"$folder/sources.list"
	TOLD=$folder APT_CONFIG=$folder/apt.conf XDG_CACHE_HOME=$folder/cache PATH=$folder/bin:$PATH \
		board/image/debian.sh --components "main extra" systemd 2>"$folder/log"
}
told() { # what is there of sources besides standard input
	grep -e sources.list "$folder/arguments"
	find "$folder/beside" -name '*sources*'
}

first=$(fetch "deb file:/srv/mirror $suite main contrib" "deb file:/srv/security $suite-security main" \
	"deb file:/srv/other $suite stable" "deb file:/srv/third $suite-third main")
check "packages are fetched" test -e "$first"
equal "from this machine's archives of its release, with the components that a board wants" \
	"deb file:/srv/mirror $suite main extra
deb file:/srv/security $suite-security main extra" "$(cat "$folder/sources")"
equal "and the root is given no other list" "" "$(told)"
check "an archive that is named for the first time is asked" test "$first" != \
	"$(fetch "deb file:/srv/moved $suite main")"
fetch "deb file:/srv/other unrelated main" >/dev/null
equal "where apt names none, mmdebstrap is left to its own" root.tar \
	"$(basename "$(tail -n 1 "$folder/arguments")")"
equal "no archive of packages is named in the tree" "" \
	"$(git grep -l -E '(deb|security)\.debian[.]org' -- board tests)"
