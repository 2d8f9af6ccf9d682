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
# A first flight may cost so many compilations of REFERENCE, made two at a time, as the build works: a core whose neighbour is busy
# is slower. Wanted are at most 330 s of CPU where a reference costs 5.22 s; there 290-334 s in four runs, 59.8 references in one.
MOST = 330 / 5.22
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


def reference_seconds(folder):
    """CPU seconds of one compilation of REFERENCE while another runs beside it."""
    compile_it = f"{CXX} -std=c++20 -O2 -isystem /usr/include/eigen3 -c reference.cpp -o"
    done, cpu, _ = cpu_seconds("sh", "-c", f"{compile_it} one.o & one=$!; {compile_it} two.o && wait $one", cwd=folder)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return cpu / 2


class FirstFlight(unittest.TestCase):
    def test_it_stays_within_its_budget(self):
        with tempfile.TemporaryDirectory(prefix="gatefly-first-") as name:
            folder = pathlib.Path(name)
            (folder / "reference.cpp").write_text(REFERENCE)
            references = [reference_seconds(folder) for _ in range(2)]
            subprocess.run(["git", "clone", "-q", str(ROOT), "clone"], cwd=folder, check=True)
            env = {key: value for key, value in os.environ.items() if not key.startswith(("CMAKE_", "CXX", "CCACHE_"))}
            env["XDG_CACHE_HOME"] = str(folder / "cache")
            done, cpu, wall = cpu_seconds("./gatefly", "fly", cwd=folder / "clone", env=env)
            self.assertIn(done.returncode, (0, 1), done.stderr[-2000:])
            self.assertIn("showroom, seed 1:", done.stdout)
            reference = sorted([*references, reference_seconds(folder)])[1]
            print(f"first flight: {cpu:.0f} s of CPU, {wall:.0f} s by the clock; reference {reference:.2f} s of CPU; "
                  f"ratio {cpu / reference:.1f} of {MOST:.1f}")
            self.assertLess(cpu / reference, MOST)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
