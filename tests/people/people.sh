#!/bin/bash
# SPDX-License-Identifier: MIT
# Judges how people are found: bakes the object, walks people around it. `make people` calls it.
#     BUILD=build/x tests/people/people.sh [FRAMES [CASE [FOLDER [LATER_S]]]]
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay-bake}
basis=$build/tests/people/people.inlay
if [ ! "$basis" -nt tests/people/people.scene ]; then
	"$build/inlay-bake" render --quiet --no-preview -o "$basis" tests/people/people.scene
fi
exec "$build/tests/people/judge" "$basis" "$@"
