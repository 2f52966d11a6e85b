#!/bin/bash
# SPDX-License-Identifier: MIT
# For changes that users must not see: builds another revision beside this tree and compares, byte by byte, what both
# make of the demo: its mesh, its basis file, a still, and the pictures and the clip of a run.
#
#     BUILD=build/x tests/same_output.sh REVISION [OPTION...]       (make same-output REVISION=HEAD~1)
# Options are for `inlay-bake render`; the demo's own scene with none of them takes minutes for each side.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
revision=${1:?is missing: expected the revision to compare with}
shift
commit=$(git rev-parse --verify "$revision^{commit}")
tree=$PWD/build/same-output/tree
here=$PWD/build/same-output/now
there=$PWD/build/same-output/then

git worktree prune
if [ -e "$tree/.git" ]; then
	git -C "$tree" checkout --quiet --detach "$commit"
else
	git worktree add --quiet --detach "$tree" "$commit"
fi
echo "same-output: building ${commit:0:10}"
make -C "$tree" --no-print-directory -j"$(nproc)" BUILD=build/then all >"$tree.log" 2>&1 || {
	tail -n 20 "$tree.log" >&2
	exit 1
}

# outputs TREE BUILD FOLDER [OPTION...]
outputs() {
	local tree=$1 build=$2 folder=$3
	shift 3
	rm -rf "$folder"
	(cd "$tree" && BUILD=$build bake/demo/demo.sh "$folder" "$@") >"$folder.log" 2>&1 || {
		tail -n 20 "$folder.log" >&2
		return 1
	}
	"$tree/$build/inlay" still --basis "$folder/cow.inlay" --background "$folder/before.png" \
		--lights <(printf '1 0.9 0.8\n%.0s' $(seq "$("$tree/$build/inlay-bake" info --json "$folder/cow.inlay" |
			sed -n 's/.*"lights": *\([0-9]*\).*/\1/p' | head -n 1)")) -o "$folder/still.png"
}
echo "same-output: both demos"
outputs "$tree" build/then "$there" "$@"
outputs "$PWD" "$build" "$here" "$@"

differ=0
for file in "$there"/*; do
	name=${file##*/}
	if cmp "$file" "$here/$name"; then
		echo "same: $name ($(stat -c %s "$file") bytes)"
	else
		differ=1
	fi
done
exit $differ
