# SPDX-License-Identifier: MIT
"""The geometry of registration.sh: writes its scenes, and says how far two cameras are apart.

Tsai's camera is written down here once more, from the thesis (2.1 to 2.7) and Tsai (1987, 5a, 5b)
alone, so that the programs are not held against their own arithmetic.

    registration.py scenes DIRECTION KAPPA1 FOLDER    cameras, scenes, a board, lights, a kiosk
    registration.py apart CAMERA CAMERA               RMS and largest distance in px over the board
    registration.py moved REPORT REPORT               the same between points seen in their first views
    registration.py marked SCREEN REPORT              whether a picture has marks around the points of
                                                      the last view; exit 1: not around each
"""
import json
import math
import struct
import sys
import zlib

WIDTH, HEIGHT = 640, 480
COLUMNS, ROWS, STEP = 9, 6, 0.025  # inner corners; m
TARGET = (0.1, -0.0625, 0)
# One that looks down as well: views that are all as oblique do not tell f from aspect.
EYES = ((0.12, -0.45, 0.40), (-0.25, -0.3, 0.42), (0.45, -0.25, 0.40), (0.1, 0.03, 0.55))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


# ---- scenes ----


def write_camera(path, eye, direction, kappa1):
    view = unit([t - e for t, e in zip(TARGET, eye)])
    right = unit(cross(view, (0, 0, 1)))
    rows = [right, cross(view, right), view]
    with open(path, "w", encoding="utf-8") as file:
        file.write("[camera]\nwidth = %d\nheight = %d\n" % (WIDTH, HEIGHT))
        file.write("rotation = %s\n" % " ".join("%.17g" % x for row in rows for x in row))
        file.write("translation = %s\n" % " ".join("%.17g" % -dot(row, eye) for row in rows))
        file.write("focal = 8\nkappa1 = %s\ndistortion = %s\n" % (kappa1, direction))
        file.write("centre = 326.4 233.3\npixel = 0.0104 0.01\naspect = 1.04\n")


def write_board(folder):
    """Squares that lie on the ground, the first inner corner at the origin, paper around them."""
    with open(folder + "/board.mtl", "w", encoding="utf-8") as file:
        file.write("newmtl ink\nKd 0.03 0.03 0.03\nnewmtl paper\nKd 0.85 0.85 0.85\n")
    with open(folder + "/board.obj", "w", encoding="utf-8") as file:
        file.write("mtllib board.mtl\n")
        count = 0
        for row in range(-2, ROWS + 1):
            for column in range(-2, COLUMNS + 1):
                printed = -1 <= row < ROWS and -1 <= column < COLUMNS
                ink = printed and (row + column) % 2 == 0
                file.write("usemtl %s\n" % ("ink" if ink else "paper"))
                for x, y in ((0, 1), (1, 1), (1, 0), (0, 0)):
                    file.write("v %g %g 0\n" % ((column + x) * STEP, -(row + y) * STEP))
                file.write("f %d %d %d %d\n" % tuple(range(count + 1, count + 5)))
                count += 4


def write_grey(path):
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))

    rows = (b"\0" + b"\x78" * 3 * WIDTH) * HEIGHT
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n"
                   + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_scenes(direction, kappa1, folder):
    for number, eye in enumerate(EYES, 1):
        write_camera("%s/true%d.ini" % (folder, number), eye, direction, kappa1)
        with open("%s/view%d.scene" % (folder, number), "w", encoding="utf-8") as file:
            file.write("[camera]\nfile = true%d.ini\n[dome]\nfrequency = 1\n" % number)
            file.write("[object board]\nfile = board.obj\nup = z\n")
    write_board(folder)
    write_grey(folder + "/grey.png")
    with open(folder + "/kiosk.conf", "w", encoding="utf-8") as file:
        file.write("[camera background]\ndriver = sim\nwidth = %d\nheight = %d\n" % (WIDTH, HEIGHT))
        file.write("rate = 2\nsim.source = files\nsim.file = held%d.png\nsim.clock = frames\n")
        file.write("[screen]\ndriver = file\ndevice = screen.png\n")
    with open(folder + "/lights.txt", "w", encoding="utf-8") as file:
        file.write("0.3 0.3 0.3\n" * 6)


# ---- cameras ----


def read_camera(path):
    camera = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            if "=" in line and not line.startswith(";"):
                key, value = line.split("=")
                words = value.split()
                camera[key.strip()] = words if key.strip() == "distortion" else list(map(float, words))
    return camera


def bent_radius(r, kappa1, direction):
    if direction == "distorts":
        return r * (1 + kappa1 * r * r)
    bent = r
    for _ in range(50):  # bent (1 + kappa1 bent^2) = r
        bent -= (bent * (1 + kappa1 * bent * bent) - r) / (1 + 3 * kappa1 * bent * bent)
    return bent


def project(camera, world):
    turn = camera["rotation"]
    p = [dot(turn[3 * i:3 * i + 3], world) + camera["translation"][i] for i in range(3)]
    x, y = (camera["focal"][0] * p[i] / p[2] for i in range(2))
    r = math.hypot(x, y)
    share = bent_radius(r, camera["kappa1"][0], camera["distortion"][0]) / r if r else 1
    return (camera["centre"][0] + camera["aspect"][0] * share * x / camera["pixel"][0],
            camera["centre"][1] - share * y / camera["pixel"][1])


def say(distances):
    distances = list(distances)
    print("%.4f %.4f" % (math.sqrt(sum(d * d for d in distances) / len(distances)), max(distances)))


def say_apart(one, other):
    a, b = read_camera(one), read_camera(other)
    places = [(x * STEP, -y * STEP, 0) for x in range(-1, COLUMNS + 1) for y in range(-1, ROWS + 1)]
    say(math.dist(project(a, p), project(b, p)) for p in places)


def points(report):
    with open(report + "/calibration.json", encoding="utf-8") as file:
        return json.load(file)["points"]


def first_view(report):
    return [p["seen_px"] for p in points(report) if p["view"] == 0]


def say_moved(one, other):
    a, b = first_view(one), first_view(other)
    assert len(a) == len(b) == COLUMNS * ROWS
    say(math.dist(p, q) for p, q in zip(a, b))


# ---- the screen ----


def unfiltered(kind, line, above, size):
    """One row of a PNG (its specification, 9.2)."""
    row = bytearray(line)
    for i in range(len(row)):
        left, up = row[i - size] if i >= size else 0, above[i]
        corner = above[i - size] if i >= size else 0
        nearest = min((left, up, corner), key=lambda x: abs(left + up - corner - x))
        row[i] = (row[i] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
    return row


def read_png(path):
    """Rows of 8-bit RGB."""
    with open(path, "rb") as file:
        data = file.read()
    at, body = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", chunk[:10])
            assert (bits, colour) == (8, 2)
        body += chunk if kind == b"IDAT" else b""
        at += 12 + length
    body, rows, above = zlib.decompress(body), [], bytes(3 * width)
    for y in range(height):
        line = body[y * (3 * width + 1):(y + 1) * (3 * width + 1)]
        above = unfiltered(line[0], line[1:], above, 3)
        rows.append(above)
    return rows


def say_marked(screen, report):
    rows, last = read_png(screen), points(report)[-1]["view"]

    def green(x, y):
        red, green, blue = rows[y][3 * x:3 * x + 3]
        return green > red + 60 and green > blue + 60

    for p in points(report):
        x, y = map(int, p["seen_px"])
        near = [green(i, j) for j in range(y - 9, y + 10) for i in range(x - 9, x + 10)]
        if p["view"] == last and sum(near) < 12:
            sys.exit("no mark around %.1f %.1f" % tuple(p["seen_px"]))


{"scenes": write_scenes, "apart": say_apart, "moved": say_moved,
 "marked": say_marked}[sys.argv[1]](*sys.argv[2:])
