#!/bin/sh
# Before each start of inlay.service: waits when starts follow one another closely, so that a kiosk
# that cannot start neither fills the journal nor takes the processor. The second start within a
# minute goes on at once (RestartSec= has passed already), then it waits 2, 4, 8, 16, 30, 30 ... s.
# systemd has this as RestartSteps= from version 254 on; it is never reset there by a start that went
# well, here it is.
set -eu
memory=$RUNTIME_DIRECTORY/back-off # kept while systemd restarts, gone after a stop
last=0 delay=0
if [ -r "$memory" ]; then
	read -r last delay <"$memory" || :
fi
now=$(date +%s)

# Ran for a minute, or first of all, or the clock was set back.
if [ "$((now - last))" -ge 60 ] || [ "$now" -lt "$last" ]; then
	delay=0
elif [ "$delay" -eq 0 ]; then
	delay=1
else
	delay=$((delay * 2 < 30 ? delay * 2 : 30))
fi
if [ "$delay" -gt 1 ]; then
	echo "<5>started again too soon: waiting $delay s" >&2
	sleep "$delay"
	now=$((now + delay))
fi
echo "$now $delay" >"$memory"
