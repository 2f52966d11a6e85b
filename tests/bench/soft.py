#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How far off the fast mode is under soft light from every side.

    BUILD=build/x tests/bench/soft.py BASIS

BASIS has an exact layer. What neighbouring lights send is alike, and little of each: what a block leaves out of
it adds up under a window or a dusk, most of all from one side. So here are 72 of them from 12 azimuths, none of
which the encoder tries: lobes of cos^8 and cos^64, 10 and 30 degrees high, in a dim room, and dusks of two
heights. White ground has radiance 1. Prints Markdown: the worst azimuth of each kind, then how many are how
far off.
"""

import json
import math
import os
import subprocess
import sys
import tempfile

AZIMUTHS = 12
LOBES = [(height_deg, power) for height_deg in (10, 30) for power in (8, 64)]
DUSKS = (0.1, 0.4)  # the sine of the height at which it is a third as bright
DIM = 0.2
BOUNDS = (1.5, 2, 3, 255)

build = os.environ["BUILD"]


def run(*words):
    return subprocess.run([build + "/" + words[0], *words[1:]], check=True, stdout=subprocess.PIPE).stdout


def direction(height_deg, azimuth):
    height, turn = math.radians(height_deg), 2 * math.pi * (azimuth + 0.5) / AZIMUTHS
    return math.cos(height) * math.cos(turn), math.cos(height) * math.sin(turn), math.sin(height)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def lobe(height_deg, power, azimuth):
    """Bluish."""
    to = direction(height_deg, azimuth)
    return lambda v, c: DIM + power / 2 * max(dot(v, to), 0) ** power * (1 + 0.3 * (c - 1))


def dusk(thick, azimuth):
    """Reddish along the horizon, bluish above."""
    to = direction(0, azimuth)
    return lambda v, c: (
        DIM / 2 * (1 + 0.25 * (c - 1)) + math.exp(-max(v[2], 0) / thick) * ((1 + dot(v, to)) / 2) ** 3 * (1 - 0.3 * (c - 1))
    )


def save(path, lights, radiance):
    values = [[radiance(light["direction"], c) for c in range(3)] for light in lights]
    level = sum(light["projected_sr"] * v[1] for light, v in zip(lights, values)) / math.pi
    with open(path, "w") as file:
        file.writelines("%.6g %.6g %.6g\n" % tuple(x / level for x in v) for v in values)


def main():
    basis = sys.argv[1]
    info = json.loads(run("inlay-bake", "info", "--json", basis))
    dome = ["--frequency", str(info["dome_frequency"])]
    lights = json.loads(run("inlay-bake", "dome", *dome, "--json"))["lights"]
    kinds = {f"cos^{power}, {height} degrees high": [lobe(height, power, k) for k in range(AZIMUTHS)] for height, power in LOBES}
    kinds |= {f"dusk, {thick:.0%} thick": [dusk(thick, k) for k in range(AZIMUTHS)] for thick in DUSKS}
    every = []
    print("| light | PSNR dB | max, levels | read MB |\n|---|---|---|---|")
    for kind, skies in kinds.items():
        with tempfile.TemporaryDirectory() as work:
            given = []
            for k, sky in enumerate(skies):
                save(f"{work}/{kind} ({k})", lights, sky)
                given += ["--lights", f"{work}/{kind} ({k})"]
            timed = ["--thesis", "no", "--threads", "1", "--kernel", "auto", "--repeat", "1"]
            rows = json.loads(run("inlay", "bench", "--basis", basis, *timed, *given, "--json"))["rows"]
        fast = [row for row in rows if row["what"] == "fast"]
        every += [row["max"] for row in fast]
        worst = min(row["psnr_db"] for row in fast), max(row["max"] for row in fast), max(row["basis_mb"] for row in fast)
        print("| %s | %.1f | %.1f | %.1f |" % (kind, *worst), flush=True)
    print()
    for low, high in zip((0,) + BOUNDS, BOUNDS):
        print(f"{sum(low <= x < high for x in every)} of {len(every)}: {low} to {high} levels")


main()
