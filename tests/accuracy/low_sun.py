#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a panorama with a low sun, as a PFM file: a clear sky that is brighter towards the sun and
the horizon, and a disc of 0.53 degrees that gives a white ground three times as much light as the sky.
    low_sun.py HEIGHT AZIMUTH [WIDTH] > OUT.pfm      degrees; azimuth from +X towards +Y
"""
import array
import math
import sys

SUN_RADIUS = math.radians(0.265)
SUN_SHARE = 3.0  # irradiance of the ground by the sun against that by the sky
SUBPIXELS = 8


def sky(cosine, up):
    """Radiance of the sky: cosine to the sun, sine of the height."""
    glow = 0.25 * max(cosine, 0) ** 8 + 2.0 * max(cosine, 0) ** 512
    blue = 0.35 + 0.35 * (1 - up) ** 3
    return (blue * 0.75 + glow, blue * 0.95 + 0.9 * glow, blue * 1.3 + 0.7 * glow)


def main():
    height, azimuth = (math.radians(float(text)) for text in sys.argv[1:3])
    width = int(sys.argv[3]) if len(sys.argv) > 3 else 2048
    rows = width // 2
    sun = (math.cos(height) * math.cos(azimuth), math.cos(height) * math.sin(azimuth), math.sin(height))
    step = 2 * math.pi / width
    picture, irradiance = [], 0.0
    for y in range(rows):
        polar = (y + 0.5) * math.pi / rows
        up, flat = math.cos(polar), math.sin(polar)
        row = array.array("f")
        for x in range(width):
            turn = -(x + 0.5 - width / 2) * step
            cosine = flat * (math.cos(turn) * sun[0] + math.sin(turn) * sun[1]) + up * sun[2]
            colour = sky(cosine, up) if up > 0 else (0.25, 0.22, 0.18)
            if up > 0:
                irradiance += colour[1] * up * flat * step * step
            row.extend(colour)
        picture.append(row)
    covered, horizontal = [], 0.0
    near = SUN_RADIUS + 2 * step
    for y in range(rows):
        polar = (y + 0.5) * math.pi / rows
        if abs(math.pi / 2 - polar - height) > near:
            continue
        for x in range(width):
            count = 0
            for k in range(SUBPIXELS * SUBPIXELS):
                p = (y + (k // SUBPIXELS + 0.5) / SUBPIXELS) * math.pi / rows
                turn = -(x + (k % SUBPIXELS + 0.5) / SUBPIXELS - width / 2) * step
                d = (math.sin(p) * math.cos(turn), math.sin(p) * math.sin(turn), math.cos(p))
                count += sum(a * b for a, b in zip(d, sun)) > math.cos(SUN_RADIUS)
            if count:
                share = count / SUBPIXELS**2
                covered.append((y, x, share))
                horizontal += share * math.cos(polar) * math.sin(polar) * step * step
    radiance = SUN_SHARE * irradiance / horizontal
    for y, x, share in covered:
        for c, tint in enumerate((1.0, 0.9, 0.75)):
            picture[y][3 * x + c] += share * radiance * tint
    sys.stdout.buffer.write(b"PF\n%d %d\n-1.0\n" % (width, rows))
    for row in reversed(picture):
        sys.stdout.buffer.write(row.tobytes())


main()
