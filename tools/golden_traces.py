#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints one hash for each race and each set of pictures: what a change that only moves code must leave equal to the bit.

    tools/golden_traces.py build/release > before.txt
    ...                                        # move, build
    tools/golden_traces.py build/release > after.txt && diff before.txt after.txt

100 races with ideal vision (20 seeds of five set-ups, the paper's configuration among them), four rendered ones, the detections of
the four sets of real pictures where ../shared/data has them. Of a race everything in its log counts: sensors, estimate, commands,
rotor speeds, phase. 75 s on two cores; --quick: ten ideal races, none rendered.
"""
import concurrent.futures
import csv
import gzip
import hashlib
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
IDEAL = [("oval", []), ("showroom", []), ("exhibition", []), ("showroom-li18", ["--config", "li18"]),
         ("showroom", ["--set", "randomize.wind_mps=0.3", "--set", "randomize.gust_mps=0.3"])]
RENDERED = [("oval", []), ("showroom", []), ("lanes", []), ("showroom-li18", ["--config", "li18"])]
SETS = {"cyberzoo": "cyberzoo", "basement32_hq": "basement", "basement580": "basement", "distance51": "cyberzoo"}
SEEDS = range(1801, 1821)


def fail(message):
    print(message, file=sys.stderr)
    sys.exit(2)


def sha(content):
    return hashlib.sha256(content).hexdigest()[:16]


def log_of(flight):
    packed = flight / "log_si.csv.gz"  # a rendered flight's
    return gzip.decompress(packed.read_bytes()) if packed.exists() else (flight / "log_si.csv").read_bytes()


def run(command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: not finished, nothing found
        fail(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stderr}")


def race(programs, kind, track, options, seed):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "flight"
        run([programs / "gatefly", "fly", track, "--vision", kind, "--seed", str(seed), "--out", out, "--quiet", *options])
        return f"{sha(log_of(out))}  {' '.join([kind, track, *options])} seed {seed}"


def detections(programs, name, config):
    data = pathlib.Path(os.environ.get("GATEFLY_DATA", ROOT.parent / "shared" / "data"))
    pictures = data / "tudelft_bebop_gates" / name
    if not pictures.is_dir():
        return f"{'skipped':16}  detections {name}: {pictures} is absent"
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "found.csv"
        run([programs / "gatefly-tools", "detect", pictures, "--all", "--config", config, "--csv", out, "--quiet"])
        rows = sum(1 for _ in csv.reader(out.read_text().splitlines())) - 1
        return f"{sha(out.read_bytes())}  detections {name}, {rows} rows"


def main():
    arguments = [a for a in sys.argv[1:] if a != "--quick"]
    if len(arguments) != 1 or arguments[0].startswith("-"):
        fail(__doc__)
    quick = "--quick" in sys.argv
    programs = pathlib.Path(arguments[0]).resolve() / "apps" / "gatefly"
    if not (programs / "gatefly").is_file():
        fail(f"golden_traces.py: {programs / 'gatefly'} is absent")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        lines = [pool.submit(detections, programs, *entry) for entry in SETS.items()]
        for track, options in IDEAL:
            lines += [pool.submit(race, programs, "ideal", track, options, seed) for seed in list(SEEDS)[:2 if quick else None]]
        if not quick:
            lines += [pool.submit(race, programs, "rendered", track, options, SEEDS[0]) for track, options in RENDERED]
        for line in lines:
            print(line.result(), flush=True)


if __name__ == "__main__":
    main()
