#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions of each call of a detector, counted by callgrind (valgrind): the same at any load.

usage: count_instructions.py STAGE PICTURE...   e.g. count_instructions.py careful out/frames/frame_00100.uyvy checker:8:0.5
Pictures, folders and patterns as for `gatefly bench --pictures`. Prints instructions and name, most first, and the median."""
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

# The program that has `bench` itself: valgrind does not follow gatefly into it.
GATEFLY = pathlib.Path(__file__).resolve().parent.parent / "build/release/apps/gatefly/gatefly-studies"


def counted(stage, pictures):
    """[(instructions, picture)], a folder giving one for each of its files."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "calls"
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", "--collect-atstart=no", "--toggle-collect=gatefly_bench_call",
             "--dump-after=gatefly_bench_call", f"--callgrind-out-file={out}", str(GATEFLY), "bench", "--once",
             "--stage", stage, "--pictures", *pictures], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            sys.exit(run.stderr)
        totals = [re.search(r"^(?:totals|summary): (\d+)", pathlib.Path(f"{out}.{number}").read_text(), re.M)
                  for number in range(1, len(run.stdout.splitlines()) + 1)]
        return [(int(total[1]), name) for total, name in zip(totals, run.stdout.splitlines())]


def main():
    if len(sys.argv) < 3 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    calls = counted(sys.argv[1], sys.argv[2:])
    for count, name in sorted(calls, reverse=True):
        print(f"{count:12,d}  {name}")
    print(f"{statistics.median(count for count, _ in calls):12,.0f}  median of {len(calls)}")


main()
