#!/bin/bash
# SPDX-License-Identifier: MIT
# Who may include whom, by tests/lint/rooms; every room has a README.md, and no folder more than 30 files.
# Fails with file:line of each include that a rule does not allow.
#
#     tests/lint/rooms.sh [ROOT]
set -u
here=$(cd "$(dirname "$0")" && pwd)
cd "${1:-$here/../..}" || exit 1
rooms=tests/lint/rooms
[ -f $rooms ] || {
	echo "$rooms: missing; it names the rooms and what each may include" >&2
	exit 1
}
bad=0
complain() {
	echo "$1" >&2
	bad=1
}
top=(app drivers hal config bake tests)

# "file:line:target" of each include of a header of ours
includes() {
	grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' "$@" \
		--include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp' |
		sed 's/^\([^:]*:[0-9]*:\).*"\(.*\)".*/\1\2/'
}

# The rules themselves: each names only rooms above it, and rooms that exist.
includes "${top[@]}" | awk -F: -v rooms=$rooms '
	function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
	function say(text) { print text > "/dev/stderr"; bad = 1 }
	BEGIN {
		while ((getline line < rooms) > 0) {
			number++
			if (line ~ /^(#|[[:space:]]*$)/) continue
			room = line
			sub(/:.*/, "", room)
			count = split(substr(line, length(room) + 2), named, " ")
			own[room] = 1 # what lies in it
			for (i = 1; i <= count; i++) {
				name = named[i]
				if (name ~ /\/\*$/) {
					sub(/\*$/, "", name)
					found = 0
					for (other in above) if (index(other, name) == 1) { may[room, other] = 1; found = 1 }
					if (!found) say(rooms ":" number ": no room above it begins with \"" name "\"")
				} else {
					whole = name
					if (name ~ /\.h$/) whole = folder_of(name)
					if (name ~ /\.h$/ || whole in above) may[room, name] = 1
					else say(rooms ":" number ": \"" name "\" is no room above \"" room "\"")
				}
			}
			above[room] = 1
		}
	}
	{
		file = $1; line = $2; target = $3
		room = folder_of(file)
		if (room ~ /^tests\//) room = "tests"
		other = folder_of(target)
		if (other ~ /^tests\// || other == "tests") { if (room == "tests") next }
		if (!(room in own)) { if (!told[room]++) say(file ": the folder " room " is not in " rooms); next }
		if (other == room || (room, other) in may || (room, target) in may) next
		say(file ":" line ": " room " may not include \"" target "\" (" rooms ")")
	}
	END { exit bad }' || bad=1

# Drivers never include each other: camera_v4l2.c sees what lies in drivers/v4l2/ alone; drivers of one library
# (buttons_gpio.c, buttons_gpio_encoder.c) share its folder.
while IFS=: read -r file line target; do
	case "$target" in
	drivers/drivers.h) continue ;;
	drivers/*) ;;
	*) continue ;;
	esac
	own=${file##*/}
	own=${own%.*}
	own=${own#*_}
	own=drivers/${own%%_*}/
	case "$target" in
	"$own"*) ;;
	*) complain "$file:$line: drivers may not include each other: \"$target\"" ;;
	esac
done < <(includes drivers | grep -E '^drivers/[^/]*:')

# What is found at each room's door.
while read -r room; do
	[ -f "$room/README.md" ] || complain "$room/README.md: missing; it says what belongs there"
done < <(sed -n 's/^\([a-z][^:]*\):.*/\1/p' $rooms; printf '%s\n' "${top[@]}" board)
while read -r files folder; do
	[ "$files" -le 30 ] || complain "$folder: $files files; nobody finds his way among more than 30"
done < <(find "${top[@]}" board -type f ! -path 'tests/fuzz/corpus/*' ! -name '*.pyc' | sed 's|/[^/]*$||' | sort | uniq -c)
exit $bad
