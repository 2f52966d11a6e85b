#!/bin/bash
# SPDX-License-Identifier: MIT
# Mesh files and their materials against Blender: it exports scenes (blender.py) and renders them by Cycles;
# inlay-bake path traces what it reads from these files under the same sky, through the same camera.
#     BUILD=build/x tests/accuracy/blender.sh [NAME ...]    the table, in Markdown: all cases, or some
#     BUILD=build/x tests/accuracy/blender.sh --test        the same as a test, in TAP
# Pictures, files and the table are left in build/accuracy/blender.
set -u
cd "$(dirname "$0")/../.." || exit 1
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
work=build/accuracy/blender
samples=128
quick=
if [ "${1:-}" = --test ]; then
	quick=yes
	shift
fi

say() { # NAME LEAST PSNR RMS MOST WHY
	local verdict="ok"

	awk "BEGIN { exit !($3 >= $2) }" || verdict="not ok"
	[ "$verdict" = ok ] || failed=1
	if [ "$quick" ]; then
		echo "$verdict $count - $1: $3 dB, expected $2"
	else
		echo "| $1 | $3 | $4 | $5 | ${6:-} |"
	fi
}

if ! command -v blender >/dev/null; then
	echo "blender.sh: there is no Blender, so mesh files were held against nothing: apt-get install blender" >&2
	[ "$quick" ] || exit 1
	echo "ok 1 - Blender # SKIP blender is not installed"
	echo "1..1"
	exit 0
fi
rm -rf "$work"
mkdir -p "$work"
if ! blender -b --factory-startup --python-exit-code 1 -P tests/accuracy/blender.py -- "$work" $samples "$@" \
	>"$work/blender.log" 2>&1; then
	echo "blender.sh: Blender failed" >&2
	tail -n 20 "$work/blender.log" >&2
	[ -z "$quick" ] || printf 'not ok 1 - Blender renders\n1..1\n'
	exit 1
fi
count=0
failed=0
[ "$quick" ] || printf '| case | PSNR dB | RMS | max | |\n|---|---|---|---|---|\n'
while read -r name least why; do
	count=$((count + 1))
	if ! "$build/inlay-bake" truth "$work/$name.scene" --panorama "$work/sky.hdr" --background "$work/ground.exr" \
		--samples $samples --quiet -o "$work/$name.pfm" 2>"$work/$name.log"; then
		echo "not ok $count - $name: inlay-bake truth failed"
		sed 's/^/# /' "$work/$name.log"
		failed=1
		continue
	fi
	[ -z "$quick" ] || sed 's/^/# /' "$work/$name.log"
	read -r psnr rms most < <("$build/tests/accuracy/compare" "$work/$name.pfm" "$work/$name.exr" \
		--difference "$work/$name-difference.png")
	say "$name" "$least" "$psnr" "$rms" "$most" "$why"
done <"$work/cases.txt"
[ -z "$quick" ] || echo "1..$count"
exit $failed
