#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/ts002_conformance.py: its two ends keep each other's rules, and what is not kept is named.

usage: ts002_conformance_test.py REPOSITORY_ROOT
"""
import pathlib
import socket
import subprocess
import sys
import unittest

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "tools"))
sys.path.insert(0, str(ROOT / "tests" / "cli"))
from simulated import free_ports  # noqa: E402
from ts002_conformance import frame_of, frames_in  # noqa: E402


class Conformance(unittest.TestCase):
    def test_frames_are_those_that_node_mavlink_writes(self):
        golden = (ROOT / "tests" / "link" / "data" / "mavlink_golden.txt").read_text(encoding="utf-8")
        known = 0
        for line in golden.splitlines():
            for word in line.split():
                if not word.startswith("fd") or len(word) % 2:
                    continue
                data = bytes.fromhex(word)
                message = int.from_bytes(data[7:10], "little")
                if message not in (0, 30, 82, 105, 111) or data[1] == 0:  # of nothing but zeros some send none
                    continue
                known += 1
                self.assertEqual(next(frames_in(data))[0], message)
                self.assertEqual(frame_of(message, data[10:10 + data[1]], data[5], data[6], data[4]), data)
        self.assertGreaterEqual(known, 5)

    def test_its_ends_keep_each_others_rules_but_there_are_no_pictures(self):
        port, pictures = free_ports(2, socket.SOCK_DGRAM)
        tool = [sys.executable, str(ROOT / "tools" / "ts002_conformance.py")]
        with subprocess.Popen([*tool, "simulator", "--port", str(port), "--pictures", str(pictures), "--seconds", "3"], stdout=subprocess.PIPE, text=True) as at_simulator:
            at_pilot = subprocess.run([*tool, "pilot", "--port", str(port), "--seconds", "3"], capture_output=True, text=True, timeout=30, check=False)
            said, _ = at_simulator.communicate(timeout=30)
        self.assertEqual(at_pilot.returncode, 0, at_pilot.stdout + at_pilot.stderr)
        self.assertEqual(at_simulator.returncode, 1)
        wrong = [line for line in said.splitlines() if line.startswith("WRONG")]
        self.assertTrue(wrong and all("pictures:" in line for line in wrong), said)

    def test_nobody_there_is_a_line(self):
        port, pictures = free_ports(2, socket.SOCK_DGRAM)
        done = subprocess.run([sys.executable, str(ROOT / "tools" / "ts002_conformance.py"), "simulator", "--port", str(port), "--pictures", str(pictures)],
                              capture_output=True, text=True, timeout=30, check=False)
        self.assertEqual((done.returncode, done.stderr), (2, f"nobody calls at udp 127.0.0.1:{port}\n"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
