#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Both ends of TS-002, the AI Grand Prix's virtual qualifier: gatefly link-sim as its simulator, gatefly run as its pilot, MAVLink 2 and slices of JPEG over UDP between
them; in real time.

usage: ts002_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import signal
import socket
import struct
import sys
import time

from program import GATEFLY, ROOT, main
from drone import Beside
from simulated import flown_and_landed, free_ports

sys.path.insert(0, str(ROOT / "tools"))
from ts002_conformance import CLOCK, HEARTBEAT, IMU, MESSAGES, frame_of  # noqa: E402

DRONE = ROOT / "tests" / "live" / "ts002.toml"
TOOL = ROOT / "tools" / "ts002_conformance.py"
CONFIGS = ["--config", "archer-b2", "--config", "grandprix", "--config", "ts002"]


class Ts002(Beside):
    def setUp(self):
        super().setUp()
        self.line, self.pictures = free_ports(2, socket.SOCK_DGRAM)

    def world(self, *more):
        return self.start(GATEFLY, "link-sim", "oval", "--laps", "1", "--seed", "1001", *CONFIGS, "--autopilot", "ts-002", "--set", "sim.camera_quality=fast", "--json",
                          "--time-limit", "60", "--mavlink", self.line, "--pictures", self.pictures, *more)

    def pilot(self, *more):
        return self.start(GATEFLY, "run", "oval", "--laps", "1", *CONFIGS, "--drone", DRONE, "--camera", f"udp-jpeg:{self.pictures}", "--link",
                          f"mavlink:udpin:127.0.0.1:{self.line}", *more)

    def test_a_lap_is_flown_in_both_rounds_over_a_network_that_loses_and_swaps(self):
        for more in ([], ["--second-round"]):
            with self.subTest(more):
                world, pilot = self.world("--loss", "0.005", "--reorder", "0.02", *more), self.pilot("--json")
                flown_and_landed(self, world, pilot)

    def test_the_simulator_keeps_the_rules(self):
        self.world()
        looked = self.start(sys.executable, TOOL, "simulator", "--port", self.line, "--pictures", self.pictures, "--seconds", "5")
        said, _ = looked.communicate(timeout=60)
        self.assertEqual(looked.returncode, 0, said)

    def test_the_pilot_keeps_the_rules_and_goes_when_it_is_told_to(self):
        pilot = self.pilot()
        looked = self.start(sys.executable, TOOL, "pilot", "--port", self.line, "--seconds", "5")
        said, _ = looked.communicate(timeout=60)
        self.assertEqual(looked.returncode, 0, said)
        pilot.send_signal(signal.SIGINT)
        pilot.communicate(timeout=20)
        self.assertEqual(pilot.returncode, 130)

    def test_a_real_autopilot_or_a_drone_that_is_armed_is_refused(self):
        for autopilot, mode, why in ((3, 0, "is an ArduPilot, a real drone's autopilot"), (12, 0, "is a PX4, a real drone's autopilot"), (0, 128, "the drone is armed")):
            with self.subTest(why):
                pilot, end = self.pilot(), time.monotonic() + 20
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as calls:
                    while pilot.poll() is None and time.monotonic() < end:
                        for message, values in ((HEARTBEAT, (0, 2, autopilot, mode, 3, 3)), (IMU, (int(1e6 * time.monotonic()), 0, 0, -9.8, *[0.0] * 10, 63)), (CLOCK, (1, 1))):
                            calls.sendto(frame_of(message, struct.pack(MESSAGES[message][0], *values)), ("127.0.0.1", self.line))
                        time.sleep(0.02)
                _, said = pilot.communicate(timeout=20)
                self.assertEqual(pilot.returncode, 2, said)
                self.assertIn(why, said)


if __name__ == "__main__":
    main()
