#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run flies ArduCopter itself, its simulator with the JSON interface, behind gatefly link-sim; in real time, two cores to itself.
Skipped without GATEFLY_ARDUCOPTER, which tools/autopilots.sh --arducopter builds.

usage: arducopter_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import os
import tempfile
import unittest

from program import GATEFLY, ROOT, main
from simulated import ArduCopter, flies_a_lap

ARDUCOPTER = os.environ.get("GATEFLY_ARDUCOPTER", "")


@unittest.skipUnless(ARDUCOPTER, "GATEFLY_ARDUCOPTER is not set: tools/autopilots.sh --arducopter builds it")
class RealArduCopter(unittest.TestCase):
    def test_it_passes_at_the_bench_and_in_the_hand_over_test_and_flies_a_lap(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        drone = ArduCopter(GATEFLY, ROOT, folder.name, ARDUCOPTER, camera="grandprix")
        self.addCleanup(drone.end)
        file, said = drone.benched(7)
        for line in ("roll, pitch, yaw and throttle as sent", "the controller lets go of the last set point after", "the hand-over test has passed"):
            self.assertIn(line, said)
        flies_a_lap(self, drone, file)


if __name__ == "__main__":
    main()
