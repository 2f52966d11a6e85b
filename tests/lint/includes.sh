#!/bin/bash
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

while read -r folder allowed; do
	[ -n "$folder" ] && [ -d "$folder" ] || continue
	while IFS=: read -r file line text; do
		target=$(printf '%s' "$text" | sed 's/.*"\(.*\)".*/\1/')
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
	done < <(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' "$folder" \
		--include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp')
done <<<"$arrows"

# Drivers never include each other: only their own private folder, named after the part behind the first
# _, up to the next: drivers of one library share theirs.
while IFS=: read -r file line text; do
	target=$(printf '%s' "$text" | sed 's/.*"\(.*\)".*/\1/')
	case "$file $target" in
	*" drivers/drivers.h") continue ;;
	esac
	own=$(basename "${file%.*}")
	own=${own#*_}
	own=drivers/${own%%_*}/
	home=$(dirname "$file")/
	case "$target" in
	"$own"*) ;;
	"$home"*) [ "$home" != drivers/ ] || complain "$file:$line: drivers may not include each other: \"$target\"" ;;
	*) complain "$file:$line: drivers may not include each other: \"$target\"" ;;
	esac
done < <(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"drivers/' drivers \
	--include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp')

# Each top folder says what belongs in it.
for folder in app drivers hal config bake tests board; do
	[ -f "$folder/README.md" ] || complain "$folder/README.md: missing; it says what belongs in $folder/"
done
exit $bad
