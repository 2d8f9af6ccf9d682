#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run flies PX4 itself, its simulator, behind gatefly link-sim; in real time, two cores to itself, and the ports that are PX4's own.
Skipped without GATEFLY_PX4, the folder in which tools/autopilots.sh --px4 has built it.

usage: px4_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import os
import tempfile
import unittest

from drone import FAKE
from program import GATEFLY, ROOT, main
from simulated import Px4, flies_a_lap

PX4 = os.environ.get("GATEFLY_PX4", "")


@unittest.skipUnless(PX4, "GATEFLY_PX4 is not set: tools/autopilots.sh --px4 builds it")
class RealPx4(unittest.TestCase):
    def test_it_flies_a_lap(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        drone = Px4(GATEFLY, ROOT, folder.name, PX4, FAKE, camera="grandprix")
        self.addCleanup(drone.end)
        file, _ = drone.benched(1001)
        flies_a_lap(self, drone, file)


if __name__ == "__main__":
    main()
