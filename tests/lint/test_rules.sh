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

# house.sh
cd "$here" || exit 1
judge() { # EXPECTED NAME, the source at stdin
	cat >"$scratch/hal/house.c"
	"$here/house.sh" "$scratch/hal/house.c" >"$scratch/log" 2>&1
	check "$2" "$1" $?
}
many() { printf '\tint a%d; /* one, of many; and more */\n' $(seq "$1"); }
judge 0 "a struct of 25 members" < <(echo 'struct large {' && many 25 && echo '};')
judge 1 "one of 26 is refused" < <(echo 'struct large {' && many 24 && echo '	int b, c;' && echo '};')
judge 1 "a comment wider than 100 columns is refused" < <(printf '/* %099d */\n' 0)
judge 0 "one as wide is not" < <(printf '/* %094d */\n' 0)
judge 1 "a torn string is refused" < <(printf 'f("torn "\n  "text");\n')
judge 0 "one of two lines is not" < <(printf 'f("a line\\n"\n  "another");\n')
judge 0 "nor is one that is longer than a line may be" < <(printf 'f("%090d"\n  "%090d");\n' 0 0)

# size.sh
echo '1 hal' >"$scratch/tests/lint/size"
rm -f "$scratch"/*/*.c
echo 'int one;' >"$scratch/hal/one.c"
"$here/size.sh" "$scratch" >/dev/null 2>&1
check "a folder within its lines" 0 $?
echo 'int two;' >>"$scratch/hal/one.c"
"$here/size.sh" "$scratch" >/dev/null 2>&1
check "one above them is refused" 1 $?
echo 'int new;' >"$scratch/app/new.c"
echo '2 hal' >"$scratch/tests/lint/size"
"$here/size.sh" "$scratch" >/dev/null 2>&1
check "a folder without a limit is refused" 1 $?
"$here/size.sh" --record "$scratch"
"$here/size.sh" "$scratch" >/dev/null 2>&1
check "a recorded table holds" 0 $?
echo "1..$count"
