#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run: every way in which a flight may end, with a drone that behaves like one. In real time: a minute.

usage: run_endings_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import signal
import subprocess
import time

from drone import PERIOD, Handed
from program import main


class Ended(Handed):
    def assert_over_when_disarmed(self, process, code, reason):
        self.fake("disarm")
        out, _ = process.communicate(timeout=10)
        self.assertEqual(process.returncode, code)
        self.assertIn(reason, json.loads(out)["stop_reason"])

    def test_told_to_end(self):
        for sent, code in ((signal.SIGTERM, 143), (signal.SIGINT, 130), (signal.SIGHUP, 129)):
            with self.subTest(signal=sent.name):
                process = self.flying("--json")
                self.fake("mark")
                process.send_signal(sent)
                self.assert_brought_down(self.down())
                self.assertIsNone(process.poll(), "it has not waited for the radio")
                self.assert_over_when_disarmed(process, code, "told to end")
                self.assertLess(self.longest_gap(), 3.0 * PERIOD)
            self.doCleanups()
            self.setUp()

    def test_what_was_flown_is_replayed_to_the_bit(self):
        process = self.flying("--json", "--out", "flown")
        self.fake("mark")
        process.terminate()
        self.down()
        self.assert_over_when_disarmed(process, 143, "told to end")
        again = self.run_it("replay", "flown")
        self.assertIn("the same estimates, to the bit", again.stdout, again.stderr)

    def test_the_camera_stands_still(self):
        process = self.flying("--json")
        self.fake("mark")
        (self.folder / "frozen").touch()
        self.assert_brought_down(self.down())
        self.assert_over_when_disarmed(process, 1, "no pictures from the camera")

    def test_the_gyro_stands_still(self):
        process = self.flying("--json")
        self.fake("mark")
        self.fake("freeze imu")
        # Nobody knows its attitude then: it is not turned, neither to brake nor level.
        self.assert_brought_down(self.down(), distance=6.0)
        self.assert_over_when_disarmed(process, 1, "no attitude from the controller")

    def test_the_battery_is_low(self):
        process = self.flying("--json")
        self.fake("mark")
        self.fake("battery 18.5")
        self.down(8.0)
        self.assert_over_when_disarmed(process, 1, "the battery is low")

    def test_no_gate_tells_the_height_for_long(self):
        process = self.flying("--json", seconds=4.0)
        self.fake("mark")
        self.down(12.0)
        self.assert_over_when_disarmed(process, 1, "no gate has told the height for too long")

    def test_its_time_is_over(self):
        process = self.flying("--json", "--time-limit", "2.5", seconds=2.4)
        self.fake("mark")
        self.down()
        self.assert_over_when_disarmed(process, 1, "the time is over")

    def test_the_program_hangs(self):
        """The second process takes over, and the first one, woken up again, sends no more."""
        process = self.flying("--json")
        self.fake("mark")
        process.send_signal(signal.SIGSTOP)
        self.assert_brought_down(self.down())
        self.assertLess(self.longest_gap(), 4.5 * PERIOD)  # two and a half of silence, and what it takes to begin
        process.send_signal(signal.SIGCONT)
        out, _ = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 1)
        self.assertIn("the second process has taken over", json.loads(out)["stop_reason"])
        self.assertLess(self.longest_gap(), 4.5 * PERIOD)

    def test_the_second_process_dies(self):
        process = self.flying("--json")
        self.fake("mark")
        children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True, check=True).stdout.split()
        keeper = [child for child in children if "--drone" in self.name_of(child)]
        subprocess.run(["kill", "-9", keeper[0]], check=True)
        self.assert_brought_down(self.down())
        self.assert_over_when_disarmed(process, 1, "told to end")

    def test_the_pilot_takes_it_back_and_gives_it_again_only_from_the_floor(self):
        process = self.flying("--json")
        self.fake("override off")
        self.until(lambda: self.fake.rows("state")[-1]["throttle"] != "1000", 2)
        self.fake("mark")
        time.sleep(0.5)
        # Streaming goes on while the radio has the drone; it would bring the drone down, not let it fall.
        self.assertTrue(all(int(row["throttle"]) > 1200 for row in self.fake.rows("frame")[-10:]))
        self.fake("disarm")
        self.until(lambda: self.fake.rows("frame")[-1]["throttle"] == "1000", 2)
        process.terminate()
        process.communicate(timeout=10)

    @staticmethod
    def name_of(process):
        with open(f"/proc/{process}/cmdline", encoding="utf-8") as words:
            return words.read()


class NotHandedOver(Handed):
    def test_the_override_before_arming_is_not_flown(self):
        process = self.streamed("--json")
        self.fake("override on")
        time.sleep(0.5)
        self.fake("arm")
        time.sleep(1.0)
        self.assertTrue(all(row["throttle"] == "1000" for row in self.fake.rows("frame")))
        process.terminate()
        out, said = process.communicate(timeout=10)
        self.assertIn("the override came on before arming", said)
        self.assertEqual(json.loads(out)["sticks"]["frames"], len(self.fake.rows("frame")))

    def test_killed_on_the_floor_nothing_takes_over(self):
        process = self.streamed()
        process.kill()
        time.sleep(0.3)
        frames = len(self.fake.rows("frame"))
        time.sleep(0.3)
        self.assertEqual(len(self.fake.rows("frame")), frames)
        self.assertEqual(self.fake.rows("frame")[-1]["throttle"], "1000")


if __name__ == "__main__":
    main()
