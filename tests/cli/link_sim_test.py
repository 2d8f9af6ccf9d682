#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run flies a simulated drone over the link that a real one has: rendered pictures as slices of JPEG, MSP at 115,200 baud, a
controller that behaves like Betaflight 4.4.3 (tests/support/fake_betaflight_sitl.cpp), and a safety pilot; in real time. Its drone.toml is
bench-drone's own, from the same drone in a simulated hand.

usage: link_sim_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import signal
import socket
import time

from drone import FAKE, signed
from program import GATEFLY, ROOT, Cli, main
from simulated import Simulated, ended, flown_and_landed, free_ports

FAKE_SITL = FAKE + "_sitl"
FAKE_ARDU_SITL = os.environ.get("GATEFLY_FAKE_ARDUCOPTER", "") + "_sitl"
ARDU = ROOT / "tests" / "live" / "fake_arducopter_sitl.toml"
DRONE = ROOT / "tests" / "live" / "fake_sitl_drone.toml"


class OverTheLink(Cli):
    def setUp(self):
        super().setUp()
        self.drone = Simulated(GATEFLY, ROOT, self.folder, fake=FAKE_SITL)
        self.addCleanup(ended, self.drone.controller)

    def start(self, *words):
        process = self.drone.start(*words)
        self.addCleanup(ended, process)
        return process

    def lap(self, drone):
        """A lap of the oval, from arming to landing, and all that was said."""
        world = self.drone.world("--laps", "1", "--seed", "1001", "--json", "--time-limit", "60", "--log", "truth.csv")
        self.addCleanup(ended, world)
        pilot = self.drone.run("--laps", "1", "--drone", drone, "--out", "flight", "--json")
        self.addCleanup(ended, pilot)
        outcome = json.loads(world.communicate(timeout=120)[0])
        told, said = pilot.communicate(timeout=20)
        everything = f"{outcome}\n{self.drone.heard()}\n{said}"
        self.assertTrue(outcome["finished"], everything)
        self.assertTrue(outcome["landed"], everything)
        self.assertEqual((world.returncode, pilot.returncode), (0, 0), everything)
        return outcome, json.loads(told)

    def test_a_lap_of_the_oval_is_flown_and_the_drone_lands(self):
        outcome, flown = self.lap(signed(self, DRONE.read_text(encoding="utf-8")))
        self.assertGreater(outcome["mean_speed_mps"], 1.2)
        self.assertEqual(flown["mode"], "flown")
        self.assertEqual(flown["gates_passed"], outcome["gates_passed"])
        self.assertLess(flown["sticks"]["longest_gap_ms"], 50)
        self.assertTrue((self.folder / "truth.csv").read_text(encoding="utf-8").startswith("t_s,armed,override,x_m"))
        # A recorded flight flies again: the pilot's answers follow from its sensors alone.
        done = self.run_it("replay", "flight")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_from_the_bench_to_a_lap_by_our_own_means(self):
        drone, said = self.drone.benched(1001)
        for line in ("512 counts are 1 g", "gyro about front (roll): agrees", "gyro about down (yaw): agrees", "program killed (-9)", "the hand-over test has passed"):
            self.assertIn(line, said)
        self.assertNotIn("WRONG", said)
        self.lap(drone)

    def test_a_drone_that_nobody_has_calibrated_is_found_out(self):
        world = self.drone.world("--seed", "1001", "--bench", "asks.txt")
        code, said = self.drone.bench("asks.txt", "--name", "simulated", *self.drone.told, "--least-v", "0")
        self.assertEqual(code, 1, said)
        self.assertIn("accelerometer: 473 counts at rest, no scale that is known: calibrate it", said)
        self.assertFalse((self.folder / "drone.toml").exists())
        world.send_signal(signal.SIGINT)
        world.wait(timeout=20)
        self.assertEqual(world.returncode, 130)
        ended(world)

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
        flown_and_landed(self, world, pilot)

    def test_without_a_controller_it_says_so(self):
        ended(self.drone.controller)
        servos = self.drone.ports["servos"]
        for more in ([], ["--bench", "asks.txt"]):
            with self.subTest(more):
                begin = time.monotonic()
                with self.assertRaises(RuntimeError) as said:
                    self.drone.world(*more)
                self.assertIn(f"no flight controller tells motors at udp 127.0.0.1:{servos}", str(said.exception))
                self.assertLess(time.monotonic() - begin, 40)


if __name__ == "__main__":
    main()
