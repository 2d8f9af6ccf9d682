#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run flies PX4 itself, its simulator, behind gatefly link-sim; in real time, two cores to itself, and the ports that are PX4's own.
Skipped without GATEFLY_PX4, the folder in which tools/autopilots.sh --px4 has built it.

usage: px4_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import unittest

from drone import FAKE, Beside
from program import GATEFLY, ROOT, main
from simulated import Px4, ended

PX4 = os.environ.get("GATEFLY_PX4", "")


@unittest.skipUnless(PX4, "GATEFLY_PX4 is not set: tools/autopilots.sh --px4 builds it")
class RealPx4(Beside):
    def setUp(self):
        super().setUp()
        self.drone = Px4(GATEFLY, ROOT, self.folder, PX4, FAKE, camera="grandprix")
        self.addCleanup(self.drone.end)

    def flown(self, *more):
        """@return link-sim's outcome, run's, and all that was said."""
        file, _ = self.drone.benched(1001)
        world = self.drone.world("--laps", "1", "--seed", "1001", "--json", "--time-limit", "60", *more)
        self.addCleanup(ended, world)
        pilot = self.drone.run("--laps", "1", "--drone", file, "--json")
        self.addCleanup(ended, pilot)
        outcome = json.loads(world.communicate(timeout=120)[0])
        told, said = pilot.communicate(timeout=60)
        return outcome, json.loads(told), f"{outcome}\n{self.drone.heard()}\n{said}\n{(self.folder / 'px4.txt').read_text(encoding='utf-8')}"

    def test_it_is_handed_over_takes_off_and_passes_the_first_gate(self):
        outcome, own, everything = self.flown()
        self.assertGreaterEqual(outcome["gates_passed"], 1, everything)
        self.assertLess(own["sticks"]["longest_gap_ms"], 50, everything)


if __name__ == "__main__":
    main()
