#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run flies ArduCopter itself, its simulator with the JSON interface, behind gatefly link-sim; in real time, two cores to itself.
Skipped without GATEFLY_ARDUCOPTER, which tools/autopilots.sh --arducopter builds.

usage: arducopter_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import socket
import unittest

from drone import Beside, free_ports, signed
from program import GATEFLY, ROOT, main

ARDUCOPTER = os.environ.get("GATEFLY_ARDUCOPTER", "")
DRONE = ROOT / "tests" / "live" / "arducopter_sim.toml"
PARAMETERS = ROOT / "tests" / "live" / "arducopter.parm"


@unittest.skipUnless(ARDUCOPTER, "GATEFLY_ARDUCOPTER is not set: tools/autopilots.sh --arducopter builds it")
class RealArduCopter(Beside):
    def test_it_is_handed_over_takes_off_and_passes_the_first_gate(self):
        line, = free_ports(1, socket.SOCK_STREAM)
        pictures, = free_ports(1, socket.SOCK_DGRAM)
        drone = ["--config", "archer-b2", "--config", "arducopter"]
        world = self.start(GATEFLY, "link-sim", "oval", "--laps", "1", "--seed", "1001", *drone, "--autopilot", "arducopter", "--set", "sim.camera_quality=fast", "--json",
                           "--time-limit", "60", "--baud", "921600", "--msp", line, "--pictures", pictures)
        self.start(ARDUCOPTER, "--model", "json:127.0.0.1", "--serial0", "tcp:5760", "--defaults", PARAMETERS, "-I0", "--home", "52,4.37,0,0")
        self.assertIn("ready", world.stderr.readline())
        pilot = self.start(GATEFLY, "run", "oval", "--laps", "1", *drone, "--camera", f"udp-jpeg:{pictures}", "--link", f"mavlink:tcp:127.0.0.1:{line}", "--drone",
                           signed(self, DRONE.read_text(encoding="utf-8")), "--json")
        told, heard = world.communicate(timeout=120)
        outcome = json.loads(told)
        told, said = pilot.communicate(timeout=20)
        everything = f"{outcome}\n{heard}\n{said}"
        self.assertGreaterEqual(outcome["gates_passed"], 1, everything)
        self.assertLess(json.loads(told)["sticks"]["longest_gap_ms"], 50, everything)


if __name__ == "__main__":
    main()
