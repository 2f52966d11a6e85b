#!/bin/bash
# SPDX-License-Identifier: MIT
# The include checker itself: it passes this tree and refuses a tree that breaks each rule.
set -u
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
echo 1..7
count=0
check() { # name, expected exit code, actual
	count=$((count + 1))
	if [ "$2" = "$3" ]; then echo "ok $count - $1"; else echo "not ok $count - $1"; fi
}

"$here/includes.sh" "$root" >"$scratch/log" 2>&1
code=$?
sed 's/^/# /' "$scratch/log"
check "this tree keeps the arrows" 0 $code

mkdir -p "$scratch"/{app,drivers,hal,config,bake/calibrate,tests,board}
touch "$scratch"/{app,drivers,hal,config,bake,tests,board}/README.md
try() { # file, include, name
	echo "#include \"$2\"" >"$scratch/$1"
	"$here/includes.sh" "$scratch" >/dev/null 2>&1
	check "$3" 1 $?
	rm "$scratch/$1"
}
try hal/x.c app/x.h "hal/ including app/ is refused"
try drivers/camera_x.c drivers/display_y.h "a driver including another is refused"
try bake/x.c config/x.h "bake/ including config/ is refused"
try bake/x.c bake/calibrate/x.h "bake/ including bake/calibrate/ is refused"
try bake/calibrate/x.c drivers/camera_x.c "bake/calibrate/ including a driver is refused"
try bake/calibrate/x.c app/x.h "bake/calibrate/ including app/ is refused"
