#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly record: a folder a battery that replay reads, whatever ends it.

usage: record_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import csv
import json
import os
import resource
import signal
import subprocess
import time
import unittest

from drone import DRONE, WithDrone, end_of
from program import GATEFLY, main


class Record(WithDrone):
    def words(self, *arguments, drone=DRONE):
        return ["record", "--config", "betaflight", "--camera", "gst:videotestsrc", "--link", f"msp:tcp:127.0.0.1:{self.fake.port}",
                "--drone", str(drone), "--out", "flights", *map(str, arguments)]

    def flight(self, number=1):
        return self.folder / "flights" / f"flight-{number:04d}"

    def rows(self, name="log_si.csv", number=1):
        """Whole lines of a table."""
        text = (self.flight(number) / name).read_text(encoding="utf-8")
        return list(csv.DictReader(text[:text.rfind("\n") + 1].splitlines()))

    def until(self, what, seconds=20.0):
        end = time.monotonic() + seconds
        while not what():
            self.assertLess(time.monotonic(), end, "it takes too long")
            time.sleep(0.05)

    def recording(self, *arguments, pictures=10, **more):
        """The program, once so many pictures are listed."""
        process = self.start(*arguments, **more)
        self.until(lambda: process.poll() is not None or ((self.flight() / "images.csv").exists() and len(self.rows("images.csv")) >= pictures))
        self.assertIsNone(process.poll(), process.stderr.read() if process.poll() is not None else "")
        return process

    def replayed(self, number=1):
        result = self.run_it("replay", self.flight(number), "--track", "oval", "--config", "betaflight")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.assertIn(f"{len(self.rows(number=number))} samples", result.stdout)
        return result

    def test_what_was_heard_and_seen_is_in_the_folder_and_nothing_was_sent(self):
        result = self.run_it(*self.words("--time-limit", "3", "--json"), **self.environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual((told["stop_reason"], told["kind"], told["detection"]["frames"]), ("told to end", "record", len(self.rows("images.csv"))))
        self.assertGreater(told["link"]["samples"], 20)
        self.assertGreater(told["detection"]["frames"], 10)
        self.assertEqual(self.fake.rows("frame"), [])
        heard = [row for row in self.rows() if row["nav_acc_z_mps2"]]
        self.assertAlmostEqual(float(heard[-1]["nav_acc_z_mps2"]), -9.81, delta=0.5)
        self.assertTrue(heard[-1]["stick_throttle_us"] and heard[-1]["battery_v"] and heard[-1]["fc_roll_rad"], heard[-1])
        self.assertIn("--track names where the gates stand", self.run_it("identify", self.flight()).stderr)
        known = self.run_it("identify", self.flight(), "--track", "oval", "--config", "betaflight")
        self.assertEqual(known.returncode, 1, known.stderr)  # it stood on the table
        self.assertIn("not known: less than 3 s under way", known.stdout)
        times = [int(row["t_ns"]) for row in self.rows()]
        self.assertEqual({b - a for a, b in zip(times, times[1:])}, {times[1] - times[0]})  # regular, whatever the disk did
        self.replayed()

    def test_it_ends_when_told_with_a_whole_folder(self):
        process = self.recording()
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=10)
        self.assertEqual(process.returncode, 143)
        self.assertTrue((self.flight() / "summary.json").exists())
        self.replayed()

    def test_killed_it_leaves_what_was_written_and_that_is_read(self):
        process = self.recording()
        process.kill()
        process.wait()
        self.assertFalse((self.flight() / "summary.json").exists())
        with open(self.flight() / "log_si.csv", "a", encoding="utf-8") as log:
            log.write("123,0.5")  # a line that was cut
        with open(self.flight() / "images.csv", "a", encoding="utf-8") as log:
            log.write(f"img_99999.jpg,{10**12},999999,0,0\n")  # a picture that never came to the disk
        self.replayed()
        # The next one is another folder.
        self.start()
        self.until(lambda: (self.flight(2) / "images.csv").exists())

    def test_a_disk_that_is_full_ends_the_folder_and_not_the_recorder(self):
        def little_disk():
            resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        process = subprocess.Popen([GATEFLY, *self.words("--time-limit", "20")], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=dict(os.environ, XDG_CACHE_HOME=str(self.cache), **self.environment), preexec_fn=little_disk)
        self.addCleanup(end_of, process)
        self.until(lambda: (self.flight() / "summary.json").exists())
        self.assertIsNone(process.poll())
        told = json.loads((self.flight() / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(told["stop_reason"], "the disk is full")
        self.assertTrue((self.flight() / "log_si.csv").read_text(encoding="utf-8").endswith("\n"))
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate(timeout=10)
        self.assertIn("cannot be written", errors)
        self.replayed()

    def test_a_disk_that_is_nearly_full_is_left_alone(self):
        result = self.run_it(*self.words("--time-limit", "2", "--keep-free-mib", "1000000"), **self.environment)
        self.assertEqual(result.returncode, 1)
        self.assertIn("less than 1000000 MiB are free", result.stderr)
        self.assertFalse((self.folder / "flights").exists() and any((self.folder / "flights").iterdir()))

    def test_a_controller_that_falls_silent_and_answers_again_is_another_battery(self):
        process = self.recording()
        self.fake("cut")
        self.until(lambda: (self.flight(2) / "images.csv").exists() and len(self.rows("images.csv", 2)) > 3)
        told = json.loads((self.flight(1) / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(told["stop_reason"], "the controller has fallen silent")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=10)
        self.assertEqual(process.returncode, 130)
        self.replayed(1)
        self.replayed(2)

    def test_a_camera_that_stands_still_costs_nothing_but_its_pictures(self):
        process = self.recording()
        (self.folder / "frozen").write_text("", encoding="utf-8")
        before = len(self.rows())
        self.until(lambda: len(self.rows()) > before + 300)
        self.assertIsNone(process.poll())

    def test_it_waits_for_a_controller_that_is_not_there_yet(self):
        words = self.words("--time-limit", "2")
        words[words.index("--link") + 1] = "msp:tcp:127.0.0.1:1"
        result = self.run_it(*words, **self.environment)
        self.assertEqual(result.returncode, 1)
        self.assertIn("waiting for it", result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_another_drone_and_a_recording_are_refused(self):
        other = self.file("other.toml", DRONE.read_text(encoding="utf-8").replace("super_rate = [45", "super_rate = [75"))
        self.assertIn("is not the drone of", self.refused(*self.words(drone=other), **self.environment))
        words = self.words()
        words[words.index("--link") + 1] = "replay:x"
        self.assertIn("is recorded already", self.refused(*words, **self.environment))


if __name__ == "__main__":
    main(at_once=4)
