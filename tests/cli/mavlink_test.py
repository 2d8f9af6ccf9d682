#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run and bench-drone over MAVLink, with an ArduCopter that behaves like one (tests/support/fake_arducopter.hpp) and a camera that
shows nothing but grey. In real time: a minute.

usage: mavlink_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import signal
import subprocess
import time
import tomllib

from drone import PERIOD, Handed, signed
from program import GATEFLY, ROOT, main

FAKE_ARDU = os.environ.get("GATEFLY_FAKE_ARDUCOPTER", "")
ARDU = ROOT / "tests" / "live" / "fake_arducopter.toml"


class WithArdu(Handed):
    FAKE = FAKE_ARDU
    CONFIG = "arducopter"

    def link(self):
        return f"mavlink:tcp:127.0.0.1:{self.fake.port}"

    def signed(self, content=None):
        return signed(self, content or ARDU.read_text(encoding="utf-8"))


class Flown(WithArdu):
    def assert_over_when_disarmed(self, process, code, reason):
        self.fake("disarm")
        out, _ = process.communicate(timeout=10)
        self.assertEqual(process.returncode, code)
        self.assertIn(reason, json.loads(out)["stop_reason"])

    def test_it_takes_off_and_comes_down_when_it_is_told(self):
        process = self.flying("--json")
        self.fake("mark")
        process.send_signal(signal.SIGTERM)
        self.assert_brought_down(self.down())
        self.assertIsNone(process.poll(), "it has not waited for the radio")
        self.assert_over_when_disarmed(process, 143, "told to end")
        self.assertLess(self.longest_gap(), 3.0 * PERIOD)

    def test_killed_the_second_process_brings_it_down(self):
        process = self.flying()
        self.fake("mark")
        process.kill()
        self.assert_brought_down(self.down())
        self.assertLess(self.longest_gap(), 3.0 * PERIOD)
        self.fake("disarm")
        time.sleep(0.4)
        frames = len(self.fake.rows("frame"))
        time.sleep(0.2)
        self.assertEqual(len(self.fake.rows("frame")), frames, "it still sends")

    def test_the_camera_stands_still(self):
        process = self.flying("--json")
        self.fake("mark")
        (self.folder / "frozen").touch()
        self.assert_brought_down(self.down())
        self.assert_over_when_disarmed(process, 1, "no pictures from the camera")

    def test_another_mode_takes_it_back_at_once(self):
        process = self.flying("--json")
        self.fake("override off")
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "it waits for the radio")
        process.terminate()
        self.fake("disarm")
        process.communicate(timeout=10)

    def test_it_has_neither_armed_nor_changed_a_mode_nor_a_parameter(self):
        process = self.flying("--json")
        self.fake("mark")
        process.terminate()
        self.down()
        self.fake("disarm")
        process.communicate(timeout=10)
        self.fake.process.stdin.close()
        self.assertEqual(self.fake.process.wait(timeout=5), 0, "commands that change something")


class Refused(WithArdu):
    def test_without_a_hand_over_test_it_looks_on_and_does_not_fly(self):
        said = self.refused(*self.words(drone=ARDU), **self.environment)
        self.assertIn("the hand-over test of this drone and this program is missing", said)
        result = self.run_it(*self.words("--shadow", "--carried", "--time-limit", "2", "--json", drone=ARDU), **self.environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(json.loads(result.stdout)["link"]["samples"], 40)
        self.assertEqual(self.fake.rows("frame"), [])

    def test_what_it_must_not_be(self):
        for word, line in (("arm", "the drone is armed"), ("parameter GUID_OPTIONS 0", "GUID_OPTIONS"), ("other", "another program talks to the controller")):
            with self.subTest(word=word):
                self.fake(word)
                self.assertIn(line, self.refused(*self.words(drone=self.signed()), **self.environment))
            self.doCleanups()
            self.setUp()


class Bench(WithArdu):
    def flags(self, *more):
        return ["bench-drone", "--propellers-off", "--link", self.link(), "--name", "fake", "--exponent", "1.0", "--least-v", "19.8", *more]

    def test_a_healthy_drone_gives_the_file_that_run_takes(self):
        with subprocess.Popen([GATEFLY, *self.flags()], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(6.5)
            for axis in range(3):
                self.fake(f"turn {axis}")
                time.sleep(2.1)
            out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, out + err)
        self.assertNotIn("WRONG", out)
        self.assertEqual(tomllib.loads((self.folder / "drone.toml").read_text(encoding="utf-8")), tomllib.loads(ARDU.read_text(encoding="utf-8")))

    def wrong(self, fault, line):
        self.fake(fault)
        result = self.run_it(*self.flags("--turn-s", "1"))
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        found = [each for each in result.stdout.splitlines() if each.startswith("WRONG")]
        self.assertIn(line, found[0])
        self.assertFalse((self.folder / "drone.toml").exists())

    def test_a_frozen_imu(self):
        self.wrong("freeze imu", "frozen")

    def test_no_accelerometer(self):
        self.wrong("no accelerometer", "there is no accelerometer that works")

    def test_a_timeout_that_is_too_long(self):
        self.wrong("parameter GUID_TIMEOUT 3", "GUID_TIMEOUT = 1")


if __name__ == "__main__":
    main()
