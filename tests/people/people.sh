#!/bin/bash
# SPDX-License-Identifier: MIT
# Judges how people are found in drawn rooms. What is missing of a room is baked and rendered first (minutes, 6 GB
# below BUILD); after that a run takes a minute. `make people` calls it.
#     BUILD=build/x tests/people/people.sh [ROOM|loop|nudge [PICTURES]]
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
rooms=$build/tests/people/rooms
render=$build/tests/people/render
mkdir -p "$rooms"
cp -u bake/demo/box.obj "$rooms/"
prepare() {
	"$render" "$1" >"$rooms/$1.scene.new"
	cmp -s "$rooms/$1.scene.new" "$rooms/$1.scene" && [ -e "$rooms/$1.room" ] && return
	"$build/inlay-bake" render --quiet --no-preview -o "$rooms/$1.inlay" "$rooms/$1.scene.new"
	"$render" "$1" "$rooms/$1.inlay" "$rooms/$1.room"
	mv "$rooms/$1.scene.new" "$rooms/$1.scene"
}
case ${1:-} in
[0-9]*) prepare "$1" ;;
*)
	for room in 0 1 2 3 4 5 6 7 8 9 10 11; do
		prepare $room
	done
	;;
esac
[ -z "${2:-}" ] || mkdir -p "$2"
exec "$build/tests/people/judge" "$rooms" "$@"
