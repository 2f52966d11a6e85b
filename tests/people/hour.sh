#!/bin/bash
# SPDX-License-Identifier: MIT
# An hour of people before the kiosk, on the simulated clock: lamps move and are switched, the camera exposes
# by itself and is noisy, two people come and go. Ten minutes of the empty room before and after tell whether
# the hour taught the kiosk something wrong, and its memory whether it leaks. It measures, and never fails.
#     BUILD=build/x tests/people/hour.sh [SECONDS]
set -eu
cd "$(dirname "$0")/../.."
build=${BUILD:?is not set: expected the folder that holds inlay}
seconds=${1:-3600}
rate=5
out=$build/tests/people/hour
basis=$build/tests/people/people.inlay
rm -rf "$out"
mkdir -p "$out"
if [ ! "$basis" -nt tests/people/people.scene ]; then
	"$build/inlay-bake" render --quiet --no-preview -o "$basis" tests/people/people.scene
fi
cat >"$out/kiosk.conf" <<END
[basis]
file = $(realpath "$basis")
[camera fisheye]
driver = sim
sim.source = studio
sim.view = fisheye
sim.exposure = 0.16
sim.read_noise = 0.5
sim.shot_noise = 1
sim.clock = frames
sim.switch = 97
width = 240
height = 240
rate = $rate
[camera background]
driver = sim
sim.source = studio
sim.view = perspective
sim.eye = 0 -2.4 1.35
sim.target = 0 0.25 0.25
sim.angle = 58
sim.read_noise = 0.5
sim.shot_noise = 2
sim.auto_exposure = 0.2
sim.auto_step = 0.17
sim.clock = frames
sim.switch = 97
width = 320
height = 240
rate = $rate
[fisheye]
camera = fisheye
gain = 6.25
[background]
camera = background
[composite]
threads = 1
grain = yes
follow_exposure = yes
[people]
occlude = yes
[screen]
driver = null
[state]
file = state
interval = 1
END

# run NAME SECONDS OPTION...
run() {
	local name=$1 length=$2
	shift 2
	"$build/inlay" run --config "$out/kiosk.conf" --stats "$out/$name.jsonl" --frames $((length * rate)) "$@" \
		2>"$out/$name.log" &
	kiosk=$!
	while kill -0 $kiosk 2>/dev/null; do
		awk '/^VmRSS/ { print $2 }' /proc/$kiosk/status >>"$out/$name.memory" 2>/dev/null || true
		sleep 2
	done
	wait $kiosk
}
# The empty room with what was kept: frames in which people are seen where nobody is, so that the picture is
# another than with [people] off.
empty() {
	run "$1" 600 --set screen.driver=file --set "screen.device=$out/on.y4m" --set composite.grain=no
	run off 600 --set screen.driver=file --set "screen.device=$out/off.y4m" --set composite.grain=no \
		--set people.occlude=no
	ffmpeg -loglevel error -i "$out/on.y4m" -i "$out/off.y4m" -lavfi "psnr=stats_file=$out/$1.psnr" -f null - \
		</dev/null
	rm "$out/on.y4m" "$out/off.y4m"
	awk -v name="$1" '{ sub(/.*mse_avg:/, ""); n++; sum += $1; other += $1 > 0.01; if ($1 > worst) worst = $1 }
		END { printf "%-20s %d of %d frames are others, RMS over all %.3f levels, worst frame %.3f\n",
			name, other, n, sqrt(sum / n), sqrt(worst) }' "$out/$1.psnr"
}
run learning 60
cp "$out/state.place" "$out/begun.place"
empty empty-before
cp "$out/begun.place" "$out/state.place"
run hour "$seconds" --set camera.background.sim.walkers=2
awk '{ v[NR] = $1 }
	END {
		for (i = int(NR / 10) + 1; i <= NR; i++) { if (v[i] > max) max = v[i]; if (!min || v[i] < min) min = v[i] }
		printf "memory of the hour   %d to %d kB after its first tenth\n", min, max
	}' "$out/hour.memory"
empty empty-after
