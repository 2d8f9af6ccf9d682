#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From a fresh clone to the first flight's result: what it costs, beside a compilation that never changes.

usage: first_flight_test.py REPOSITORY_ROOT CXX [unittest arguments]

Machines differ and are busy, so seconds say little: the budget is a ratio of CPU seconds within one run. The packages must be
there already. Prints both figures and the wall time."""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import unittest

ROOT, CXX = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
# A first flight may cost so many compilations of REFERENCE. On one machine of two idle cores it cost 340-358 s of CPU, 56.1-58.0
# references of 6.0-6.4 s, before the drag filter and the 15-state one compiled in two fifths of their time; wanted are 330 s.
MOST = 56.0
REFERENCE = """
#include <iostream>
#include <map>
#include <vector>
#include <Eigen/Dense>
#include <nlohmann/json.hpp>
int main(int argc, char** argv) {
  const nlohmann::json json = nlohmann::json::parse(argv[argc - 1]);
  const std::map<std::string, std::vector<double>> rows = json.at("rows");
  const Eigen::Matrix<double, 7, 7> P = Eigen::Matrix<double, 7, 7>::Identity();
  std::cout << json.dump(2) << rows.size() << (P * P.transpose() + 0.5 * P).ldlt().solve(P).trace() << '\\n';
}
"""


def cpu_seconds(*command, cwd, env=None):
    """CPU and wall seconds of a command and all that it starts."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.monotonic() - start)


class FirstFlight(unittest.TestCase):
    def test_it_stays_within_its_budget(self):
        with tempfile.TemporaryDirectory(prefix="gatefly-first-") as name:
            folder = pathlib.Path(name)
            (folder / "reference.cpp").write_text(REFERENCE)
            compile_it = (CXX, "-std=c++20", "-O2", "-isystem", "/usr/include/eigen3", "-c", "reference.cpp", "-o", "reference.o")
            references = []
            for _ in range(2):
                done, cpu, _ = cpu_seconds(*compile_it, cwd=folder)
                self.assertEqual(done.returncode, 0, done.stderr)
                references.append(cpu)
            subprocess.run(["git", "clone", "-q", str(ROOT), "clone"], cwd=folder, check=True)
            env = {key: value for key, value in os.environ.items() if not key.startswith(("CMAKE_", "CXX", "CCACHE_"))}
            env["XDG_CACHE_HOME"] = str(folder / "cache")
            done, cpu, wall = cpu_seconds("./gatefly", "fly", cwd=folder / "clone", env=env)
            self.assertIn(done.returncode, (0, 1), done.stderr[-2000:])
            self.assertIn("showroom, seed 1:", done.stdout)
            done, cpu_after, _ = cpu_seconds(*compile_it, cwd=folder)
            reference = sorted([*references, cpu_after])[1]
            print(f"first flight: {cpu:.0f} s of CPU, {wall:.0f} s by the clock; reference {reference:.2f} s of CPU; "
                  f"ratio {cpu / reference:.1f} of {MOST:g}")
            self.assertLess(cpu / reference, MOST)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
