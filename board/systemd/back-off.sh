#!/bin/sh
# SPDX-License-Identifier: MIT
# Before each start of inlay.service: waits when starts follow one another closely, so that a kiosk
# that cannot start neither fills the journal nor takes the processor. The second start within a
# minute goes on at once (RestartSec= has passed already), then it waits 2, 4, 8, 16, 30, 30 ... s.
# systemd has this as RestartSteps= from version 254 on; it is never reset there by a start that went
# well, here it is.
set -eu
memory=$RUNTIME_DIRECTORY/back-off # kept while systemd restarts, gone after a stop
last=0 delay=0
if [ -f "$memory" ]; then
	read -r last delay <"$memory" || :
fi
# What is not of our writing counts as nothing.
case $last in
'' | 0* | *[!0-9]* | ???????????*) last=0 ;;
esac
case $delay in
[0-9] | [1-3][0-9]) ;;
*) last=0 delay=0 ;;
esac
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
# In place and always as long, so that a full /run still takes it. Where it cannot be kept, each start
# is put off a little.
if ! printf '%d %2d\n' "$now" "$delay" 2>/dev/null 1<>"$memory"; then
	echo "<4>cannot write $memory: waiting 5 s" >&2
	sleep 5
fi
