#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly run, killed in flight by a signal that nobody can catch.

usage: run_killed_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import time

from drone import PERIOD, Handed
from program import main


class KilledInFlight(Handed):
    def test_the_second_process_brings_it_down_and_lets_go_when_it_is_disarmed(self):
        process = self.flying()
        self.fake("mark")
        process.kill()
        self.assert_brought_down(self.down())
        self.assertLess(self.longest_gap(), 3.0 * PERIOD)
        self.fake("disarm")
        time.sleep(0.3)
        frames = len(self.fake.rows("frame"))
        time.sleep(0.2)
        self.assertEqual(len(self.fake.rows("frame")), frames, "it still sends")


if __name__ == "__main__":
    main()
