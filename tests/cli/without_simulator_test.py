#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The program that was built without the simulator: what it does, and what it says of the rest.

usage: without_simulator_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import csv
import json

from program import ROOT, Cli, main


class WithoutSimulator(Cli):
    def flight(self):
        return ROOT / "tests" / "replay" / "oval_flight"

    def test_what_flies_in_the_simulator_is_one_line_and_exit_2(self):
        for command in ("fly", "campaign", "reproduce", "bench"):
            for arguments in ((), ("oval", "--seed", "3"), ("--help",)):
                with self.subTest(command=command, arguments=arguments):
                    self.assertEqual(self.refused(command, *arguments),
                                     f"gatefly {command}: this program was built without the simulator\n")

    def test_every_other_command_has_its_help(self):
        for command in ("replay", "detect", "score", "calibrate", "tune", "identify", "map", "run", "bench-drone", "import", "record", "config", "track", "doctor", "new"):
            with self.subTest(command=command):
                result = self.run_it(command, "--help")
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertIn("gatefly " + command, result.stdout)

    def test_a_flight_that_was_flown_in_the_simulator_is_replayed(self):
        result = self.run_it("replay", self.flight(), "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(json.loads(result.stdout)["fixes"], 0)

    def test_a_course_is_checked(self):
        result = self.run_it("track", "oval", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(json.loads(result.stdout)["can_be_flown"])

    def test_the_doctor_says_that_the_simulator_is_missing(self):
        result = self.run_it("doctor", "--json")
        self.assertEqual(result.returncode, 1, result.stderr)
        lacking = [check["name"] for check in json.loads(result.stdout)["checks"] if check["needed_to_fly"] and not check["ok"]]
        self.assertIn("simulator", lacking)

    def test_a_gate_is_found_and_scored(self):
        detections = self.folder / "detections.csv"
        found = self.run_it("detect", self.flight() / "img_00016.jpg", "--rotate", "90", "--csv", detections)
        self.assertEqual(found.returncode, 0, found.stderr)
        with detections.open(encoding="utf-8") as rows:
            gate = next(csv.DictReader(rows))
        corners = [corner + axis for corner in ("tl", "tr", "br", "bl") for axis in ("_u", "_v")]
        labels = self.file("labels.csv", f"image,{','.join(corners)}\nimg_00016.jpg,{','.join(gate[key] for key in corners)}\n")
        score = self.run_it("score", "--detections", detections, "--labels", labels, "--json")
        self.assertEqual(json.loads(score.stdout)["hits"], 1, score.stderr)

    def test_keys_of_the_simulator_are_still_checked(self):
        self.assertEqual(self.run_it("config", "--set", "sim.size_m=[0.5, 0.5, 0.1]").returncode, 0)
        self.assertIn("sim.sonar_max_m", self.refused("config", "--set", "sim.sonar_max_m=100"))
        self.assertIn("'gate_position_m'", self.refused("config", "--set", "randomize.gate_positon_m=1"))


if __name__ == "__main__":
    main()
