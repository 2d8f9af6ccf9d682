#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""replay --smooth, and map: a flight by all that was measured, and the course that flights have learnt.

usage: smoothing_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import math
import shutil
import tomllib

from program import ROOT, Cli, main


class Smoothing(Cli):
    """The sample flight: one lap of the oval, five pictures a second."""
    FLIGHT = ROOT / "tests" / "replay" / "oval_flight"

    def test_the_smoother_stands_beside_the_filter(self):
        result = self.run_it("replay", self.FLIGHT, "--smooth", "--estimator", "eskf", "--json", "--csv", "s.csv", "--tum", "s.txt")
        self.assertEqual(result.returncode, 0, result.stderr)
        answer = json.loads(result.stdout)
        smoothed = answer["smoothed"]
        self.assertTrue(smoothed["settled"])
        aligned = [math.hypot(*smoothed[key]["rmse_m"]) for key in ("filter_aligned", "aligned")]
        self.assertLess(aligned[1], 0.8 * aligned[0])  # a straight flight of 8 s
        rows = (self.folder / "s.csv").read_text().splitlines()
        self.assertEqual(len(rows), answer["samples"] + 1)
        plain = self.run_it("replay", self.FLIGHT, "--estimator", "eskf", "--csv", "f.csv")
        self.assertEqual(plain.returncode, 0, plain.stderr)
        filtered = (self.folder / "f.csv").read_text().splitlines()
        self.assertEqual(rows[0], filtered[0])
        self.assertNotEqual(rows[1000], filtered[1000])
        self.assertIn("aligned rms", self.run_it("replay", self.FLIGHT, "--smooth", "--estimator", "eskf").stdout)

    def test_only_the_filter_whose_models_it_has_is_smoothed(self):
        for estimator in ("drag", "imu15"):
            with self.subTest(estimator):
                self.assertEqual(self.refused("replay", self.FLIGHT, "--smooth", "--estimator", estimator),
                                 f"gatefly: --smooth: smooths the estimator eskf, this is {estimator}; give --estimator eskf\n")

    def test_a_flight_teaches_a_map_that_can_be_flown(self):
        result = self.run_it("map", self.FLIGHT, "--out", "learnt.toml", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        answer = json.loads(result.stdout)
        learnt = tomllib.loads((self.folder / "learnt.toml").read_text())
        self.assertEqual(len(learnt["gates"]), len(answer["gates"]))
        for gate, told in zip(learnt["gates"], answer["gates"]):
            self.assertEqual(len(gate["position_sigma_m"]), 3)
            self.assertLess(max(gate["position_sigma_m"]), 0.12)
            self.assertAlmostEqual(gate["heading_sigma_deg"], told["heading_sigma_deg"], delta=0.01)
        self.assertEqual(self.run_it("track", "learnt.toml").returncode, 0)
        flown = self.run_it("fly", "learnt.toml", "--vision", "ideal", "--json", "--set", "sim.timeout_s=2")
        self.assertEqual(flown.returncode, 1, flown.stderr)  # two seconds are no race

    def test_a_map_never_takes_the_place_of_what_it_comes_from(self):
        mine = self.file("mine.toml", (ROOT / "tracks" / "oval.toml").read_text())
        self.assertIn("mine.toml", self.refused("map", self.FLIGHT, "--track", "mine.toml", "--out", "mine.toml"))
        self.assertIn("learnt track", self.refused("map", self.FLIGHT, "--out", self.file("notes.txt", "mine\n")))
        self.assertEqual(mine.read_text(), (ROOT / "tracks" / "oval.toml").read_text())

    def test_flights_of_different_tracks_are_refused_by_name(self):
        other = self.folder / "other"
        shutil.copytree(self.FLIGHT, other)
        track = other / "track.toml"
        track.write_text((ROOT / "tracks" / "figure8.toml").read_text())
        said = self.refused("map", self.FLIGHT, other, "--out", "learnt.toml")
        self.assertIn(str(track), said)
        self.assertIn("oval_flight", said)


if __name__ == "__main__":
    main()
