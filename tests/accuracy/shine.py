#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares a composite with two independent renders of the truth, so that their noise cancels.
    shine.py COMPOSITE TRUTH TRUTH [BACKGROUND]          .pfm files
Prints the PSNR in 8-bit sRGB levels, and the noise of a truth in levels. Pixels that are white in BACKGROUND do not
count: of a lamp that the camera clips, no share of the light is known.
"""
import array
import math
import sys

WHITE = 254  # levels


def read(path):
    """The levels of all channels of all pixels."""
    with open(path, "rb") as file:
        file.readline(), file.readline(), file.readline()
        values = array.array("f", file.read())
    return [255 * encode(min(max(value, 0), 1)) for value in values]


def encode(value):
    """sRGB"""
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


def main():
    composite, one, two = map(read, sys.argv[1:4])
    behind = read(sys.argv[4]) if len(sys.argv) > 4 else [0] * len(one)
    counted = [i for i in range(len(one)) if max(behind[i - i % 3 : i - i % 3 + 3]) < WHITE]
    square = sum((composite[i] - one[i]) * (composite[i] - two[i]) for i in counted) / len(counted)
    noise = sum((one[i] - two[i]) ** 2 for i in counted) / 2 / len(counted)
    print(f"{10 * math.log10(255**2 / max(square, 1e-6)):.1f} {math.sqrt(noise):.1f}")


main()
