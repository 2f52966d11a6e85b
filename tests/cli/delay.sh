#!/bin/bash
# SPDX-License-Identifier: MIT
# How many frames a camera takes to obey a control, measured live: against the clock, so nothing else may run
# beside it (tests/run.sh).
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

light() {
	"${INLAY_CALIBRATE:?the program inlay-calibrate}" light "$@"
}
sed 's/^sim.clock = frames/sim.clock = real\nrate = 30\nsim.control_delay = 3/' "$work/studio.conf" >"$work/live.conf"
check "delay of the camera itself" light delay --config "$work/live.conf" --view fisheye \
	--control exposure=0.05 --control exposure=0.2 -o "$work/eye.ini" --report "$work/delay"
sed -n 's/^; delay/# delay/p' "$work/eye.ini"
check "is that of the camera" grep -qE '^; delay: [34] frames' "$work/eye.ini"
finish
