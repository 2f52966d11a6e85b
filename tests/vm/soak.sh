#!/bin/bash
# SPDX-License-Identifier: MIT
# Inside the simulated machine: a kiosk that runs while things go wrong at random, and what it uses
# meanwhile. After the first third memory and descriptors may not grow; after the last fault
# everything works as before, in the same process.
#
#     soak.sh MINUTES SEED [RSS_SLACK_KB]      (or longer, until there have been nine faults)
#
# Writes a table to $VM_OUT/soak.txt and TAP to stdout. INLAY is the program.
. tests/vm/guest/tap.sh
. tests/vm/guest/devices.sh
. tests/vm/guest/runs.sh
. tests/vm/guest/faults.sh

seconds=$(awk "BEGIN { print int($1 * 60) }")
seed=$2
slack_kb=${3:-1024}
RANDOM=$seed
faults=(unplugged all_unplugged silent lossy corrupt no_signal screen_unplugged gpio_gone disk_full
	wrong_conf no_descriptors frozen pressed commanded rubbish)

# Faults without an end of their own.
pressed_begin() { press_button; }
pressed_end() { :; }
commanded_begin() { act threshold-set $((RANDOM % 200)) && act view-next && act information; }
commanded_end() { :; }
rubbish_begin() {
	python3 -c 'import os, socket, sys
s = socket.socket(socket.AF_UNIX)
s.connect(sys.argv[1])
s.sendall(os.urandom(600))' $control_socket
}
rubbish_end() { :; }

# The next fault: all of them in an order of chance, then all again in another.
bag=()
draw() {
	local i
	[ ${#bag[@]} -gt 0 ] || bag=("${faults[@]}")
	i=$((RANDOM % ${#bag[@]}))
	fault=${bag[i]}
	bag=("${bag[@]:0:i}" "${bag[@]:i+1}")
}

sample() {
	local rss fds
	rss=$(awk '$1 == "VmRSS:" { print $2 }' "/proc/$running/status")
	fds=$(find "/proc/$running/fd" -mindepth 1 | wc -l)
	printf '%d\t%d\t%d\t%d\t%d\t%s\n' $((SECONDS - begun)) "$rss" "$fds" \
		"$(stat soak frames)" "$(stat soak drops)" "$1" >>"$VM_OUT/soak.txt"
}

# The same state of things each time: all devices there, all fine.
settled() { all_fine && [ "$(of_status screen)" = fine ]; }

faults_load
printf 'seconds\trss_kb\tdescriptors\tframes\tdrops\tafter\n' >"$VM_OUT/soak.txt"
kiosk soak --set people.occlude=yes --set composite.grain=yes
begun=$SECONDS
if eventually settled; then
	ok "the kiosk starts"
else
	tail -n 5 "$VM_OUT/soak.log" | not_ok "the kiosk starts"
fi
count=0
stuck=0
# On a busy host a minute holds few faults: no fewer than nine are begun.
while { [ $((SECONDS - begun)) -lt "$seconds" ] || [ $count -lt 9 ]; } && kill -0 $running 2>/dev/null; do
	draw
	length=$((RANDOM % 3 + 1))
	"${fault}_begin" >/dev/null 2>&1
	# The one wait of a set time here: a fault lasts.
	sleep $length
	"${fault}_end" >/dev/null 2>&1
	count=$((count + 1))
	if ! eventually settled; then
		stuck=$((stuck + 1))
		{
			echo "after fault $count, $fault of $length s:"
			status
			tail -n 5 "$VM_OUT/soak.log"
		} | not_ok "it recovers from $fault"
	fi
	sample "$fault"
done
check "the kiosk was never restarted" kill -0 $running
[ $stuck -gt 0 ] || ok "it recovered from each of $count faults (seed $seed)"
check "pictures go on" pictures_go_on 60

# The cameras' test pictures move, so that somebody may be seen in them at any time. The shares are shares.
seen_people() {
	awk 'match($0, /"learned":[0-9.]+,"parts":[0-9]+,"in_front":[0-9]+/) {
			split(substr($0, RSTART, RLENGTH), v, /[:,]/)
			if (v[2] < 0 || v[2] > 1 || v[6] > v[4]) wrong++
			if (v[2] > learned) learned = v[2]
			lines++
		}
		END { printf "%d lines, %d wrong, %g learned\n", lines, wrong, learned; exit !(lines > 9 && !wrong && learned > 0) }' \
		"$VM_OUT/soak.jsonl"
}
check "people are looked for all the time" seen_people
check "what was learned of the place is kept" test -s $state_folder/state.place

# Flat after warm-up: the highest of the last third is not above the highest of the middle one.
flat() { # column slack
	awk -F '\t' -v column="$1" -v slack="$2" 'NR > 1 { v[++n] = $column }
		END {
			for (i = int(n / 3) + 1; i <= int(2 * n / 3); i++) if (v[i] > middle) middle = v[i]
			for (i = int(2 * n / 3) + 1; i <= n; i++) if (v[i] > last) last = v[i]
			printf "from %d to %d in %d samples\n", middle, last, n
			exit !(n >= 6 && last <= middle + slack)
		}' "$VM_OUT/soak.txt"
}
check "memory is flat" flat 2 "$slack_kb"
check "descriptors are flat" flat 3 0
stop_run
equal "it ends well" 0 $?
matches "no sanitizer had anything to say" '^0$' \
	"$(grep -c -E 'runtime error|AddressSanitizer|LeakSanitizer|ThreadSanitizer' "$VM_OUT/soak.log")"
faults_unload
sed 's/^/# /' "$VM_OUT/soak.txt"
