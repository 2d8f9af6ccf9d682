#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly bench-drone with a drone that behaves like one, healthy and with each fault.

usage: bench_drone_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import subprocess
import time
import tomllib

from drone import DRONE, WithDrone
from program import GATEFLY, main


class Bench(WithDrone):
    def flags(self, *more):
        return ["bench-drone", "--propellers-off", "--link", f"msp:tcp:127.0.0.1:{self.fake.port}", "--name", "fake", "--hover-stick-us", "1425", "--exponent", "1.6",
                "--least-v", "19.8", *more]

    def turned(self, *more):
        """The program, while somebody turns the drone about each axis."""
        with subprocess.Popen([GATEFLY, *self.flags(*more)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(3.4)
            for axis in range(3):
                self.fake(f"turn {axis}")
                time.sleep(2.1)
            out, err = process.communicate(timeout=60)
        return process.returncode, out, err

    def test_a_healthy_drone_gives_the_file_that_run_takes(self):
        code, out, err = self.turned()
        self.assertEqual(code, 0, out + err)
        self.assertNotIn("WRONG", out)
        self.assertIn("turn it by a quarter", err)
        written = self.folder / "drone.toml"
        self.assertEqual(tomllib.loads(written.read_text(encoding="utf-8")), tomllib.loads(DRONE.read_text(encoding="utf-8")))
        result = self.run_it(*self.words("--shadow", "--time-limit", "0.5", drone=written), **self.environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("the hand-over test of this drone and this program is missing", self.refused(*self.words(drone=written), **self.environment))

    def wrong(self, fault, line):
        self.fake(fault)
        result = self.run_it(*self.flags("--turn-s", "1"))
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        found = [each for each in result.stdout.splitlines() if each.startswith("WRONG")]
        self.assertIn(line, found[0])
        self.assertEqual(len(found), 1, result.stdout)
        self.assertFalse((self.folder / "drone.toml").exists())

    def test_a_frozen_imu(self):
        self.wrong("freeze imu", "frozen")

    def test_a_saturated_imu(self):
        self.wrong("saturate", "saturated")

    def test_no_accelerometer(self):
        self.wrong("no accelerometer", "there is no accelerometer")

    def test_bus_errors(self):
        self.wrong("bus errors", "bus has errors")

    def test_an_armed_drone(self):
        self.wrong("arm", "the drone is armed")

    def test_another_client(self):
        self.wrong("strange", "another program")

    def wrong_when_turned(self, fault, *lines):
        self.fake(fault)
        code, out, _ = self.turned("--turn-s", "8")
        self.assertEqual(code, 1, out)
        found = [each for each in out.splitlines() if each.startswith("WRONG")]
        self.assertEqual(len(found), len(lines), out)
        for line, each in zip(lines, found):
            self.assertIn(line, each)

    def test_axes_that_are_swapped(self):
        self.wrong_when_turned("swap axes", "front (roll): shows what another axis does", "right (pitch): shows what another axis does")

    def test_a_pitch_that_is_inverted(self):
        self.wrong_when_turned("invert pitch", "right (pitch): has the other sign")

    def test_a_gyro_of_another_scale(self):
        self.wrong_when_turned("gyro scale 2", *(["has another scale"] * 3))

    def test_a_drone_that_nobody_turns(self):
        result = self.run_it(*self.flags("--turn-s", "1"))
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout.count("not turned far enough"), 3)

    def test_findings_as_json(self):
        self.fake("arm")
        result = self.run_it(*self.flags("--json"))
        self.assertEqual(json.loads(result.stdout), {"well": False, "findings": [{"well": False, "line": "the drone is armed"}], "file": ""})

    def test_propellers_must_be_said_to_be_off(self):
        self.assertIn("--propellers-off is missing", self.refused(*[each for each in self.flags() if each != "--propellers-off"]))


if __name__ == "__main__":
    main()
