#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy 14 with the checks of .clang-tidy over the flight code; fails when it finds something.
A source is looked at again only when it, a header of ours that it includes, or .clang-tidy has changed.
Exit code 77, skipped: no clang-tidy 14 here.

usage: check_tidy.py [SOURCE...]    default: all of the flight code"""
import concurrent.futures
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLIGHT = ("geometry", "sensing", "detection", "pose", "estimation", "control", "race", "link", "guard")
DONE = ROOT / "build" / "tidy"
# The flight code needs Eigen only, so no build has to be there.
EIGEN = next((path for path in ("/usr/include/eigen3", "/usr/local/include/eigen3") if os.path.isdir(path)), "/usr/include/eigen3")
FLAGS = ["-std=c++20", "-ffp-contract=off", f"-I{ROOT / 'src' / 'flight'}", "-isystem", EIGEN]
OURS = re.compile(r'^\s*#\s*include\s+"(gatefly/[^"]+)"', re.M)
SKIPPED = 77


def linter():
    """The program and its version, or None."""
    for name in ("clang-tidy-14", "clang-tidy"):
        path = shutil.which(name)
        version = subprocess.run([path, "--version"], capture_output=True, text=True).stdout if path else ""
        if "version 14." in version:
            return path, version
    return None


def with_headers(source, seen):
    """`source` and all of ours that it includes."""
    if source not in seen and source.exists():
        seen.add(source)
        for name in OURS.findall(source.read_text()):
            with_headers(ROOT / "src" / "flight" / name, seen)
    return seen


def key(source, version):
    text = version + " ".join(FLAGS) + (ROOT / ".clang-tidy").read_text()
    return hashlib.sha256("\0".join([text, *(path.read_text() for path in sorted(with_headers(source, set())))]).encode()).hexdigest()


def findings(program, version, source):
    """What there is to say about a source, or ""."""
    stamp, now = DONE / source.relative_to(ROOT).as_posix().replace("/", "_"), key(source, version)
    if stamp.exists() and stamp.read_text() == now:
        return ""
    run = subprocess.run([program, "--quiet", str(source), "--", *FLAGS], cwd=ROOT, capture_output=True, text=True)
    if run.returncode == 0:
        stamp.write_text(now)
        return ""
    return run.stdout or run.stderr or f"{source}: {program} ended with {run.returncode}"


def main(*names):
    found = linter()
    if not found:
        print("tidy: skipped, no clang-tidy 14 here (apt-get install clang-tidy-14)")
        return SKIPPED
    sources = [pathlib.Path(name).resolve() for name in names] or sorted(
        path for folder in FLIGHT for path in (ROOT / "src" / "flight" / "gatefly" / folder).rglob("*.cpp"))
    DONE.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        said = [text for text in pool.map(lambda source: findings(*found, source), sources) if text]
    print("\n".join(said) or f"tidy: ok, {len(sources)} sources")
    return bool(said)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
