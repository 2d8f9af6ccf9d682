# SPDX-License-Identifier: Apache-2.0
"""Inputs for the program in tests: pictures of a gate and of a board, tables of detections and labels, a course."""
import math

GATE = "[[gates]]\nposition_m = [3.0, 0.0, -1.5]\n"

CONTRACT = "image,gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v,fitness,method"  # what other programs write, too
HEADER = CONTRACT + ",tl_fitness,tr_fitness,br_fitness,bl_fitness"
LABELS = "image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\na.jpg,1,0,0,40,0,40,40,0,40\nb.jpg,0,,,,,,,,\n"
FOUND = CONTRACT + "\na.jpg,0,1,0,41,0,41,40,1,40,0.9,snake\nb.jpg,0,0,0,40,0,40,40,0,40,0.8,snake\n"


def picture(gate=True, width=160, height=120, up=0):
    """A PPM of an orange square frame on grey, so many rows above the middle."""
    def frame(u, v):
        out = max(abs(u - 80), abs(v + up - 60))
        return gate and 36 <= out <= 40
    pixels = b"".join(b"\xe0\x60\x20" if frame(u, v) else b"\x70\x70\x70" for v in range(height) for u in range(width))
    return b"P6\n%d %d\n255\n" % (width, height) + pixels


def album(folder, color, count=12):
    """Pictures of a gate of that colour, here and there; where they are, and a table of their labels."""
    pictures = folder / "album"
    pictures.mkdir()
    rows = ["image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v"]
    for i in range(count):
        u0, v0, half = 60 + 4 * i, 50 + 2 * (i % 5), 30 + i % 4

        def pixel(u, v):
            out = max(abs(u - u0), abs(v - v0))
            return color if half - 3 <= out <= half else bytes((100 + (u * 7 + v * 13 + i) % 24,) * 3)
        (pictures / f"p{i}.ppm").write_bytes(b"P6\n160 120\n255\n" + b"".join(pixel(u, v) for v in range(120) for u in range(160)))
        left, right, top, bottom = u0 - half, u0 + half, v0 - half, v0 + half
        rows.append(f"p{i}.ppm,1,{left},{top},{right},{top},{right},{bottom},{left},{bottom}")
    labels = folder / "labels.csv"
    labels.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return pictures, labels


def bent_album(folder, color, degrees, count=10):
    """Pictures of gates, 0.95 m wide and a metre away here and there, through an equidistant lens that shows so many degrees across."""
    pictures, width, height = folder / "bent", 240, 180
    pictures.mkdir()
    focal = width / math.radians(degrees)

    def seen(u, v):  # where a pixel looks to, a metre ahead
        x, y = u - 0.5 * (width - 1), v - 0.5 * (height - 1)
        off = math.hypot(x, y) or 1e-9
        away = math.tan(off / focal) / off if off / focal < 1.5 else 1e9
        return x * away, y * away
    rays = [seen(u, v) for v in range(height) for u in range(width)]
    for i in range(count):
        left, down, half = 0.5 * math.cos(2.4 * i), 0.3 * math.sin(2.4 * i), 0.45 + 0.01 * i
        data = bytearray()
        for k, (x, y) in enumerate(rays):
            out = max(abs(x - left), abs(y - down))
            data += color if half - 0.05 <= out <= half else bytes((100 + (k * 7 + k // width * 13 + i) % 24,) * 3)
        (pictures / f"p{i}.ppm").write_bytes(b"P6\n%d %d\n255\n" % (width, height) + bytes(data))
    return pictures


def tilted(tilt, turn):
    """The rotation by `tilt` about the direction `turn` in the picture, row by row."""
    c, s = math.cos(tilt), math.sin(tilt)
    x, y = math.cos(turn), math.sin(turn)
    return [[c + x * x * (1 - c), x * y * (1 - c), y * s],
            [x * y * (1 - c), c + y * y * (1 - c), -x * s],
            [-y * s, x * s, c]]


def board_picture(tilt, turn, width=240, height=180, focal=200.0):
    """A PPM of a board of 7x5 inner corners, 30 mm squares, tilted about the direction `turn`, 0.26 m away."""
    rotation = tilted(tilt, turn)
    normal = [row[2] for row in rotation]
    origin = [sum(row[k] * (-0.09, -0.06)[k] for k in range(2)) + (0, 0, 0.26)[i] for i, row in enumerate(rotation)]
    ahead = sum(n * o for n, o in zip(normal, origin))
    pixels = bytearray()
    for v in range(height):
        for u in range(width):
            ray = ((u - 118) / focal, (v - 91) / focal, 1.0)
            distance = ahead / sum(n * r for n, r in zip(normal, ray))
            p = [distance * r - o for r, o in zip(ray, origin)]
            i, j = (sum(rotation[k][column] * p[k] for k in range(3)) / 0.03 for column in range(2))
            grey = 230.0
            if -1 < i < 7 and -1 < j < 5:
                edge = 0.03 * focal / distance * math.sin(math.pi * i) * math.sin(math.pi * j) / math.pi
                grey = 128 + 100 * max(-1.0, min(1.0, 2 * edge))
            pixels += bytes((round(grey),)) * 3
    return b"P6\n%d %d\n255\n" % (width, height) + bytes(pixels)
