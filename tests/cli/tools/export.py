# SPDX-License-Identifier: MIT
"""export.py WIDTH HEIGHT A B: how far B is shifted against A, in pixels, and how much brighter or
darker it is, in per cent of linear light; both are raw RGB. Prints "SHIFT BRIGHTNESS".

The shift is the one that explains most of the difference by A's own slopes, as least squares. The
brightness is that of 4 x 4 parts and of each channel, where anything but the background is: the largest.
"""

import sys

BACKGROUND = 0x99
LIKE_IT = 2  # levels
PARTS = 4
LEAST = 8  # pixels that a part must have to be judged


def linear(code):
    value = code / 255
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def read(path, width, height):
    with open(path, "rb") as stream:
        data = stream.read()
    if len(data) != 3 * width * height:
        sys.exit(f"{path}: {len(data)} bytes, expected {3 * width * height}")
    return data


def shift(a, b, width, height):
    xx = xy = yy = xd = yd = 0.0
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            for c in range(3):
                at = 3 * (y * width + x) + c
                gx = (a[at + 3] - a[at - 3]) / 2
                gy = (a[at + 3 * width] - a[at - 3 * width]) / 2
                d = a[at] - b[at]
                xx, xy, yy = xx + gx * gx, xy + gx * gy, yy + gy * gy
                xd, yd = xd + gx * d, yd + gy * d
    whole = xx * yy - xy * xy
    return ((xd * yy - yd * xy) / whole) ** 2 + ((yd * xx - xd * xy) / whole) ** 2


def brightness(a, b, width, height):
    sums = {}
    for y in range(height):
        for x in range(width):
            at = 3 * (y * width + x)
            if all(abs(p[at + c] - BACKGROUND) <= LIKE_IT for p in (a, b) for c in range(3)):
                continue
            for c in range(3):
                part = sums.setdefault((y * PARTS // height, x * PARTS // width, c), [0, 0.0, 0.0])
                part[0] += 1
                part[1] += linear(a[at + c])
                part[2] += linear(b[at + c])
    return max(abs(s / r - 1) for n, r, s in sums.values() if n >= LEAST)


def main():
    width, height = int(sys.argv[1]), int(sys.argv[2])
    a, b = (read(path, width, height) for path in sys.argv[3:5])
    print(f"{shift(a, b, width, height) ** 0.5:.3f} {100 * brightness(a, b, width, height):.2f}")


main()
