#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run: a recorded flight in the place of a drone, and what is refused before anything is opened.

usage: run_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json

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
        self.assertIn("--shadow is missing", said)


if __name__ == "__main__":
    main()
