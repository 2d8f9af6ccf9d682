#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run: a recorded flight in the place of a drone, and what is refused before anything is opened.

usage: run_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import csv
import json
import os
import signal
import subprocess
import time

from program import GATEFLY, ROOT, Cli, main

FLIGHT = ROOT / "tests" / "replay" / "oval_flight"
DRONE = ROOT / "tests" / "live" / "fake_drone.toml"
FAKE = os.environ.get("GATEFLY_FAKE_BETAFLIGHT", "")
# Ends when the test does; 160 x 315 as stored: the size of a Bebop's pictures, of one colour.
GREY_STREAM = "#!/bin/sh\nexec python3 -c 'import sys, time\nwhile True: sys.stdout.buffer.write(bytes(%d)); sys.stdout.flush(); time.sleep(0.033)'\n"


class Recorded(Cli):
    def shadow(self, *arguments, pace=0):
        return self.run_it("run", FLIGHT / "track.toml", "--shadow", "--laps", "1", "--camera", f"file:{FLIGHT}", "--link", f"replay:{FLIGHT}?pace={pace}",
                           *arguments)

    def test_a_flight_that_looks_on_at_a_recording_is_replayed_to_the_bit(self):
        result = self.shadow("--out", "seen", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual((told["commands"], told["detection"]["frames"], told["gates_passed"], told["stop_reason"]), (4103, 39, 1, "the end"))
        again = self.run_it("replay", "seen")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("4103 samples, 39 pictures", again.stdout)
        self.assertIn("the same estimates, to the bit", again.stdout)

    def test_its_time_limit_ends_it_and_what_was_flown_is_kept(self):
        result = self.shadow("--out", "seen", "--time-limit", "0.5", "--json", pace=1)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual(told["stop_reason"], "time limit")
        self.assertLess(told["commands"], 600)
        self.assertEqual(self.run_it("replay", "seen").returncode in (0, 1), True)
        self.assertTrue((self.folder / "seen" / "summary.json").exists())


class Refused(Cli):
    def run_refused(self, **changed):
        words = {"--camera": f"file:{FLIGHT}", "--link": f"replay:{FLIGHT}"}
        words.update({"--" + flag: value for flag, value in changed.items()})
        flags = [word for flag, value in words.items() for word in (flag, value)]
        return self.refused("run", "oval", "--shadow", *flags)

    def test_a_link_that_is_none(self):
        self.assertIn("must begin with msp:", self.run_refused(link="tcp:1"))
        self.assertIn("is not built yet", self.run_refused(link="mavlink:udp:127.0.0.1:14550"))
        self.assertIn("PORT = '0', must be in 1..65535", self.run_refused(link="msp:tcp:localhost:0"))
        self.assertIn("there is no option 'bad'", self.run_refused(link="msp:/dev/ttyS0?bad=1"))
        self.assertIn("baud = 'x'", self.run_refused(link="msp:/dev/ttyS0?baud=x"))

    def test_a_camera_that_is_none(self):
        self.assertIn("must begin with v4l2:", self.run_refused(camera="rtsp://x"))
        self.assertIn("must be v4l2:/dev/videoN", self.run_refused(camera="v4l2:0"))
        self.assertIn("needs --camera file:", self.run_refused(camera="udp-jpeg:5600"))

    def test_a_drone_without_constants(self):
        self.assertIn("--drone is required", self.run_refused(link="msp:tcp:127.0.0.1:5761"))

    def test_flying_without_a_hand_over_test(self):
        said = self.refused("run", "oval", "--camera", f"file:{FLIGHT}", "--link", f"replay:{FLIGHT}")
        self.assertIn("nobody can fly a recording", said)


class Fake:
    """The fake controller, a process of its own; words tell it what the pilot's radio does."""

    def __init__(self, folder, *flags):
        self.log = folder / "fake.csv"
        self.process = subprocess.Popen([FAKE, "--log", self.log, *flags], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline().split()[1])

    def __call__(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def rows(self, what=None):
        with self.log.open(encoding="utf-8") as rows:
            return [row for row in csv.DictReader(rows) if None not in row.values() and what in (None, row["what"])]

    def end(self):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait()


class WithDrone(Cli):
    """A drone that behaves like one: tests/support/fake_betaflight.hpp, and a camera that shows nothing but grey."""

    def setUp(self):
        super().setUp()
        self.fake = Fake(self.folder)
        self.addCleanup(lambda: self.fake.end())
        programs = self.folder / "bin"
        programs.mkdir()
        script = programs / "gst-launch-1.0"
        script.write_text(GREY_STREAM % (2 * 160 * 315), encoding="utf-8")
        script.chmod(0o700)
        self.environment = {"PATH": f"{programs}:{os.environ['PATH']}"}

    def words(self, *arguments, drone=DRONE):
        return ["run", "oval", "--config", "betaflight", "--camera", "gst:videotestsrc", "--link", f"msp:tcp:127.0.0.1:{self.fake.port}",
                "--drone", str(drone), *map(str, arguments)]

    def start(self, *arguments, **more):
        """The program in the background."""
        process = subprocess.Popen([GATEFLY, *self.words(*arguments, **more)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=dict(os.environ, XDG_CACHE_HOME=str(self.cache), **self.environment))
        self.addCleanup(lambda: process.poll() is None and process.kill())
        return process


class Shadow(WithDrone):
    def test_it_listens_and_sends_nothing_but_questions(self):
        result = self.run_it(*self.words("--shadow", "--carried", "--out", "seen", "--time-limit", "3", "--json"), **self.environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual(told["stop_reason"], "time limit")
        self.assertGreater(told["link"]["samples"], 3 * 40)
        self.assertGreater(told["detection"]["frames"], 3 * 20)
        self.assertEqual(self.fake.rows("frame"), [])
        again = self.run_it("replay", "seen")
        self.assertIn(f"{told['commands']} samples", again.stdout)
        self.assertIn("the same estimates, to the bit", again.stdout)

    def test_it_ends_when_told_and_keeps_what_was_seen(self):
        process = self.start("--shadow", "--out", "seen", "--json")
        time.sleep(1.5)
        process.send_signal(signal.SIGTERM)
        out, _ = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 143)
        self.assertEqual(json.loads(out)["stop_reason"], "told to end")
        self.assertTrue((self.folder / "seen" / "summary.json").exists())

    def test_a_link_that_is_cut_ends_it_with_1(self):
        process = self.start("--shadow", "--json")
        time.sleep(1.0)
        self.fake("cut")
        out, _ = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 1)
        self.assertIn("the connection is gone", json.loads(out)["stop_reason"])

    def test_another_drone_is_refused(self):
        other = self.file("other.toml", DRONE.read_text(encoding="utf-8").replace("super_rate = [45", "super_rate = [75"))
        said = self.refused(*self.words("--shadow", drone=other), **self.environment)
        self.assertIn("is not the drone of", said)
        self.assertIn("super_rate is 45, in the file 75", said)

    def test_a_file_with_an_unknown_key_is_refused(self):
        other = self.file("other.toml", DRONE.read_text(encoding="utf-8") + "cells = 6\n")
        self.assertIn("battery.cells", self.refused(*self.words("--shadow", drone=other), **self.environment))


if __name__ == "__main__":
    main()
