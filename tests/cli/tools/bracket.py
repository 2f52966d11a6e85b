# SPDX-License-Identifier: MIT
"""A bracket of exposures as a camera takes it: JPEGs whose EXIF data say time, ISO and f-number.

    bracket.py write FOLDER       writes a1.jpg ... a5.jpg, and bare.jpg, which says nothing
    bracket.py compare FILE.pfm   prints the largest error of the merged light, as a share

Each block of 8 x 8 pixels is of one grey, which JPEG keeps exactly with a quantisation of 1.
"""
import struct
import sys

ACROSS, DOWN = 16, 12
# seconds as a fraction, ISO, f-number as a fraction
SHOTS = [((1, 8), 400, (28, 10)), ((1, 15), 200, (28, 10)), ((1, 60), 200, (28, 10)),
         ((1, 125), 100, (28, 10)), ((1, 500), 100, (56, 10))]
# Huffman codes of the categories of a DC difference, as the standard's example has them
DC_LENGTHS = [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0]
DC_CODES = ["00", "010", "011", "100", "101", "110", "1110", "11110", "111110", "1111110",
            "11111110", "111111110"]


def exposure(shot):
    (over, under), iso, (f_over, f_under) = shot
    return over / under * iso / 100 / (f_over / f_under) ** 2


def light(block):
    """Light of a block: over three decades, from a dark place of the longest exposure to nearly
    white in the shortest one."""
    low, high = 0.02 / exposure(SHOTS[0]), 0.8 / exposure(SHOTS[-1])
    return low * (high / low) ** (block / (ACROSS * DOWN - 1))


def code(linear):
    """sRGB's code value."""
    linear = min(linear, 1)
    encoded = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return round(255 * encoded)


def entry(tag, kind, value):
    return struct.pack(">HHI4s", tag, kind, 1, value)


def exif(shot):
    """A TIFF header, one directory that points to another, and that with three tags."""
    time, iso, f_number = shot
    first, numbers = 8 + 2 + 12 + 4, 8 + 2 + 12 + 4 + 2 + 3 * 12 + 4
    tiff = b"MM\0*" + struct.pack(">IH", 8, 1)
    tiff += entry(0x8769, 4, struct.pack(">I", first)) + struct.pack(">IH", 0, 3)
    tiff += entry(0x829A, 5, struct.pack(">I", numbers))
    tiff += entry(0x829D, 5, struct.pack(">I", numbers + 8))
    tiff += entry(0x8827, 3, struct.pack(">HH", iso, 0)) + struct.pack(">I", 0)
    return b"Exif\0\0" + tiff + struct.pack(">IIII", *time, *f_number)


def segment(marker, data):
    return struct.pack(">BBH", 255, marker, len(data) + 2) + data


def jpeg(codes, about):
    bits, before = "", 0
    for value in codes:
        difference, before = 8 * (value - 128) - before, 8 * (value - 128)
        size = abs(difference).bit_length()
        bits += DC_CODES[size]
        if size:
            bits += format(difference if difference > 0 else difference + (1 << size) - 1,
                           "0%db" % size)
        bits += "0"  # no more coefficients
    bits += "1" * (-len(bits) % 8)
    coded = int(bits, 2).to_bytes(len(bits) // 8, "big").replace(b"\xff", b"\xff\0")
    return (b"\xff\xd8" + (segment(0xE1, about) if about else b"")
            + segment(0xDB, b"\0" + b"\1" * 64)
            + segment(0xC0, struct.pack(">BHHBBBB", 8, 8 * DOWN, 8 * ACROSS, 1, 1, 0x11, 0))
            + segment(0xC4, b"\0" + bytes(DC_LENGTHS) + bytes(range(12)))
            + segment(0xC4, b"\x10" + bytes([1] + 15 * [0]) + b"\0")
            + segment(0xDA, b"\1\1\0\0\x3f\0") + coded + b"\xff\xd9")


def write(folder):
    for k, shot in enumerate(SHOTS):
        codes = [code(light(b) * exposure(shot)) for b in range(ACROSS * DOWN)]
        with open("%s/a%d.jpg" % (folder, k + 1), "wb") as file:
            file.write(jpeg(codes, exif(shot)))
    with open("%s/bare.jpg" % folder, "wb") as file:
        file.write(jpeg(codes, b""))


def compare(path):
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        order = "<" if float(file.readline()) < 0 else ">"
        values = struct.unpack("%s%df" % (order, 3 * width * height), file.read())
    assert (width, height) == (8 * ACROSS, 8 * DOWN)
    worst = 0
    for block in range(ACROSS * DOWN):
        row = height - 1 - (8 * (block // ACROSS) + 4)  # PFM begins below
        at = 3 * (row * width + 8 * (block % ACROSS) + 4)
        for channel in range(3):
            worst = max(worst, abs(values[at + channel] / light(block) - 1))
    print("%.4f" % worst)


if sys.argv[1] == "write":
    write(sys.argv[2])
else:
    compare(sys.argv[2])
