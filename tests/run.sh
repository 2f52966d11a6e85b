#!/bin/bash
# Runs test programs that speak TAP, keeps their full output, and counts.
#     tests/run.sh GROUP PROGRAM...      runs, adds to build/tests/results
#     tests/run.sh --begin               forgets earlier results
#     tests/run.sh --end                 prints "N passed, M failed" and fails unless M is 0
# A program that dies, or exits non-zero without a "not ok", or prints no test at all, is a failure.
# A test that skips itself must say why ("ok N - name # SKIP reason"); skips are listed at the end.
set -u
cd "$(dirname "$0")/.." || exit 1
results=build/tests/results
logs=build/tests/logs

case "${1:-}" in
--begin)
	rm -rf build/tests/results build/tests/logs
	mkdir -p "$logs"
	: >"$results"
	exit 0
	;;
--end)
	[ -s "$results" ] || {
		echo "no test ran" >&2
		exit 1
	}
	grep '^skip' "$results" | sed 's/^skip /skipped: /'
	grep '^fail' "$results" | sed 's/^fail /FAILED:  /'
	passed=$(grep -c '^pass' "$results")
	failed=$(grep -c '^fail' "$results")
	skipped=$(grep -c '^skip' "$results")
	if [ "$skipped" -gt 0 ]; then
		echo "$passed passed, $failed failed, $skipped skipped"
	else
		echo "$passed passed, $failed failed"
	fi
	[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
	exit
	;;
esac

group=$1
shift
mkdir -p "$logs"
all_well=0
for program in "$@"; do
	name=$group/$(basename "$program" .sh)
	log=$logs/${name//\//-}.log
	start=$(date +%s)
	CMOCKA_MESSAGE_OUTPUT=TAP "$program" >"$log" 2>&1 </dev/null
	code=$?
	# Both cmocka and the shell tests mark skips with "# SKIP"; Debian 12's cmocka calls them "not ok".
	awk -v name="$name" '
		/^not ok [0-9]+ # SKIP/ { sub(/^not ok [0-9]* # /, ""); print "skip " name ": " $0; next }
		/^not ok/ { sub(/^not ok [0-9]* -? ?/, ""); print "fail " name ": " $0; next }
		/^ok.*# ?SKIP/ { sub(/^ok [0-9]* -? ?/, ""); print "skip " name ": " $0; next }
		/^ok/ { sub(/^ok [0-9]* -? ?/, ""); print "pass " name ": " $0 }' "$log" >"$log.counts"
	planned=$(sed -n 's/^1\.\.\([0-9]*\).*/\1/p' "$log" | awk '{ s += $1 } END { print s + 0 }')
	ran=$(wc -l <"$log.counts")
	if ! grep -q '^fail' "$log.counts"; then
		if [ $code -ne 0 ]; then
			echo "fail $name: exit code $code" >>"$log.counts"
		elif [ "$ran" -eq 0 ]; then
			echo "fail $name: ran no test" >>"$log.counts"
		elif [ "$planned" -gt "$ran" ]; then
			echo "fail $name: planned $planned tests, ran $ran" >>"$log.counts"
		fi
	fi
	cat "$log.counts" >>"$results"
	failed=$(grep -c '^fail' "$log.counts")
	passed=$(grep -c '^pass' "$log.counts")
	printf '%-44s %3d passed, %d failed (%d s)\n' "$name" "$passed" "$failed" \
		$(($(date +%s) - start))
	if [ "$failed" -gt 0 ]; then
		all_well=1
		grep -v '^ok' "$log" | tail -n 25 | sed 's/^/    /'
		echo "    whole output: $log"
	fi
	rm -f "$log.counts"
done
exit $all_well
