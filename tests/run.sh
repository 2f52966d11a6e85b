#!/bin/bash
# Runs test programs that speak TAP, keeps their full output, and counts.
#     tests/run.sh GROUP PROGRAM...      runs, adds to build/tests/results
#     tests/run.sh --begin               forgets earlier results
#     tests/run.sh --make TARGET...      makes each, which runs a group; one that fails keeps no other from it
#     tests/run.sh --end                 prints "N passed, M failed" and fails unless M is 0
# As many programs run at a time as there are processors (TEST_JOBS=n: another number), and what they
# found is told in the order in which they are given. Those named below need the machine for themselves.
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
--make)
	shift
	for target in "$@"; do
		before=$(grep -c '^fail' "$results")
		"${MAKE:-make}" --no-print-directory "$target" && continue
		# It may have ended before any program of its ran.
		[ "$(grep -c '^fail' "$results")" -gt "$before" ] ||
			echo "fail $target: could not be run" >>"$results"
	done
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

# What holds times against each other, or builds what others run, is not run beside others.
alone=" unit/test_bench unit/test_measure cli/bench cli/report cli/deb "

group=$1
shift
mkdir -p "$logs"

# name_of PROGRAM, log_of NAME
name_of() {
	echo "$group/$(basename "$1" .sh)"
}
log_of() {
	echo "$logs/${1//\//-}.log"
}

# one PROGRAM: runs it; leaves its log, and beside that what it counts and how long it took.
one() {
	local name log code planned ran TIMEFORMAT='%0R %0U %0S'
	name=$(name_of "$1")
	log=$(log_of "$name")
	{ time CMOCKA_MESSAGE_OUTPUT=TAP "$1" >"$log" 2>&1 </dev/null; } 2>"$log.seconds"
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
	mv "$log.counts" "$log.done"
}

# tell PROGRAM: what it found; true if nothing failed.
tell() {
	local name log failed passed wall user system
	name=$(name_of "$1")
	log=$(log_of "$name")
	cat "$log.done" >>"$results"
	failed=$(grep -c '^fail' "$log.done")
	passed=$(grep -c '^pass' "$log.done")
	read -r wall user system <"$log.seconds"
	printf '%-44s %3d passed, %d failed (%d s, %d s of processors)\n' "$name" "$passed" "$failed" \
		"$wall" $((user + system))
	rm -f "$log.done" "$log.seconds"
	[ "$failed" -gt 0 ] || return 0
	# What failed may lie far from the end; who died says so at the end.
	{
		awk '/^(not )?ok/ { failed = /^not/ && !/# SKIP/ } failed' "$log" | head -n 40
		grep -v -E '^(not )?ok' "$log" | tail -n 10
	} | sed 's/^/    /'
	echo "    whole output: $log"
	return 1
}

all_well=0
programs=("$@")
told=0
running=0
# Tells of those that have ended, up to the first that has not.
tell_ended() {
	while [ $told -lt ${#programs[@]} ] && [ -e "$(log_of "$(name_of "${programs[told]}")").done" ]; do
		tell "${programs[told]}" || all_well=1
		told=$((told + 1))
	done
}
# wait_until_below NUMBER: no more than that run.
wait_until_below() {
	while [ $running -ge "$1" ]; do
		wait -n
		running=$((running - 1))
		tell_ended
	done
}

for program in "${programs[@]}"; do
	rm -f "$(log_of "$(name_of "$program")").done"
done
for program in "${programs[@]}"; do
	most=${TEST_JOBS:-$(nproc)}
	[[ $alone != *" $(name_of "$program") "* ]] || most=1
	wait_until_below "$most"
	one "$program" &
	running=$((running + 1))
	[ "$most" -gt 1 ] || wait_until_below 1
done
wait_until_below 1
exit $all_well
