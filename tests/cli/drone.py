# SPDX-License-Identifier: Apache-2.0
"""gatefly run with a drone that behaves like one: tests/support/fake_betaflight.hpp, and a camera that shows nothing but grey."""
import contextlib
import csv
import functools
import os
import pathlib
import subprocess
import time

from program import GATEFLY, ROOT, Cli
from simulated import free_ports  # noqa: F401

DRONE = ROOT / "tests" / "live" / "fake_drone.toml"
FAKE = os.environ.get("GATEFLY_FAKE_BETAFLIGHT", "")
PERIOD = 0.025  # s, of stick frames
FAR_GATE = ROOT / "tests" / "live" / "far_gate.toml"  # the pictures of these tests are grey: with a gate near by it would not fly on
# Packets of GStreamer's data protocol on file 3, 160 x 315 as stored: the size of a Bebop's pictures. Stands still once there is a file called frozen.
GREY_STREAM = """#!/usr/bin/env python3
import os, struct, time
out = os.fdopen(3, "wb")
grey = bytes([128] * (2 * 160 * 315))
while True:
    if not os.path.exists("frozen"):
        out.write(struct.pack(">BBBBHIQ44x", 1, 0, 0, 0, 1, len(grey), time.monotonic_ns()) + grey)
        out.flush()
    time.sleep(0.033)
"""


def end_of(process):
    if process.poll() is None:
        process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream:
            stream.close()


def signed(test, content):
    """A drone.toml of that content whose hand-over test has passed, as far as it says."""
    plain = test.file("plain.toml", content)
    mark = subprocess.run([FAKE, "--sign", plain, program_that_flies()], capture_output=True, text=True, check=True).stdout.strip()
    return test.file("signed.toml", f'{content}\n[hand_over_test]\npassed = "{mark}"\n')


def goes_first(process=0):
    """The rig ahead of the program's threads, where the system allows it: a set point that comes late is then the program's."""
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(process, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(50))


class Fake:
    """The fake controller, a process of its own; words tell it what the pilot's radio does."""

    def __init__(self, folder, *flags, program=FAKE):
        self.log = folder / "fake.csv"
        self.process = subprocess.Popen([program, "--log", self.log, *flags], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        goes_first(self.process.pid)
        self.port = int(self.process.stdout.readline().split()[1])

    def __call__(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def rows(self, what=None):
        with self.log.open(encoding="utf-8") as rows:
            return [row for row in csv.DictReader(rows) if None not in row.values() and what in (None, row["what"])]

    def end(self):
        if not self.process.stdin.closed:
            self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait()


class WithDrone(Cli):
    """A drone that behaves like one: tests/support/fake_betaflight.hpp, and a camera that shows nothing but grey."""

    FAKE = FAKE
    CONFIG = "betaflight"

    def link(self):
        return f"msp:tcp:127.0.0.1:{self.fake.port}"

    def setUp(self):
        super().setUp()
        self.fake = Fake(self.folder, program=self.FAKE)
        self.addCleanup(lambda: self.fake.end())
        programs = self.folder / "bin"
        programs.mkdir()
        script = programs / "gst-launch-1.0"
        script.write_text(GREY_STREAM, encoding="utf-8")
        script.chmod(0o700)
        self.environment = {"PATH": f"{programs}:{os.environ['PATH']}"}

    def words(self, *arguments, drone=DRONE):
        return ["run", FAR_GATE, "--config", self.CONFIG, "--camera", "gst:videotestsrc", "--link", self.link(), "--drone", str(drone), *map(str, arguments)]

    def start(self, *arguments, **more):
        """The program in the background."""
        process = subprocess.Popen([GATEFLY, *self.words(*arguments, **more)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=dict(os.environ, XDG_CACHE_HOME=str(self.cache), **self.environment))
        self.addCleanup(end_of, process)
        return process


@functools.cache
def program_that_flies():
    """The program behind `gatefly run`: the laboratory's, where there is one."""
    sibling = pathlib.Path(GATEFLY).with_name("gatefly-lab")
    return sibling if sibling.exists() else pathlib.Path(GATEFLY)


class Handed(WithDrone):
    """A drone whose hand-over test has passed, as far as its file says."""

    def signed(self, content=None):
        return signed(self, content or DRONE.read_text(encoding="utf-8"))

    def until(self, what, seconds=10.0):
        end = time.monotonic() + seconds
        while not what():
            self.assertLess(time.monotonic(), end, "it takes too long")
            time.sleep(0.02)

    def streamed(self, *arguments):
        """The program, once it has sent more neutral frames than it needs, and rested."""
        process = self.start(*arguments, drone=self.signed())
        self.until(lambda: process.poll() is not None or len(self.fake.rows("frame")) > 65)
        self.assertIsNone(process.poll(), process.stderr.read() if process.poll() is not None else "")
        return process

    def flying(self, *arguments, seconds=2.6):
        """The program, once it has flown for so long."""
        process = self.streamed(*arguments)
        self.fake("arm")
        time.sleep(0.2)
        self.fake("override on")
        time.sleep(seconds)
        self.assertGreater(self.height(self.fake.rows("state")[-1]), 0.5, "it has not taken off")
        return process

    @staticmethod
    def height(row):
        return -float(row["z_m"])

    def down(self, seconds=6.0):
        """Waits until it is on the floor since the mark; what the drone did from the mark on."""
        def since():
            rows = self.fake.rows()
            first = next((i for i, row in enumerate(rows) if row["what"] == "mark"), len(rows))
            return rows[first:]
        self.until(lambda: any(row["what"] == "touch" for row in since()), seconds)
        rows = since()
        return rows[:1 + next(i for i, row in enumerate(rows) if row["what"] == "touch")]

    def longest_gap(self):
        times = [float(row["t_s"]) for row in self.fake.rows("frame")]
        return max(later - earlier for earlier, later in zip(times, times[1:]))

    def assert_brought_down(self, rows, distance=2.0):
        """No climb, no further than that [m], within 3 s, not fast."""
        begin, end = rows[0], rows[-1]
        self.assertLess(max(map(self.height, rows)), self.height(begin) + 0.10)  # it may still rise a little at the mark
        self.assertLess(float(end["t_s"]) - float(begin["t_s"]), 3.0)
        self.assertLess(sum((float(end[axis]) - float(begin[axis])) ** 2 for axis in ("x_m", "y_m")) ** 0.5, distance)
        self.assertLess(max(float(row["vz_mps"]) for row in rows), 2.5)


class Beside(Cli):
    """Programs that run beside each other."""

    def start(self, *words, **more):
        process = subprocess.Popen([str(word) for word in words], cwd=self.folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=dict(os.environ, XDG_CACHE_HOME=str(self.cache), GATEFLY_SOURCE_DIR=str(ROOT)), **more)
        self.addCleanup(end_of, process)
        return process
