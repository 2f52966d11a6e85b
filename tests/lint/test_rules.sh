#!/bin/bash
# SPDX-License-Identifier: MIT
# The checkers of the rooms and READMEs themselves: they pass this tree and refuse one that breaks each rule.
set -u
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
count=0
check() { # name, expected exit code, actual
	count=$((count + 1))
	if [ "$2" = "$3" ]; then echo "ok $count - $1"; else echo "not ok $count - $1"; fi
}

"$here/rooms.sh" "$root" >"$scratch/log" 2>&1
code=$?
sed 's/^/# /' "$scratch/log"
check "this tree keeps its rules" 0 $code

mkdir -p "$scratch"/{app/view,drivers/kms,hal/base,hal/ini,config,bake/mesh,tests/lint,board}
for folder in app app/view drivers drivers/kms hal hal/base hal/ini config bake bake/mesh tests board; do
	touch "$scratch/$folder/README.md"
done
rules=$scratch/tests/lint/rooms
plain='hal/base:
hal/ini: hal/base
drivers/kms: hal/*
drivers: hal/* drivers/*
config: hal/*
app/view: config
app: hal/* app/view drivers/drivers.h
bake/mesh: hal/*
bake:
tests: hal/*'
echo "$plain" >"$rules"

# try EXPECTED FILE INCLUDE NAME
try() {
	mkdir -p "$scratch/${2%/*}"
	echo "#include \"$3\"" >"$scratch/$2"
	"$here/rooms.sh" "$scratch" >"$scratch/log" 2>&1
	check "$4" "$1" $?
	sed 's/^/# /' "$scratch/log"
	rm "$scratch/$2"
}
try 0 hal/ini/x.c hal/base/y.h "a room may include one that its rule names"
try 0 hal/ini/x.c hal/ini/y.h "and what lies in it"
try 0 app/x.c drivers/drivers.h "and a header that its rule names"
try 1 app/x.c drivers/camera_y.h "but not another header beside that"
try 1 hal/base/x.c hal/ini/y.h "a room may not include one that its rule does not name"
try 1 bake/mesh/x.c config/y.h "in another folder neither"
try 1 drivers/camera_x.c drivers/display_y.h "a driver may not include another"
try 1 drivers/camera_x.c drivers/kms/y.h "nor another's folder"
try 0 drivers/display_kms.c drivers/kms/y.h "its own it may"
try 1 hal/new/x.c hal/base/y.h "a folder of sources that is no room is refused"
rm -rf "$scratch/hal/new"
echo "$plain" | sed 's|^hal/base:|& hal/ini|' >"$rules"
try 1 hal/ini/x.c hal/base/y.h "a rule may not name a room below it"
echo "$plain" >"$rules"
rm "$scratch/hal/ini/README.md"
try 1 hal/ini/x.c hal/base/y.h "a room without a README is refused"
touch "$scratch/hal/ini/README.md" "$scratch"/hal/ini/{1..30}.txt
try 1 hal/ini/x.c hal/base/y.h "a folder of more than 30 files is refused"

# words.sh
words() { # EXPECTED NAME
	"$here/words.sh" "$scratch" >"$scratch/log" 2>&1
	check "$2" "$1" $?
	sed 's/^/# /' "$scratch/log"
}
many() { # COUNT: as many words
	yes word | head -n "$1"
}
many 900 >"$scratch/README.md"
{
	many 300
	echo "# a heading"
	echo "| a table | $(many 99 | xargs) |"
	echo "    some code, [not](code.c)"
} >"$scratch/hal/README.md"
touch "$scratch/hal/code.c"
words 0 "900 words at the top and 300 of prose in a room are allowed"
echo word >>"$scratch/hal/README.md"
words 1 "301 words of prose in a room are refused"
echo "[code](code.c) [elsewhere](https://example.org/none.c) [there](../README.md#x)" >"$scratch/hal/README.md"
words 0 "links to what exists are allowed"
echo "[code](gone.c)" >>"$scratch/hal/README.md"
words 1 "a link that leads nowhere is refused"
rm "$scratch/hal/README.md"
echo word >>"$scratch/README.md"
words 1 "901 words at the top are refused"

# circles.sh
cd "$scratch" || exit 1
mkdir -p "$scratch/objects/hal"
compile() { # NAME SOURCE
	echo "$2" >"$scratch/hal/$1.c"
	${CC:-gcc} -c -o "$scratch/objects/hal/$1.o" "$scratch/hal/$1.c"
}
compile one 'int two(void); int one(void) { return two(); }'
compile two 'int two(void) { return 2; }'
"$here/circles.sh" objects hal >"$scratch/log" 2>&1
check "files that call one way only are no circle" 0 $?
compile two 'int three(void); int two(void) { return three(); }'
compile three 'int one(void); int three(void) { return one(); }'
"$here/circles.sh" objects hal >"$scratch/log" 2>&1
check "files that call each other are one" 1 $?
check "which is named" 0 "$(grep -q 'hal/one.o.*hal/two.o\|hal/two.o.*hal/one.o' <(xargs <"$scratch/log"); echo $?)"
rm hal/three.c
"$here/circles.sh" objects hal >"$scratch/log" 2>&1
check "what was compiled of a file that has gone does not count" 0 $?
"$here/circles.sh" empty hal >/dev/null 2>&1
check "no objects are no proof" 1 $?
echo "1..$count"
