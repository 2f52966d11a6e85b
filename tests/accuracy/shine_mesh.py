#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a mesh that shines in shine.sh: `ball`; `pot`, a teapot of a turned body, spout and handle; or `horn`, a bent
tube that widens.
    shine_mesh.py ball|pot|horn FILE.obj
Y is up; the height is about 1.
"""
import math
import sys

vertices, faces = [], []


def add_grid(point, across, down, closed):
    """A surface of point(u, v), u round and v from 0 to 1."""
    first = len(vertices)
    for j in range(down + 1):
        for i in range(across):
            vertices.append(point(i / across, j / down))
    for j in range(down):
        for i in range(across):
            a, b = first + j * across + i, first + j * across + (i + 1) % across
            faces.append((a, b, b + across, a + across))
    if closed:
        faces.append(tuple(first + i for i in reversed(range(across))))
        faces.append(tuple(first + down * across + i for i in range(across)))


def add_turned(profile, across, down):
    def point(u, v):
        radius, height = profile(v)
        return (radius * math.cos(2 * math.pi * u), height, -radius * math.sin(2 * math.pi * u))

    add_grid(point, across, down, True)


def add_tube(path, radius, across, down):
    """A tube in the plane z = 0 around path(v), of radius(v)."""

    def point(u, v):
        (x, y), (x1, y1) = path(v), path(v + 1e-4)
        length = math.hypot(x1 - x, y1 - y)
        nx, ny = (y - y1) / length, (x1 - x) / length
        a = 2 * math.pi * u
        return (
            x + radius(v) * math.cos(a) * nx,
            y + radius(v) * math.cos(a) * ny,
            radius(v) * math.sin(a),
        )

    add_grid(point, across, down, True)


if sys.argv[1] == "ball":
    add_turned(
        lambda v: (0.5 * math.sin(math.pi * (0.001 + 0.998 * v)), 0.5 - 0.5 * math.cos(math.pi * v)), 256, 128
    )
elif sys.argv[1] == "horn":
    add_tube(
        lambda v: (0.42 * math.cos(5 * v), 0.42 * math.sin(5 * v)), lambda v: 0.06 + 0.1 * v, 64, 192
    )
else:
    add_turned(
        lambda v: (
            0.02 + 0.43 * math.sin(math.pi * (0.1 + 0.9 * v)) ** 0.7 + 0.03 * math.sin(3 * math.pi * v) ** 2,
            0.75 * v,
        ),
        256,
        128,
    )
    add_tube(lambda v: (0.3 + 0.4 * v, 0.25 + 0.4 * v * v), lambda v: 0.09 - 0.05 * v, 48, 48)
    add_tube(
        lambda v: (-0.35 - 0.28 * math.sin(math.pi * v), 0.2 + 0.36 * v), lambda v: 0.04, 32, 64
    )
with open(sys.argv[2], "w", encoding="ascii") as file:
    for v in vertices:
        file.write("v %.7f %.7f %.7f\n" % v)
    for face in faces:
        file.write("f " + " ".join(str(k + 1) for k in face) + "\n")
