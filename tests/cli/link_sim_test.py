#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run flies a simulated drone over the link that a real one has: rendered pictures as slices of JPEG, MSP at 115,200 baud, a
controller that behaves like Betaflight 4.4.3 (tests/support/fake_betaflight_sitl.cpp), and a safety pilot; in real time.

usage: link_sim_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import socket
import time

from drone import FAKE, Beside, free_ports, signed
from program import GATEFLY, ROOT, main

FAKE_SITL = FAKE + "_sitl"
FAKE_ARDU_SITL = os.environ.get("GATEFLY_FAKE_ARDUCOPTER", "") + "_sitl"
ARDU = ROOT / "tests" / "live" / "fake_arducopter_sitl.toml"
DRONE = ROOT / "tests" / "live" / "fake_sitl_drone.toml"


class OverTheLink(Beside):
    def test_a_lap_of_the_oval_is_flown_and_the_drone_lands(self):
        servos, state, radio, pictures = free_ports(4, socket.SOCK_DGRAM)
        controller, msp = free_ports(2, socket.SOCK_STREAM)
        fake = self.start(FAKE_SITL, "--servos", servos, "--state", state, "--radio", radio, "--msp", controller)
        self.assertIn("port", fake.stdout.readline())
        drone = ["--config", "archer-b2", "--config", "betaflight"]
        world = self.start(GATEFLY, "link-sim", "oval", "--laps", "1", "--seed", "1001", *drone, "--set", "sim.camera_quality=fast", "--json", "--time-limit", "60",
                           "--servos", servos, "--state", state, "--radio", radio, "--controller", controller, "--msp", msp, "--pictures", pictures, "--log", "truth.csv")
        self.assertIn("ready", world.stderr.readline())
        pilot = self.start(GATEFLY, "run", "oval", "--laps", "1", *drone, "--camera", f"udp-jpeg:{pictures}", "--link", f"msp:tcp:127.0.0.1:{msp}", "--drone",
                           signed(self, DRONE.read_text(encoding="utf-8")), "--out", "flight", "--json")
        told, heard = world.communicate(timeout=120)
        outcome = json.loads(told)
        told, said = pilot.communicate(timeout=20)
        flown = json.loads(told)
        everything = f"{outcome}\n{heard}\n{said}"
        self.assertTrue(outcome["finished"], everything)
        self.assertTrue(outcome["landed"], everything)
        self.assertEqual((world.returncode, pilot.returncode), (0, 0), everything)
        self.assertGreater(outcome["mean_speed_mps"], 1.2)
        self.assertEqual(flown["mode"], "flown")
        self.assertEqual(flown["gates_passed"], outcome["gates_passed"])
        self.assertLess(flown["sticks"]["longest_gap_ms"], 50)
        self.assertTrue((self.folder / "truth.csv").read_text(encoding="utf-8").startswith("t_s,armed,override,x_m"))
        # What was recorded flies again: the pilot's answers follow from its sensors alone.
        done = self.run_it("replay", "flight")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_an_arducopter_flies_a_lap_and_lands_too(self):
        servos, radio, pictures = free_ports(3, socket.SOCK_DGRAM)
        controller, line = free_ports(2, socket.SOCK_STREAM)
        fake = self.start(FAKE_ARDU_SITL, "--servos", servos, "--radio", radio, "--port", controller, "--hover", "0.166")
        self.assertIn("port", fake.stdout.readline())
        drone = ["--config", "archer-b2", "--config", "arducopter"]
        world = self.start(GATEFLY, "link-sim", "oval", "--laps", "1", "--seed", "1001", *drone, "--autopilot", "arducopter", "--set", "sim.camera_quality=fast", "--json",
                           "--time-limit", "60", "--servos", servos, "--radio", radio, "--controller", controller, "--msp", line, "--pictures", pictures)
        self.assertIn("ready", world.stderr.readline())
        pilot = self.start(GATEFLY, "run", "oval", "--laps", "1", *drone, "--camera", f"udp-jpeg:{pictures}", "--link", f"mavlink:tcp:127.0.0.1:{line}", "--drone",
                           signed(self, ARDU.read_text(encoding="utf-8")), "--json")
        told, heard = world.communicate(timeout=120)
        outcome = json.loads(told)
        told, said = pilot.communicate(timeout=20)
        flown = json.loads(told)
        everything = f"{outcome}\n{heard}\n{said}"
        self.assertTrue(outcome["finished"] and outcome["landed"], everything)
        self.assertEqual(flown["gates_passed"], outcome["gates_passed"])
        self.assertLess(flown["sticks"]["longest_gap_ms"], 50)

    def test_without_a_controller_it_says_so(self):
        servos, state, radio, pictures = free_ports(4, socket.SOCK_DGRAM)
        begin = time.monotonic()
        world = self.start(GATEFLY, "link-sim", "oval", "--set", "sim.camera_quality=fast", "--servos", servos, "--state", state, "--radio", radio, "--pictures", pictures)
        _, said = world.communicate(timeout=60)
        self.assertEqual(world.returncode, 2)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn(f"no flight controller tells motors at udp 127.0.0.1:{servos}", said)
        self.assertLess(time.monotonic() - begin, 40)


if __name__ == "__main__":
    main()
