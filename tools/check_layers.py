#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when a file includes a folder that its own CMakeLists.txt does not list in DEPENDS, when flight
code includes anything but Eigen and the standard library, when the simulator knows the pilot, or when somebody passes
the detector's door (detection/*.hpp) and includes one of its stages."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
SOURCE = ROOT / "src" / "gatefly"
OURS = re.compile(r'\s*#\s*include\s+"gatefly/(\w+)/')
SYSTEM = re.compile(r"\s*#\s*include\s+<([^>]+)>")
QUOTED = re.compile(r'\s*#\s*include\s+"([^"]+)"')
DEPENDS = re.compile(r"gatefly::(\w+)")
FLIGHT = {"geometry", "sensing", "detection", "pose", "estimation", "control", "race"}
# The folders that talk to an autopilot obey the same rules, and no flight code knows them.
TO_AUTOPILOTS = {"link", "guard"}
LEAN = FLIGHT | TO_AUTOPILOTS
PILOT_SIDE = {"detection", "pose", "estimation", "control", "race", "closed_loop", "flight_log", "config", "report",
              "tasks", "simulated_race"}
FORBIDDEN = {"sim": PILOT_SIDE, "autopilot": PILOT_SIDE, "world": PILOT_SIDE | {"sim"}}
# Stages of the detector, and who may include them: those who test or time them, or compare with the paper's detector.
STAGE = re.compile(r'\s*#\s*include\s+"gatefly/detection/\w+/')
STAGES_FOR = ("src/gatefly/detection", "src/gatefly/bench", "src/gatefly/experiments", "src/gatefly/tasks/search_report",
              "src/gatefly/drawing/search_sheet", "tests/detection", "tests/support")
# What is measured is what flies: experiments take the Navigator, and wire no filter of their own.
RING = re.compile(r"\b(Ahrs|LowPass|DragFilter|DelayedFilter|VelocityObserver|Altimeter)\s*(\w+\s*)?[{(]")
# Clocks, files, threads and hidden randomness have no place in the flight code; <chrono> is for durations.
HIDDEN = re.compile(r"system_clock|steady_clock|std::rand\b|(^|[;{)])\s*throw\b(?! std::invalid_argument)")
BANNED = {"random", "thread", "mutex", "fstream", "iostream", "ctime", "cstdio", "filesystem"}


def violations():
    for cmake in sorted(SOURCE.glob("*/CMakeLists.txt")):
        folder = cmake.parent.name
        allowed = set(DEPENDS.findall(cmake.read_text())) | {folder}
        below = LEAN if folder in TO_AUTOPILOTS else FLIGHT
        if folder in LEAN and not allowed <= below:
            yield f"{cmake}: flight code may not depend on {sorted(allowed - below)}"
        if allowed & FORBIDDEN.get(folder, set()):
            yield f"{cmake}: {folder} may not depend on {sorted(allowed & FORBIDDEN[folder])}"
        for source in sorted(cmake.parent.rglob("*.[ch]pp")):
            for number, line in enumerate(source.read_text().splitlines(), 1):
                where = f"{source}:{number}"
                ours, system, quoted = OURS.match(line), SYSTEM.match(line), QUOTED.match(line)
                if ours and ours[1] not in allowed:
                    yield f"{where}: {folder} may not include {ours[1]}"
                if quoted and not ours:
                    yield f'{where}: includes are written "gatefly/<folder>/<file>.hpp"'
                if folder in LEAN and system:
                    if "/" in system[1] and not system[1].startswith("Eigen/"):
                        yield f"{where}: flight code includes <{system[1]}>; Eigen only"
                    if system[1].endswith(".h") or system[1] in BANNED:
                        yield f"{where}: flight code includes <{system[1]}>"
                if folder == "experiments" and RING.search(line):
                    yield f"{where}: experiments use estimation/navigator.hpp"
                if folder in LEAN and HIDDEN.search(line):
                    yield f"{where}: no clock, no hidden randomness, nothing thrown but std::invalid_argument"


def passed_doors():
    for source in sorted(path for folder in ("src", "apps", "python", "tests") for path in (ROOT / folder).rglob("*.[ch]pp")):
        if source.relative_to(ROOT).as_posix().startswith(STAGES_FOR):
            continue
        for number, line in enumerate(source.read_text().splitlines(), 1):
            if STAGE.match(line):
                yield f"{source}:{number}: only gatefly/detection/*.hpp is for others, not its folders"


def parts_with_pilot():
    """The pilot's parts are tested, and can be used, without a pilot."""
    for part in ("course", "lookout", "guidance", "phase"):
        for source in (SOURCE / "race" / f"{part}.hpp", ROOT / "tests" / "race" / f"{part}_test.cpp"):
            if "race/pilot" in source.read_text():
                yield f"{source}: includes the pilot, whose part it is"


found = list(violations()) + list(passed_doors()) + list(parts_with_pilot())
print("\n".join(found) or "layers: ok")
sys.exit(bool(found))
