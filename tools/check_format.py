#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when a C++ file is not as clang-format 14 writes it; other versions write differently.
Exit code 77, skipped: no clang-format 14 here.

usage: check_format.py [ROOT]"""
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys

FOLDERS = ("src", "c", "apps", "tests", "tools", "python")
SKIPPED = 77


def formatter():
    """The program, or None."""
    for name in ("clang-format-14", "clang-format"):
        path = shutil.which(name)
        if path and re.search(r"version 14\.", subprocess.run([path, "--version"], capture_output=True, text=True).stdout):
            return path
    return None


def main(root):
    program = formatter()
    if not program:
        print("format: skipped, no clang-format 14 here (apt-get install clang-format-14)")
        return SKIPPED
    files = sorted(str(path.relative_to(root)) for folder in FOLDERS for path in (root / folder).rglob("*.[ch]pp"))
    cores = os.cpu_count() or 1
    with concurrent.futures.ThreadPoolExecutor(cores) as pool:
        runs = pool.map(lambda i: subprocess.run([program, "--dry-run", "-Werror", *files[i::cores]], cwd=root,
                                                 capture_output=True, text=True), range(cores))
        said = "".join(run.stderr for run in runs if run.returncode)
    if not said:
        print(f"format: ok, {len(files)} files")
        return 0
    wrong = sorted(set(re.findall(r"^(\S+?):\d+:\d+: error", said, re.M)))
    print(f"format: run {os.path.basename(program)} -i {' '.join(wrong)}" if wrong else said)
    return 1


if __name__ == "__main__":
    here = pathlib.Path(__file__).resolve().parent.parent
    sys.exit(main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here))
