#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly bench-drone --hand-over with a drone that behaves like one, and with each way in which it may not. In real time.

usage: hand_over_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import pathlib
import signal
import subprocess
import threading
import time
import tomllib

from drone import DRONE, Handed, end_of
from program import GATEFLY, ROOT, main

# Answers of somebody at the radio; the first that is in the line.
RADIO = (("rest", "switch the override off, then disarm"), ("arm", "hands off them; arm"), ("override on", "switch the override on"),
         ("override off", "switch the override off"), ("disarm", "disarm"))


class HandOver(Handed):
    OF_DRONE = DRONE

    def setUp(self):
        super().setUp()
        self.drone = self.file("drone.toml", self.OF_DRONE.read_text(encoding="utf-8"))
        self.asked = []

    def flags(self, *more):
        return ["bench-drone", "--hand-over", str(self.drone), "--propellers-off", "--link", self.link(), "--camera", "gst:videotestsrc",
                "--step-s", "4", *more]

    def background(self, *more):
        process = subprocess.Popen([GATEFLY, *self.flags(*more)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=dict(os.environ, XDG_CACHE_HOME=str(self.cache), **self.environment))
        self.addCleanup(end_of, process)
        # A process that flies goes on until the radio has the drone.
        self.addCleanup(lambda: (self.fake("override off"), self.fake("disarm")))
        return process

    def radio(self, process, before=lambda what, count: None):
        """Does what it is asked, at a person's pace; `before` hears of it, and answers True for what is not to be done."""
        for line in process.stderr:
            self.asked.append(line.strip())
            word, prompt = next((each for each in RADIO if each[1] in line), (None, None))
            if word is None or before(word, sum(prompt in each for each in self.asked)):
                continue
            time.sleep(0.15)
            for each in ("override off", "disarm") if word == "rest" else (word,):
                self.fake(each)

    def walked(self, *faults, before=lambda what, count: None, flags=()):
        for fault in faults:
            self.fake(fault)
        process = self.background(*flags)
        hand = threading.Thread(target=self.radio, args=(process, before))
        hand.start()
        out = process.stdout.read()
        process.wait(timeout=60)
        hand.join()
        return process.returncode, out

    def marked(self):
        return "hand_over_test" in tomllib.loads(self.drone.read_text(encoding="utf-8"))

    def assert_left_alone(self):
        """Nobody sends any more, and the radio has the drone."""
        frames = len(self.fake.rows("frame"))
        time.sleep(0.2)
        self.assertEqual(len(self.fake.rows("frame")), frames, "it still sends")
        state = self.fake.rows("state")[-1]
        self.assertEqual((state["armed"], state["override"]), ("0", "0"))

    def assert_run_streams(self):
        """run takes the drone with the mark in its file."""
        process = self.start(drone=self.drone)
        frames = len(self.fake.rows("frame"))
        self.until(lambda: process.poll() is not None or len(self.fake.rows("frame")) > frames + 10)
        self.assertIsNone(process.poll())
        process.terminate()
        process.communicate(timeout=10)

    def wrong(self, *faults, line, before=lambda what, count: None):
        """It has not passed: its line is the last finding, there is no mark, and the drone is nobody's."""
        self.drone.write_text(self.signed(self.OF_DRONE.read_text(encoding="utf-8")).read_text(encoding="utf-8"), encoding="utf-8")
        code, out = self.walked(*faults, before=before)
        self.assertEqual(code, 1, out + "\n".join(self.asked))
        found = [each for each in out.splitlines() if each.startswith("WRONG")]
        self.assertEqual(len(found), 1, out)
        self.assertIn(line, found[0])
        self.assertFalse(self.marked(), "an older mark has been left")
        self.assert_left_alone()
        return out


class Passed(HandOver):
    def test_a_healthy_drone_passes_and_run_takes_it_until_a_constant_changes(self):
        before = self.drone.read_text(encoding="utf-8")
        code, out = self.walked()
        self.assertEqual(code, 0, out + "\n".join(self.asked))
        self.assertNotIn("WRONG", out)
        for line in ("acknowledged, pictures come", "roll, pitch, yaw and throttle as sent", "camera out: it brakes", "program killed (-9): the second process sends after",
                     "keeps the last sticks for 1500 ms and may for ever", "from one to the next", "the hand-over test has passed"):
            self.assertIn(line, out)
        self.assert_left_alone()
        after = self.drone.read_text(encoding="utf-8")
        self.assertTrue(after.startswith(before.rstrip("\n")), "the rest of the file is another one")
        # A valid mark: run streams. Once a constant has changed, it does not.
        self.assert_run_streams()
        self.drone.write_text(after.replace("hover_stick_us = 1425", "hover_stick_us = 1426"), encoding="utf-8")
        self.assertIn("missing or out of date", self.refused(*self.words(drone=self.drone), **self.environment))

    def test_a_controller_that_forgets_passes_and_is_said_to_be_one(self):
        self.drone.write_text(self.signed().read_text(encoding="utf-8").replace('passed = "', 'passed = "0'), encoding="utf-8")
        code, out = self.walked("forgets", flags=("--json",))
        told = json.loads(out)
        self.assertEqual((code, told["well"], told["file"]), (0, True, str(self.drone)), out)
        self.assertTrue(any("the radio's again after" in each["line"] and "hold your sticks" in each["line"] for each in told["findings"]), out)
        self.assertEqual(self.drone.read_text(encoding="utf-8").count("passed"), 1)


class OverMavlink(HandOver):
    """An ArduCopter, whose channels are its own: what is read back is the set point that it flies by, and its mode is the override."""

    FAKE = os.environ.get("GATEFLY_FAKE_ARDUCOPTER", "")
    CONFIG = "arducopter"
    OF_DRONE = ROOT / "tests" / "live" / "fake_arducopter.toml"

    def link(self):
        return f"mavlink:tcp:127.0.0.1:{self.fake.port}"

    def test_a_healthy_drone_passes_and_run_takes_it(self):
        before = self.drone.read_text(encoding="utf-8")
        code, out = self.walked()
        self.assertEqual(code, 0, out + "\n".join(self.asked))
        self.assertNotIn("WRONG", out)
        for line in ("acknowledged, pictures come", "roll, pitch, yaw and throttle as sent", "another mode, and it stays", "camera out: it brakes", "program killed (-9): the second process sends after",
                     "lets go of the last set point after", "from one to the next", "the hand-over test has passed"):
            self.assertIn(line, out)
        self.assert_left_alone()
        self.assertTrue(self.drone.read_text(encoding="utf-8").startswith(before.rstrip("\n")), "the rest of the file is another one")
        self.assert_run_streams()

    def test_set_points_that_are_not_obeyed(self):
        self.wrong("deaf", line="override on: roll and pitch and yaw and throttle not as sent")

    def test_a_pitch_that_is_flown_the_other_way(self):
        self.wrong("pitch obeyed inverted", line="override on: pitch not as sent")

    def test_a_set_point_that_is_held_for_ever(self):
        self.wrong("holds on", line="the controller holds the last set point for longer than 2000 ms")

    def test_a_switch_that_is_moved_is_no_letting_go(self):
        """Both processes are killed the fourth time that it has been handed over."""
        def moves(word, count):
            if word == "override on" and count == 4:
                threading.Timer(1.2, lambda: self.fake("override off")).start()
        self.wrong("holds on", line="taken back too early", before=moves)

    def test_a_mode_that_does_not_change(self):
        self.wrong(line="for 4 s the controller has not seen this at the radio: switch the override off", before=lambda word, count: word == "override off")


class Smoke(HandOver):
    def test_channels_that_do_not_follow(self):
        self.wrong("deaf", line="override on: roll and pitch and yaw and throttle not as sent")


class Wrong(HandOver):
    def test_one_channel_that_does_not_follow(self):
        self.assertNotIn("roll", self.wrong("no yaw", line="override on: yaw not as sent").split("override on: ")[1].split(",")[0])

    def test_channels_that_are_swapped(self):
        self.wrong("channels swapped", line="override on: yaw and throttle not as sent")

    def test_sticks_that_freeze(self):
        self.wrong("sticks frozen", line="override on: roll and pitch and yaw not as sent")

    def test_an_override_that_does_not_go_off(self):
        self.wrong("override stuck", line="override off: the channels are not the radio's")

    def test_frames_that_are_not_acknowledged(self):
        self.wrong("unacknowledged", line="neutral stick frames are not acknowledged")

    def test_a_controller_that_does_something_else_when_nobody_sends(self):
        self.wrong("failsafe", line="neither the last sticks nor the radio's")

    def test_nobody_at_the_radio(self):
        self.wrong(line="for 4 s the controller has not seen this at the radio", before=lambda word, count: word != "rest")

    def test_the_override_before_arming_is_said_and_can_be_done_again(self):
        def wrong_order(word, count):
            if word == "arm" and count == 1:
                self.fake("override on")
                time.sleep(0.3)
            if word == "override on" and count == 1:
                time.sleep(0.3)
                self.fake("override off")
                time.sleep(0.3)
            return False
        self.wrong("deaf", line="override on: roll and pitch and yaw and throttle not as sent", before=wrong_order)  # it has been handed over
        self.assertTrue(any("the override came on before arming" in line for line in self.asked), self.asked)

    def test_a_camera_that_shows_nothing(self):
        (self.folder / "frozen").touch()
        self.wrong(line="no pictures from the camera")

    def test_a_camera_that_stops_in_flight(self):
        def stops(word, count):
            if word == "override off":
                (self.folder / "frozen").touch()
        self.wrong(line="no pictures from the camera", before=stops)

    def test_a_link_that_is_cut_in_flight(self):
        def cut(word, count):
            if word == "override off":
                self.fake("cut")
                self.fake("disarm")
                self.fake("override off")
        self.wrong(line="the connection is gone", before=cut)

    def test_a_second_process_that_is_not_there(self):
        """It is killed while the first has not been: this one ends, as it must."""
        def kill_keeper(word, count):
            if word == "override on" and count == 3:
                rigs = self.children(self.process)
                for rig in rigs:
                    for child in self.children(rig):
                        if "--hand-over" in pathlib.Path(f"/proc/{child}/cmdline").read_text(encoding="utf-8"):
                            os.kill(child, signal.SIGKILL)
        self.wrong(line="the second process has died", before=kill_keeper)

    def background(self, *more):
        process = super().background(*more)
        self.process = process.pid
        return process

    @staticmethod
    def children(process):
        return [int(each) for each in subprocess.run(["pgrep", "-P", str(process)], capture_output=True, text=True, check=False).stdout.split()]


class Ended(HandOver):
    """Ends in flight: a descent is streamed until the radio has the drone."""

    def ended(self, number):
        process = self.background()
        descended = []

        def end(word, count):
            if word == "override off":
                process.send_signal(number)
            if word == "rest":
                time.sleep(1.5)
                descended.append(self.descends() and process.poll() is None)
            return word == "override off"
        hand = threading.Thread(target=self.radio, args=(process, end))
        hand.start()
        return process, hand, descended

    def test_ctrl_c(self):
        process, hand, descended = self.ended(signal.SIGINT)
        out = process.stdout.read()
        process.wait(timeout=20)
        hand.join()
        self.assertEqual(process.returncode, 130, out)
        self.assertEqual(descended, [True])
        self.assertIn("told to end", out)
        self.assertFalse(self.marked())
        self.assert_left_alone()

    def test_killed(self):
        """The process that watches, not the one that flies."""
        process, hand, _ = self.ended(signal.SIGKILL)
        process.wait(timeout=20)
        time.sleep(1.5)
        self.assertTrue(self.descends(), "it does not send a descent")
        for word in ("override off", "disarm"):
            self.fake(word)
        hand.join(timeout=5)
        self.assertFalse(hand.is_alive(), "the process that flies has not ended")
        self.assertFalse(self.marked())
        self.assert_left_alone()

    def descends(self):
        rows = self.fake.rows("frame")[-10:]
        return all((row["roll"], row["pitch"], row["yaw"]) == ("1500", "1500", "1500") and 1200 < int(row["throttle"]) < 1425 for row in rows)


class Refused(HandOver):
    def refused_by(self, line, *changed, drop=()):
        flags = [each for each in self.flags() if each not in drop]
        said = self.refused(*flags, *changed, **self.environment)
        self.assertIn(line, said)
        self.assertEqual(self.fake.rows("frame"), [])

    def test_what_run_refuses(self):
        self.fake("arm")
        self.refused_by("the drone is armed")
        self.fake("disarm")
        self.fake("override on")
        self.refused_by("the override is on")
        self.fake("override off")
        self.drone.write_text(DRONE.read_text(encoding="utf-8").replace("super_rate = [45", "super_rate = [75"), encoding="utf-8")
        self.refused_by("is not the drone of")

    def test_what_does_not_go_together(self):
        self.refused_by("--propellers-off is missing", drop=("--propellers-off",))
        self.refused_by("--camera is required", drop=("--camera", "gst:videotestsrc"))
        self.refused_by("--hand-over excludes --name", "--name", "other")
        self.assertIn("a recording is no camera", self.refused(*[f"file:{self.folder}" if each == "gst:videotestsrc" else each for each in self.flags()]))
        self.assertIn("--name is required", self.refused("bench-drone", "--propellers-off", "--link", "msp:tcp:127.0.0.1:1"))

    def test_a_refusal_leaves_an_older_mark(self):
        self.drone.write_text(self.signed().read_text(encoding="utf-8"), encoding="utf-8")
        self.fake("arm")
        self.refused(*self.flags(), **self.environment)
        self.assertTrue(self.marked())


if __name__ == "__main__":
    main()
