#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions of each step of the pilot over a recorded flight, on this processor or an ARM: the same at any load.

usage: count_steps.py x86_64|armv7|aarch64 TAPE TRACK [CONFIG | section.key=value]...

TAPE is what build/release/tests/pack_flight makes of a flight's folder; `all`, `checker:N`, `noise`, `stripes:N` after it with a
comma put such a picture in the place of each of its own: TAPE,checker:8. Counted by qemu's user mode with tools/qemu_count.c as its
plugin, for x86-64, too; programs of build/PRESET (fly_tape). Prints mean, p99 and worst of the steps that look at a picture and of those
that do not, in flight (after the rest on the ground)."""
import os
import pathlib
import platform
import random
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TICK = struct.Struct("<Qq14d")
# qemu's program, the number of getppid there, the build's folder, where that processor's libraries are.
PROCESSORS = {"x86_64": ("qemu-x86_64", 110, "release", "/"), "armv7": ("qemu-arm", 64, "armv7", "/usr/arm-linux-gnueabihf"),
              "aarch64": ("qemu-aarch64", 173, "aarch64", "/usr/aarch64-linux-gnu")}
ORANGE, GREY = (30, 150, 240), (128, 128, 128)  # Cb, Y, Cr


def pattern(name, width, height):
    """A drawn UYVY picture that makes a detector work: the gate's colour, or edges of it everywhere."""
    kind, _, size = name.partition(":")
    size = int(size or 8)
    draw = random.Random(1)
    gate = {"all": lambda u, v: True, "checker": lambda u, v: (u // size + v // size) % 2 == 0, "stripes": lambda u, v: u // size % 2 == 0,
            "noise": lambda u, v: draw.random() < 0.5}[kind]
    picture = bytearray()
    for v in range(height):
        for u in range(0, width, 2):
            left, right = (ORANGE if gate(x, v) else GREY for x in (u, u + 1))
            picture += bytes((left[0], left[1], left[2], right[1]))
    return bytes(picture)


def read_tape(name, folder):
    """A tape with its pictures, or with others in their place: (path, [does tick i bring a picture])."""
    path, _, drawn = name.partition(",")
    content = pathlib.Path(path).read_bytes()
    ticks, pictures, width, height = struct.unpack_from("<4I", content, 8)
    looks = [TICK.unpack_from(content, 24 + i * TICK.size)[1] >= 0 for i in range(ticks)]
    if drawn:
        path = folder / "drawn.tape"
        path.write_bytes(content[:24 + ticks * TICK.size] + pictures * pattern(drawn, width, height))
    return path, looks


def counted(processor, tape, setup, folder):
    """Instructions of every step."""
    qemu, call, preset, libraries = PROCESSORS[processor]
    plugin, out = folder / "libqemu_count.so", folder / "counts"
    subprocess.run(["gcc", "-O2", "-fPIC", "-shared", "-o", plugin, ROOT / "tools/qemu_count.c"], check=True)
    run = subprocess.run([qemu, "-L", libraries, "-plugin", f"{plugin},out={out},call={call}", ROOT / "build" / preset / "tests/fly_tape", tape, "-", *setup],
                         env={**os.environ, "FLY_TAPE_MARKS": "1"}, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(run.stdout + run.stderr)
    marks = struct.unpack(f"<{out.stat().st_size // 8}Q", out.read_bytes())
    return marks[1::2]  # each second one is from before a step to after it


def line(name, counts):
    counts = sorted(counts)
    p99 = counts[min(len(counts) - 1, int(0.99 * len(counts)))]
    return f"{name:8} {len(counts):6} steps  mean {sum(counts) / len(counts):11,.0f}  p99 {p99:11,}  worst {counts[-1]:11,}"


def main(arguments):
    if len(arguments) < 3 or arguments[0] not in PROCESSORS:
        sys.exit(__doc__)
    if shutil.which(PROCESSORS[arguments[0]][0]) is None:
        sys.exit(f"count_steps: no {PROCESSORS[arguments[0]][0]} (Debian's qemu-user)")
    if arguments[0] == "x86_64" and platform.machine() != "x86_64":
        sys.exit("count_steps: build/release is not of an x86-64")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        tape, looks = read_tape(arguments[1], folder)
        steps = counted(arguments[0], tape, arguments[2:], folder)
    flown = range(1024, len(steps))  # the rest on the ground is 768 of 512 Hz
    print(line("picture", [steps[i] for i in flown if looks[i]]))
    print(line("imu", [steps[i] for i in flown if not looks[i]]))


if __name__ == "__main__":
    main(sys.argv[1:])
