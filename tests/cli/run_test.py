#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run: a recorded flight in the place of a drone, and what is refused before anything is opened.

usage: run_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import resource
import signal
import time

from drone import DRONE, Handed, WithDrone
from program import ROOT, Cli, main

FLIGHT = ROOT / "tests" / "replay" / "oval_flight"


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
        self.assertIn("PORT = '0', must be in 1..65535", self.run_refused(link="betaflight-sitl:0"))
        self.assertIn("--drone is required", self.run_refused(link="betaflight-sitl:"))
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


class Shadow(WithDrone):
    def test_it_listens_and_sends_nothing_but_questions(self):
        result = self.run_it(*self.words("--shadow", "--carried", "--out", "seen", "--time-limit", "2", "--json"), **self.environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual(told["stop_reason"], "time limit")
        self.assertGreater(told["link"]["samples"], 20)  # of 100; of pictures 60: a busy machine has fewer
        self.assertGreater(told["detection"]["frames"], 10)
        self.assertEqual(self.fake.rows("frame"), [])
        again = self.run_it("replay", "seen")
        self.assertIn(f"{told['commands']} samples", again.stdout)
        self.assertIn("the same estimates, to the bit", again.stdout)

    def test_it_ends_when_told_and_keeps_what_was_seen(self):
        process = self.start("--shadow", "--out", "seen", "--json")
        time.sleep(1.0)
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

    def test_a_disk_that_is_full_ends_the_recording_but_not_the_run(self):
        def little_disk():
            resource.setrlimit(resource.RLIMIT_FSIZE, (8_000, 8_000))
        result = self.run_it(*self.words("--shadow", "--carried", "--out", "seen", "--time-limit", "1.5", "--json"), preexec_fn=little_disk, **self.environment)
        told = json.loads(result.stdout)
        self.assertEqual((result.returncode, told["stop_reason"]), (1, "time limit"), result.stderr)
        self.assertGreater(told["commands"], 200)
        self.assertIn("not recorded to the end", result.stderr)
        self.assertFalse((self.folder / "seen").exists())

    def test_another_drone_is_refused(self):
        other = self.file("other.toml", DRONE.read_text(encoding="utf-8").replace("super_rate = [45", "super_rate = [75"))
        said = self.refused(*self.words("--shadow", drone=other), **self.environment)
        self.assertIn("is not the drone of", said)
        self.assertIn("super_rate is 45, in the file 75", said)

    def test_a_file_with_an_unknown_key_is_refused(self):
        other = self.file("other.toml", DRONE.read_text(encoding="utf-8") + "cells = 6\n")
        self.assertIn("battery.cells", self.refused(*self.words("--shadow", drone=other), **self.environment))


class Refusals(Handed):
    """Cases in which nobody must fly: nothing is sent."""

    def refused_to_fly(self, drone=None):
        said = self.refused(*self.words(drone=drone or self.signed()), **self.environment)
        self.assertEqual(self.fake.rows("frame"), [])
        return said

    def test_without_a_hand_over_test(self):
        self.assertIn("the hand-over test of this drone and this program is missing or out of date", self.refused_to_fly(DRONE))

    def test_with_the_hand_over_test_of_other_constants(self):
        other = self.file("other.toml", self.signed().read_text(encoding="utf-8").replace("hover_stick_us = 1425", "hover_stick_us = 1430"))
        self.assertIn("missing or out of date", self.refused_to_fly(other))

    def test_armed_or_with_the_override_on_or_with_another_client(self):
        self.fake("arm")
        self.assertIn("the drone is armed", self.refused_to_fly())
        self.fake("disarm")
        self.fake("override on")
        self.assertIn("the override is on", self.refused_to_fly())
        self.fake("override off")
        self.fake("strange")
        self.assertIn("another program talks to the controller", self.refused_to_fly())

    def test_a_course_that_cannot_be_flown(self):
        gates = "".join(f"[[gates]]\nposition_m = [{x}, 0.0, -1.5]\nheading_deg = {90 * i}\n" for i, x in enumerate((3.0, 3.1)))
        wrong = self.file("wrong.toml", f"name = 'wrong'\n{gates}")
        words = self.words(drone=self.signed())
        words[1] = str(wrong)
        self.assertIn("cannot be flown", self.refused(*words, **self.environment))


if __name__ == "__main__":
    main(at_once=4)
