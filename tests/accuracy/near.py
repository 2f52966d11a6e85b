#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures a lamp's shadow and light in a composite against the truth, of .pfm files.
    near.py TRUTH COMPOSITE BACKGROUND OBJECT
Prints how far the edges of the shadows are apart, pixels RMS, and by how many percent the object is too bright. OBJECT
is black but for the object.
"""
import array
import math
import sys

# A shadow's edge is where this share of the ground's light is left: half of what a lamp gives three quarters of takes.
EDGE = 1 - 0.75 / 2


def read(path):
    """Green, or grey, of each pixel: a list of rows."""
    with open(path, "rb") as file:
        kind, (width, height), _ = file.readline(), map(int, file.readline().split()), file.readline()
        values = array.array("f", file.read())
    step = 3 if kind.strip() == b"PF" else 1
    return [values[step * width * y + step // 2 : step * width * (y + 1) : step] for y in reversed(range(height))]


def edges(picture, background, masked):
    """Points at which the ratio to the background passes EDGE, between pixels that are not masked."""
    ratio = [[p / b for p, b in zip(*rows)] for rows in zip(picture, background)]
    points = []
    for y, row in enumerate(ratio):
        for x, here in enumerate(row):
            for dx, dy in (1, 0), (0, 1):
                if y + dy == len(ratio) or x + dx == len(row) or masked[y][x] or masked[y + dy][x + dx]:
                    continue
                there = ratio[y + dy][x + dx]
                if (here < EDGE) != (there < EDGE):
                    part = (EDGE - here) / (there - here)
                    points.append((x + part * dx, y + part * dy))
    return points


def main():
    truth, composite, background, alone = map(read, sys.argv[1:])
    masked = [[value > 0 for value in row] for row in alone]
    sums = [sum(v for rows in zip(p, masked) for v, m in zip(*rows) if m) for p in (truth, composite)]
    lines = [edges(picture, background, masked) for picture in (truth, composite)]
    squares = [min((x - u) ** 2 + (y - v) ** 2 for u, v in lines[1 - k]) for k in range(2) for x, y in lines[k]]
    print("%.2f %+.1f" % (math.sqrt(sum(squares) / len(squares)), 100 * (sums[1] / sums[0] - 1)))


main()
