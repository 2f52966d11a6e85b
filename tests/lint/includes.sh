#!/bin/bash
# SPDX-License-Identifier: MIT
# Who may include whom. One line a folder; everything else that is ours is refused.
# Fails with file:line of each include that goes against the arrows.
set -u
root=${1:-$(dirname "$0")/../..}
cd "$root" || exit 1

# folder            prefixes it may include; a folder inside another comes before it
arrows='
hal                 hal/
drivers             hal/ drivers/
config              hal/ config/
app                 hal/ config/ app/ drivers/drivers.h
bake/calibrate      hal/ config/ bake/ drivers/drivers.h
bake                hal/ bake/
tests               hal/ drivers/ config/ app/ bake/ tests/
'

bad=0
inner=bake/calibrate
complain() {
	echo "$1" >&2
	bad=1
}

# includes FOLDER: "file:line:target" of each include of ours. No process for each of them here nor below:
# there are some thousands.
includes() {
	grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' "$1" \
		--include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp' |
		sed 's/^\([^:]*:[0-9]*:\).*"\(.*\)".*/\1\2/'
}

while read -r folder allowed; do
	[ -n "$folder" ] && [ -d "$folder" ] || continue
	while IFS=: read -r file line target; do
		fine=0
		# what is inside has a line of its own, and nothing outside may see it
		case "$folder:$file" in bake:$inner/*) continue ;; esac
		case "$folder:$target" in bake:$inner/*)
			complain "$file:$line: $folder/ may not include \"$target\""
			continue ;;
		esac
		for prefix in $allowed; do
			case "$target" in "$prefix"*) fine=1 ;; esac
		done
		[ $fine = 1 ] || complain "$file:$line: $folder/ may not include \"$target\" (only: $allowed)"
	done < <(includes "$folder")
done <<<"$arrows"

# Drivers never include each other: only their own private folder, named after the part behind the first
# _, up to the next: drivers of one library share theirs.
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
	home=${file%/*}/
	case "$target" in
	"$own"*) ;;
	"$home"*) [ "$home" != drivers/ ] || complain "$file:$line: drivers may not include each other: \"$target\"" ;;
	*) complain "$file:$line: drivers may not include each other: \"$target\"" ;;
	esac
done < <(includes drivers)

# Each top folder says what belongs in it.
for folder in app drivers hal config bake tests board; do
	[ -f "$folder/README.md" ] || complain "$folder/README.md: missing; it says what belongs in $folder/"
done
exit $bad
