#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs test programs that speak TAP, keeps their full output, and counts.
#     tests/run.sh GROUP PROGRAM... [-- GROUP PROGRAM...]...      runs, adds to build/tests/results
#                                        ("PROGRAM OPTION" is one word)
#     tests/run.sh --begin               forgets earlier results
#     tests/run.sh --make TARGET...      makes each, which runs groups; one that fails keeps no other from it
#     tests/run.sh --end                 prints what took longest and "N passed, M failed"; fails unless M is 0
# All groups share one queue. One program more runs at a time than there are processors, because some of
# them wait (TEST_JOBS=n: another number). Each has a line when it ends; one that fails is told whole at once
# and again at the end. When nothing has ended for most of a minute, what runs is named. The programs named in
# "alone" run by themselves.
# A program that dies, or exits non-zero without a "not ok", or prints no test at all, is a failure; so is
# one that leaves a process running, which is named and ended: it would keep a jobserver's pipe open, and
# make waits at its end for that.
# A test that skips itself must say why ("ok N - name # SKIP reason"); skips are listed at the end.
set -u
cd "$(dirname "$0")/.." || exit 1
results=build/tests/results
times=build/tests/times # a line for each program: seconds by the clock, of processors, name
logs=build/tests/logs
failures=build/tests/failures # what the programs that failed said
silence=50                    # seconds without a line until what runs is named

# slowest: the ten programs that took longest, by processor and by clock.
slowest() {
	[ -s "$times" ] || return
	awk '{ clock += $1; processor += $2 }
		END { printf "all programs: %d s of processors, %d s by their clocks\n", processor, clock }' "$times"
	echo "the ten slowest, by processor and by clock, in seconds:"
	paste <(sort -k2,2nr "$times" | awk 'NR <= 10 { printf "  %5.0f  %-32s\n", $2, $3 }') \
		<(sort -k1,1nr "$times" | awk 'NR <= 10 { printf "%5.0f  %s\n", $1, $3 }')
}

case "${1:-}" in
--begin)
	rm -rf "$results" "$times" "$failures" "$logs"
	mkdir -p "$logs"
	: >"$results"
	: >"$failures"
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
	cat "$failures"
	slowest
	grep '^skip' "$results" | sed 's/^skip /skipped: /'
	grep '^fail' "$results" | sed 's/^fail /FAILED:  /'
	passed=$(grep -c '^pass' "$results")
	failed=$(grep -c '^fail' "$results")
	skipped=$(grep -c '^skip' "$results")
	echo "$passed passed, $failed failed, $skipped skipped"
	[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
	exit
	;;
esac

# What holds times against each other, or builds what others run, is not run beside others.
alone=" unit/test_bench unit/test_measure cli/report cli/deb "

mkdir -p "$logs"

# The queue: programs[i] of the group groups[i].
programs=()
groups=()
group=
for word in "$@"; do
	if [ "$word" = -- ]; then
		group=
	elif [ -z "$group" ]; then
		group=$word
	else
		programs+=("$word")
		groups+=("$group")
	fi
done

# name_of NUMBER, log_of NAME
name_of() {
	local path option
	read -r path option <<<"${programs[$1]}"
	echo "${groups[$1]}/$(basename "$path" .sh)$option"
}
log_of() {
	echo "$logs/${1//\//-}.log"
}

# left_running MARK: a line "PID COMMAND" for each process whose environment says that MARK started it.
left_running() {
	local _ pid
	grep -lsz "^INLAY_TEST_RUN=$1\$" /proc/[0-9]*/environ | while IFS=/ read -r _ _ pid _; do
		echo "$pid $(tr '\0' ' ' <"/proc/$pid/cmdline")"
	done 2>/dev/null
}

# end_what_is_left MARK: ends it; a line for each that was there still after a minute (a busy
# machine takes its time to end what was told to).
end_what_is_left() {
	local left _
	for _ in {1..600}; do
		left=$(left_running "$1")
		[ -n "$left" ] || return 0
		sleep 0.1
	done
	# shellcheck disable=SC2046 # one word for each process
	kill -KILL $(cut -d' ' -f1 <<<"$left") 2>/dev/null
	echo "$left"
}

# one NUMBER: runs it; leaves its log, and beside that what it counts and how long it took.
one() {
	local name log code planned ran command mark left TIMEFORMAT='%1R %1U %1S'
	name=$(name_of "$1")
	read -ra command <<<"${programs[$1]}"
	log=$(log_of "$name")
	mark=$$-$1
	{ time INLAY_TEST_RUN=$mark CMOCKA_MESSAGE_OUTPUT=TAP "${command[@]}" >"$log" 2>&1 </dev/null; } 2>"$log.seconds"
	code=$?
	left=$(end_what_is_left "$mark")
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
	[ -z "$left" ] || echo "fail $name: left running: ${left//$'\n'/; }" >>"$log.counts"
	mv "$log.counts" "$log.done"
}

# tell NUMBER: what it found; true if nothing failed.
tell() {
	local name log failed passed skipped wall user system
	name=$(name_of "$1")
	log=$(log_of "$name")
	cat "$log.done" >>"$results"
	failed=$(grep -c '^fail' "$log.done")
	passed=$(grep -c '^pass' "$log.done")
	skipped=$(grep -c '^skip' "$log.done")
	read -r wall user system <"$log.seconds"
	echo "$wall $(awk "BEGIN { print $user + $system }") $name" >>"$times"
	told=$((told + 1))
	printf '[%*d/%d] %-40s %s%s%s (%.1f s)\n' ${#count} $told "$count" "$name" "$passed passed" \
		"$([ "$failed" -eq 0 ] || echo ", $failed failed")" \
		"$([ "$skipped" -eq 0 ] || echo ", $skipped skipped")" "$wall"
	rm -f "$log.done" "$log.seconds"
	[ "$failed" -gt 0 ] || return 0
	# What failed may lie far from the end; who died says so at the end.
	{
		echo "$name failed:"
		{
			awk '/^(not )?ok/ { failed = /^not/ && !/# SKIP/ } failed' "$log" | head -n 200
			grep -v -E '^(not )?ok' "$log" | tail -n 10
		} | sed 's/^/    /'
		echo "    whole output: $log"
	} | tee -a "$failures"
	return 1
}

count=${#programs[@]}
all_well=0
told=0
running=0
# tell_ended: tells of those that have ended.
tell_ended() {
	local number
	for number in "${!started[@]}"; do
		[ -e "$(log_of "$(name_of "$number")").done" ] || continue
		unset "started[$number]"
		tell "$number" || all_well=1
	done
}
# wait_until_below NUMBER: waits until fewer than that run. The pulse names what runs when nothing ends.
wait_until_below() {
	local ended
	while [ $running -ge "$1" ]; do
		wait -n -p ended
		if [ "$ended" = "$pulse" ]; then
			printf '  running: %s\n' "$(for number in "${!started[@]}"; do name_of "$number"; done | paste -sd ' ')"
		else
			running=$((running - 1))
			tell_ended
			kill "$pulse" 2>/dev/null
			wait "$pulse" 2>/dev/null
		fi
		sleep $silence &
		pulse=$!
	done
}

declare -A started # numbers of those that run
sleep $silence &
pulse=$!
for number in "${!programs[@]}"; do
	rm -f "$(log_of "$(name_of "$number")").done"
done
for number in "${!programs[@]}"; do
	most=${TEST_JOBS:-$(($(nproc) + 1))}
	[[ $alone != *" $(name_of "$number") "* ]] || most=1
	wait_until_below "$most"
	started[$number]=1
	one "$number" &
	running=$((running + 1))
	[ "$most" -gt 1 ] || wait_until_below 1
done
wait_until_below 1
kill "$pulse" 2>/dev/null
exit $all_well
