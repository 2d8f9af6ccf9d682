#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Replay from Python: the numbers that `gatefly replay` writes."""
import csv
import os
import signal
import threading

import numpy as np

import gatefly
import support
from support import FLIGHT, Case


class Replay(Case):
    def test_estimates_and_summary_are_the_programs(self):
        for estimator in ("drag", "imu15"):
            flight = gatefly.replay(FLIGHT, estimator=estimator)
            summary = self.program_json("replay", FLIGHT, "--estimator", estimator, "--csv", "estimates.csv", "--force")
            self.assertEqual(flight.summary, summary)
            with (self.folder / "estimates.csv").open(encoding="utf-8") as table:
                rows = list(csv.reader(table))
            self.assertEqual(list(flight.estimates), rows[0])
            for name, cells in zip(rows[0], zip(*rows[1:], strict=True), strict=True):
                self.assertEqual(flight.estimates[name].tolist(), list(cells) if name == "source" else [float(cell) for cell in cells])
            self.assertEqual(flight.rmse.tolist(), summary["rmse_m"])
            self.assertEqual(flight.true_p_EB.shape, (summary["samples"], 3))

    def test_settings_change_what_comes_out(self):
        usual = gatefly.replay(FLIGHT).estimates["x_m"]
        self.assertFalse(np.array_equal(gatefly.replay(FLIGHT, settings={"filter.corner_sigma_px": 4.0}).estimates["x_m"], usual))

    def test_what_cannot_be_replayed_is_refused(self):
        self.assertIn("nowhere", self.refused(gatefly.Error, gatefly.replay, self.folder / "nowhere"))
        self.refused(gatefly.Error, gatefly.replay, self.folder)
        self.assertIn("must be 'drag', 'eskf' or 'imu15'", self.refused(gatefly.Error, gatefly.replay, FLIGHT, estimator="best"))
        self.assertIn("tracks/", self.refused(gatefly.Error, gatefly.replay, FLIGHT, track="nowhere"))
        self.refused(TypeError, gatefly.replay, 3)
        (self.folder / "log_si.csv").write_text("t_s\n1\n", encoding="utf-8")
        self.refused(gatefly.Error, gatefly.replay, self.folder)

    @support.needs_simulator
    def test_a_flight_that_kept_no_pictures(self):
        self.program("fly", "oval", "--set", "sim.timeout_s=4", "--out", "flight", codes=(0, 1))
        summary = gatefly.replay(self.folder / "flight").summary
        self.assertEqual((summary["pictures_from"], summary["pictures_other"], summary["same_as_recorded"]), ("rendered", 0, True))

    def test_control_c_stops_it(self):
        timer = threading.Timer(0.03, os.kill, (os.getpid(), signal.SIGINT))
        with self.assertRaises(KeyboardInterrupt):
            timer.start()
            for _ in range(1000):
                gatefly.replay(FLIGHT)
        timer.join()


if __name__ == "__main__":
    support.main()
