#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions of each step of the pilot over a recorded flight, on this processor or an ARM: the same at any load.

usage: count_steps.py x86_64|armv7|aarch64 TAPE TRACK [CONFIG | section.key=value]...
       count_steps.py --budget [--renew]    of the flight in tests/replay, and of a race that it flies, against tests/c_interface/budget.csv:
                                            more than 2 % (5 % of the race) above it is exit 1; 77 where another compiler has built it, or qemu
                                            is not installed

TAPE is what build/release/tests/pack_flight makes of a flight's folder; `all`, `checker:N`, `noise`, `stripes:N` after it with a
comma put such a picture in the place of each of its own: TAPE,checker:8. Counted by qemu's user mode with tools/qemu_count.c as its
plugin, for x86-64, too; programs of build/PRESET (fly_tape). Prints mean, p99 and worst of the steps that look at a picture and of those
that do not, in flight (after the rest on the ground)."""
import csv
import os
import pathlib
import platform
import random
import re
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TICK = struct.Struct("<Qq14d")
# qemu's program, the number of getppid there, the build's folder, where that processor's libraries are.
PROCESSORS = {"x86_64": ("qemu-x86_64", 110, "release", "/"), "armv7": ("qemu-arm", 64, "armv7", "/usr/arm-linux-gnueabihf"),
              "aarch64": ("qemu-aarch64", 173, "aarch64", "/usr/aarch64-linux-gnu")}
REST = 1024  # steps on the ground to begin with, at least: 768, and what follows
BUDGET = ROOT / "tests/c_interface/budget.csv"
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
        picture = pattern(drawn, width, height)
        # Each a pair of pixels farther on: the same picture again is one of a dead camera.
        path.write_bytes(content[:24 + ticks * TICK.size] + b"".join(picture[4 * k:] + picture[:4 * k] for k in range(pictures)))
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


def compiler():
    """What build/release was compiled by, as counts depend on it."""
    cache = (ROOT / "build/release/CMakeCache.txt").read_text()
    program = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", cache, re.M)[1]
    return subprocess.run([program, "-dumpfullversion"], check=True, capture_output=True, text=True).stdout.strip()


def packed(flight, folder):
    """A flight's folder as a tape: (tape, [does tick i bring a picture], what it was flown with)."""
    setup = [str(flight / "track.toml"), str(flight / "config-0.toml")]
    subprocess.run([ROOT / "build/release/tests/pack_flight", flight, folder / "tape", folder / "outputs", "0", *setup], check=True)
    return *read_tape(str(folder / "tape"), folder), setup


def budget(renew):
    """Compares the means of today with those that are committed: of the shipped flight, whose pictures are rare and searched whole, and of a
    race that is flown for it, with pictures at 15 Hz, which are searched where a gate can be."""
    if platform.machine() != "x86_64" or shutil.which("qemu-x86_64") is None:
        print("budget: skipped, not installed: qemu-user, or no x86-64")
        return 77
    rows = list(csv.DictReader(BUDGET.open()))
    if not renew and rows[0]["compiler"] != compiler():
        print(f"budget: skipped, counted with g++ {rows[0]['compiler']}, this is {compiler()}")
        return 77
    now = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        race = [ROOT / "build/release/apps/gatefly/gatefly", "fly", "oval", "--laps", "1", "--seed", "1", "--frames", "--out", folder / "race"]
        flown = subprocess.run(race, cwd=ROOT, check=False, capture_output=True, text=True)
        if flown.returncode not in (0, 1):  # 1: not finished, and has its pictures all the same
            sys.exit(flown.stdout + flown.stderr)
        for of, flight in (("", ROOT / "tests/replay/oval_flight"), ("race ", folder / "race")):
            tape, looks, setup = packed(flight, folder)
            steps = counted("x86_64", tape, setup, folder)
            print(f"budget: {flight.name}: {len(looks)} steps, {sum(looks)} pictures")
            for name, wanted in (("picture", True), ("imu", False)):
                now[of + name] = round(statistics.mean(steps[i] for i in range(REST, len(steps)) if looks[i] == wanted))
    if renew:
        BUDGET.write_text("compiler,stage,instructions\n" + "".join(f"{compiler()},{name},{count}\n" for name, count in now.items()))
        return 0
    if {row["stage"] for row in rows} != set(now):
        sys.exit(f"budget: {BUDGET.name} has not the stages {', '.join(now)}")
    over = 0
    for row in rows:
        count, allowed = now[row["stage"]], int(row["instructions"])
        print(f"budget: {row['stage']}: {count:,} instructions a step, {100 * (count / allowed - 1):+.2f} %")
        # Rendered anew, by a processor with other vector instructions to another last bit, a race takes another course.
        over += count > (1.05 if row["stage"].startswith("race") else 1.02) * allowed
    return 1 if over else 0


def main(arguments):
    if arguments[:1] == ["--budget"] and set(arguments[1:]) <= {"--renew"}:
        sys.exit(budget("--renew" in arguments))
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
    flown = range(REST, len(steps))
    print(line("picture", [steps[i] for i in flown if looks[i]]))
    print(line("imu", [steps[i] for i in flown if not looks[i]]))


if __name__ == "__main__":
    main(sys.argv[1:])
