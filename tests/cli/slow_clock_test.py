#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The slow clock of tests/support/slow_clock.cpp: programs count less time than passes, and wait longer, by the same factor.

usage: slow_clock_test.py LIBSLOW_CLOCK
"""
import os
import subprocess
import sys
import time
import unittest

LIBRARY = sys.argv.pop(1)

# Each way to wait for 0.2 s: by how much the monotonic clock has gone on, and the day's.
WAITS = """
import select, time
def measured(wait):
    counted, passed = time.monotonic(), time.time()
    wait()
    return time.monotonic() - counted, time.time() - passed
nothing = select.poll()
for wait in (lambda: time.sleep(0.2), lambda: nothing.poll(200), lambda: select.select([], [], [], 0.2)):
    print(*measured(wait))
"""


class SlowClock(unittest.TestCase):
    def waited(self, pace):
        done = subprocess.run([sys.executable, "-c", WAITS], env=dict(os.environ, LD_PRELOAD=LIBRARY, SLOW_CLOCK=pace), capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")  # the loader only warns where it finds no library
        return [[float(word) for word in line.split()] for line in done.stdout.splitlines()]

    def test_that_a_program_counts_half_of_the_time_that_it_waits(self):
        for counted, passed in self.waited("0.5"):
            self.assertGreater(counted, 0.19)
            self.assertGreater(passed, 0.38)
            self.assertAlmostEqual(passed / counted, 2.0, delta=0.05, msg=f"{counted} {passed}")

    def test_that_a_pace_which_is_none_changes_nothing(self):
        for pace in ("", "0", "-1", "7", "word", "1e-6"):
            waits = self.waited(pace) + self.waited(pace)  # a busy machine may stretch some of them
            for counted, passed in waits:
                self.assertGreater(counted, 0.19)
                self.assertAlmostEqual(passed / counted, 1.0, delta=0.05, msg=f"{pace}: {counted} {passed}")
            self.assertLess(min(passed for _, passed in waits), 0.3, pace)

    def test_that_the_programs_it_starts_have_it_too(self):
        begin = time.monotonic()
        subprocess.run(["env", f"LD_PRELOAD={LIBRARY}", "SLOW_CLOCK=0.25", "sh", "-c", "exec sleep 0.1"], check=True)
        self.assertGreater(time.monotonic() - begin, 0.39)


if __name__ == "__main__":
    unittest.main()
