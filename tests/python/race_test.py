#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A race flown from Python is the one that `gatefly fly` flies with the same seed, to the bit."""
import csv
import gzip
import json
import os
import shutil
import signal
import sys
import threading
import time
import unittest

import numpy as np

import gatefly
import support
from support import Case

sys.path.insert(0, str(support.ROOT / "tools"))
from frames_of import frames_of

PHASES = ["ground", "take-off", "straight", "turn", "search", "land", "landed"]


def without_timings(summary):
    return {key: value for key, value in summary.items() if key != "timings"}


def number(cell):
    return None if cell == "" else float(cell)


def vector(row, *names):
    return [float(row[name]) for name in names]


@support.needs_simulator
class SameRace(Case):
    def fly(self, track, seed, *flags):
        """The rows of the log and of the table of pictures, and the summary, as the program writes them."""
        self.program("fly", track, "--seed", seed, "--out", "flight", *flags, codes=(0, 1))
        folder = self.folder / "flight"
        packed = folder / "log_si.csv.gz"
        log = gzip.decompress(packed.read_bytes()).decode() if packed.exists() else (folder / "log_si.csv").read_text(encoding="utf-8")
        tables = [list(csv.DictReader(text.splitlines())) for text in (log, (folder / "images.csv").read_text(encoding="utf-8"))]
        return folder, *tables, json.loads((folder / "summary.json").read_text(encoding="utf-8"))

    def expect_row(self, race, row):
        sensors, estimate, command, truth = race.sensors, race.estimate, race.command, race.truth
        self.assertEqual(sensors.time_ns, int(row["t_ns"]))
        self.assertEqual([*sensors.gyro_B, *sensors.accel_B],
                         vector(row, "gyro_p_radps", "gyro_q_radps", "gyro_r_radps", "acc_x_mps2", "acc_y_mps2", "acc_z_mps2"))
        self.assertEqual((sensors.sonar, sensors.baro), (number(row["sonar_m"]), number(row["baro_m"])))
        self.assertEqual([*estimate.p_EB, *estimate.v_E, estimate.roll, estimate.pitch, estimate.yaw],
                         vector(row, "est_x_m", "est_y_m", "est_z_m", "est_vx_mps", "est_vy_mps", "est_vz_mps", "est_roll_rad", "est_pitch_rad",
                                "est_yaw_rad"))
        self.assertEqual([*truth.p_EB, *truth.v_E, truth.roll, truth.pitch, truth.yaw],
                         vector(row, "ot_x_m", "ot_y_m", "ot_z_m", "ot_vx_mps", "ot_vy_mps", "ot_vz_mps", "true_roll_rad", "true_pitch_rad",
                                "true_yaw_rad"))
        self.assertEqual([command.roll, command.pitch, command.yaw, command.thrust, *command.motors],
                         vector(row, "cmd_roll_rad", "cmd_pitch_rad", "cmd_yaw_rad", "cmd_thrust_mps2", "motor_lf_radps", "motor_rf_radps",
                                "motor_rb_radps", "motor_lb_radps"))
        self.assertEqual((PHASES.index(race.phase), race.target_gate, estimate.gates_passed),
                         (int(row["phase"]), int(row["target_gate"]), int(row["gates_passed"])))

    def test_a_whole_race_with_ideal_vision(self):
        _, log, _, summary = self.fly("oval", 5, "--vision", "ideal", "--laps", 2, "--set", "control.speed_mps=1.5")
        race = gatefly.Race("oval", seed=5, vision="ideal", laps=2, settings={"control.speed_mps": 1.5})
        self.assertIsNone(race.result)
        for row in log:
            self.assertTrue(race.step())
            self.expect_row(race, row)
        self.assertTrue(race.over)
        self.assertFalse(race.step())
        self.assertTrue(race.result["finished"])
        self.assertEqual(without_timings(race.result), without_timings(summary))
        self.assertEqual(list(race.result), list(summary))

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg here")
    def test_a_rendered_race_and_its_pictures(self):
        flags = {"sim.timeout_s": 7}
        folder, log, images, summary = self.fly("oval", 3, "--set", "sim.timeout_s=7", "--frames")
        self.assertGreater(len(images), 60)
        race, saw = gatefly.Race("oval", 3, settings=flags), 0
        for picture, row, (name, kept) in zip(race.pictures(), images, frames_of(folder), strict=True):
            self.expect_row(race, log[int(row["log_row"])])
            self.assertEqual(name, row["image"])
            frame = gatefly.Image.from_uyvy(kept, 160, 315, rotation=90)
            self.assertTrue(np.array_equal(picture.yuv(), frame.yuv()))
            saw += len(race.sighting.gates)
        self.assertEqual(without_timings(race.result), without_timings(summary))
        with (folder / "detections.csv").open(encoding="utf-8") as table:
            self.assertEqual(saw, sum(row["method"] != "bars" for row in csv.DictReader(table)))

    def test_run_is_steps(self):
        race = gatefly.Race("oval", seed=5, vision="ideal", laps=1)
        other = gatefly.Race("oval", seed=5, vision="ideal", laps=1)
        for _ in range(1000):
            race.step()
        race.run()
        other.run()
        self.assertEqual(without_timings(race.result), without_timings(other.result))
        self.assertEqual(race.estimate.p_EB.tolist(), other.estimate.p_EB.tolist())


@support.needs_simulator
class Races(Case):
    def test_what_cannot_be_flown_is_refused(self):
        for words, named in (("no such file, nor a name in tracks/", {"track": "nowhere"}), ("must be 'rendered' or 'ideal'", {"vision": "blurred"}),
                             ("must be in 1..100", {"laps": 0}), ("must be in 0..2^64", {"seed": -1}), ("must be in 0..2^64", {"seed": 1 << 64}),
                             ("not a known key", {"settings": {"sim.nothing": 1}})):
            self.assertIn(words, self.refused(gatefly.Error, gatefly.Race, **named))
        for named in ({"track": 3}, {"seed": "one"}, {"seed": 1.5}, {"laps": "two"}, {"vision": 3}):
            self.refused(TypeError, gatefly.Race, **named)
        track = self.folder / "mine.toml"
        track.write_text("[[gates]]\nposition_m = [3.0, 0.0, -0.2]\n", encoding="utf-8")
        self.assertIn("mine.toml", self.refused(gatefly.Error, gatefly.Race, track))

    def test_before_the_first_step_nothing_is_known(self):
        race = gatefly.Race("oval", vision="ideal", seed=2)
        self.assertEqual((race.time, race.over, race.result, race.picture, race.phase), (0.0, False, None, None, "ground"))
        self.assertEqual((race.track, race.seed, race.vision), ("oval", 2, "ideal"))
        self.assertFalse(race.sighting.seen)
        self.assertIsNone(race.sighting.used)
        self.assertEqual([gate.p_EG.shape for gate in race.gates], [(3,)] * 2)
        self.assertGreater(race.gates[0].side, 0.5)

    def test_ideal_vision_has_no_pictures(self):
        race = gatefly.Race("oval", vision="ideal")
        self.assertIn("no pictures", self.refused(gatefly.Error, race.pictures))

    def test_a_race_can_be_stopped(self):
        race = gatefly.Race("oval", vision="ideal")
        race.step()
        race.stop()
        self.assertTrue(race.over)
        self.assertEqual(race.result["stop_reason"], "stopped")
        race.stop()
        race.run()
        self.assertFalse(race.step())

    def test_control_c_stops_between_two_ticks_and_the_race_goes_on(self):
        race = gatefly.Race("oval", vision="ideal", laps=100, settings={"sim.timeout_s": 2000})
        timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))  # runs: the interpreter is free
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            race.run()
        timer.join()
        self.assertFalse(race.over)
        before = race.time
        self.assertTrue(race.step())
        self.assertGreater(race.time, before)

    def test_control_c_stops_the_bake_of_a_large_halls_light(self):
        hall = self.folder / "hall.toml"
        hall.write_text("[[gates]]\nposition_m = [3.0, 0.0, -1.5]\n[room]\nsize_m = [120.0, 120.0, 6.0]\n", encoding="utf-8")
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        began = time.process_time()
        with self.assertRaises(KeyboardInterrupt):
            gatefly.Race(hall)
        self.assertLess(time.process_time() - began, 4.0)  # of minutes, on all cores together
        timer.join()

    def test_one_thread_flies_a_race_at_a_time(self):
        race = gatefly.Race("oval", vision="ideal", laps=20, settings={"sim.timeout_s": 2000})
        thread = threading.Thread(target=race.run)
        thread.start()
        words = ""
        while thread.is_alive() and not words:
            try:
                race.step()
                _ = race.estimate
            except gatefly.Error as error:
                words = str(error)
        thread.join()
        self.assertIn("flown by another thread", words)
        self.assertTrue(race.over)


class WithoutSimulator(Case):
    def test_a_race_says_so(self):
        if support.has_simulator():
            self.skipTest("built with the simulator")
        self.assertIn("without the simulator", self.refused(gatefly.Error, gatefly.Race, "oval"))


if __name__ == "__main__":
    support.main()
