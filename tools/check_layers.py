#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when a file includes a folder that its own CMakeLists.txt does not list in DEPENDS, when a house depends on one
that comes after it, when folders depend on each other in a circle, when flight code includes anything but Eigen and the
standard library, when a namespace is not its folder's, when the simulator knows the pilot, or when somebody passes the detector's door (detection/*.hpp) and
includes one of its stages."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
# Each house may depend on itself and on those before it.
HOUSES = ("flight", "workshop", "simulator", "studies")
OURS = re.compile(r'\s*#\s*include\s+"gatefly/([\w/]+)/\w+\.hpp"')
SYSTEM = re.compile(r"\s*#\s*include\s+<([^>]+)>")
QUOTED = re.compile(r'\s*#\s*include\s+"([^"]+)"')
DEPENDS = re.compile(r"gatefly::(\w+)")
# Two folders of the flight house talk to an autopilot; they obey its rules, and none of the others knows them.
TO_AUTOPILOTS = {"link", "guard"}
PILOT_SIDE = {"detection", "pose", "estimation", "control", "race", "flight_log", "config", "drawing", "report", "tasks", "simulated_race"}
FORBIDDEN = {"sim": PILOT_SIDE, "world": PILOT_SIDE | {"sim"}}
# Stages of the detector, and who may include them: those who test or time them, or compare with the paper's detector.
STAGE = re.compile(r'\s*#\s*include\s+"gatefly/detection/\w+/')
STAGES_FOR = ("src/flight/gatefly/detection", "src/studies/gatefly/experiments",
              "src/workshop/gatefly/tasks/search_report", "src/workshop/gatefly/drawing/search_sheet", "tests/detection",
              "tests/support")
NAMESPACE = re.compile(r"^(?:inline )?namespace gatefly(?:::(\w+))?(?:::[\w:]+)? \{", re.M)
# Another folder's namespace may be opened to declare its types, and to keep a public header's old names for a release.
LENT = re.compile(r"^namespace gatefly::\w+ \{\n(?:(?:class|struct|using) [\w:]+;(?: .*)?\n)+\}.*\n", re.M)
# What is measured is what flies: experiments take the Navigator, and wire no filter of their own.
RING = re.compile(r"\b(Ahrs|LowPass|DragFilter|DelayedFilter|VelocityObserver|Altimeter)\s*(\w+\s*)?[{(]")
# Clocks, files, threads and hidden randomness have no place in the flight code; <chrono> is for durations.
HIDDEN = re.compile(r"system_clock|steady_clock|std::rand\b|(^|[;{)])\s*throw\b(?! std::invalid_argument)")
BANNED = {"random", "thread", "mutex", "fstream", "iostream", "ctime", "cstdio", "filesystem"}


def folders():
    """{folder: (its house, its path, what it depends on)}; a subfolder with a CMakeLists.txt counts as one."""
    found = {}
    for house in HOUSES:
        for cmake in sorted((ROOT / "src" / house / "gatefly").rglob("CMakeLists.txt")):
            name = cmake.parent.name
            found[name] = house, cmake.parent, set(DEPENDS.findall(cmake.read_text())) - {name}
    return found


def home(path, found):
    """The folder that a path below a house's `gatefly` belongs to: the innermost that is a library."""
    for part in reversed(pathlib.PurePosixPath(path).parts):
        if part in found:
            return part
    return None


def circle(names, depends):
    """The folders of which each depends on another of these, directly or not; none without a circle."""
    left = set(names)
    while free := {name for name in left if not depends[name] & left}:
        left -= free
    return left


def house_violations(found):
    house_of = {name: house for name, (house, _, _) in found.items()}
    for name, (house, path, depends) in found.items():
        for other in sorted(depends - set(house_of)):
            yield f"{path}: there is no folder {other}"
        for other in sorted(depends & set(house_of)):
            if HOUSES.index(house_of[other]) > HOUSES.index(house):
                yield f"{path}: {house} may not depend on {other}, of {house_of[other]}"
    if left := circle(found, {name: depends for name, (_, _, depends) in found.items()}):
        yield f"{ROOT / 'src'}: {', '.join(sorted(left))} depend on each other in a circle"
    for path in sorted((ROOT / "src").rglob("*.[ch]pp")):
        house, root, *inner = path.relative_to(ROOT / "src").parts[:-1]
        if house not in HOUSES or root != "gatefly" or not home("/".join(inner), found):
            yield f"{path}: stands in no folder of a house"


def violations(found):
    flight = {name for name, (house, _, _) in found.items() if house == "flight"}
    for folder, (house, path, depends) in found.items():
        cmake, allowed = path / "CMakeLists.txt", depends | {folder}
        is_flight = house == "flight"
        below = flight if folder in TO_AUTOPILOTS else flight - TO_AUTOPILOTS
        if is_flight and not allowed - {"Eigen"} <= below:
            yield f"{cmake}: flight code may not depend on {sorted(allowed - below)}"
        if allowed & FORBIDDEN.get(folder, set()):
            yield f"{cmake}: {folder} may not depend on {sorted(allowed & FORBIDDEN[folder])}"
        for source in sorted(each for each in path.rglob("*.[ch]pp") if home(each.parent.relative_to(path.parent), found) == folder):
            for number, line in enumerate(source.read_text().splitlines(), 1):
                where = f"{source}:{number}"
                ours, system, quoted = OURS.match(line), SYSTEM.match(line), QUOTED.match(line)
                if ours and home(ours[1], found) not in allowed:
                    yield f"{where}: {folder} may not include {ours[1]}"
                if quoted and not ours:
                    yield f'{where}: includes are written "gatefly/<folder>/<file>.hpp"'
                if is_flight and system:
                    if "/" in system[1] and not system[1].startswith("Eigen/"):
                        yield f"{where}: flight code includes <{system[1]}>; Eigen only"
                    if system[1].endswith(".h") or system[1] in BANNED:
                        yield f"{where}: flight code includes <{system[1]}>"
                if folder == "experiments" and RING.search(line):
                    yield f"{where}: experiments use estimation/navigator.hpp"
                if is_flight and HIDDEN.search(line):
                    yield f"{where}: no clock, no hidden randomness, nothing thrown but std::invalid_argument"


def namespace_violations(found):
    """Flight code is in `gatefly`, every other folder in `gatefly::<folder>`; deeper ones in either are free."""
    elsewhere = {name for name, (house, _, _) in found.items() if house != "flight"}
    for path in sorted((ROOT / "src").rglob("*.[ch]pp")):
        house, _, *inner = path.relative_to(ROOT / "src").parts[:-1]
        for block in NAMESPACE.finditer(LENT.sub("", path.read_text())):
            first = block[1]
            if house == "flight" and first in elsewhere:
                yield f"{path}: flight code in namespace gatefly::{first}"
            if house != "flight" and first != home("/".join(inner), found):
                yield f"{path}: namespace gatefly{'::' + first if first else ''}, not gatefly::{home('/'.join(inner), found)}"


def c_interface_violations(found):
    """The C interface, in a folder of its own beside the houses, includes what it depends on."""
    allowed = set(DEPENDS.findall((ROOT / "c" / "CMakeLists.txt").read_text()))
    for source in sorted((ROOT / "c").glob("*.[ch]pp")):
        for number, line in enumerate(source.read_text().splitlines(), 1):
            if (ours := OURS.match(line)) and home(ours[1], found) not in allowed:
                yield f"{source}:{number}: the C interface may not include {ours[1]}"


def passed_doors():
    for source in sorted(path for folder in ("src", "c", "apps", "python", "tests") for path in (ROOT / folder).rglob("*.[ch]pp")):
        if source.relative_to(ROOT).as_posix().startswith(STAGES_FOR):
            continue
        for number, line in enumerate(source.read_text().splitlines(), 1):
            if STAGE.match(line):
                yield f"{source}:{number}: only gatefly/detection/*.hpp is for others, not its folders"


def parts_with_pilot(found):
    """The pilot's parts are tested, and can be used, without a pilot."""
    for part in ("course", "lookout", "guidance", "phase"):
        for source in (found["race"][1] / f"{part}.hpp", ROOT / "tests" / "race" / f"{part}_test.cpp"):
            if "race/pilot" in source.read_text():
                yield f"{source}: includes the pilot, whose part it is"


FOUND = folders()
wrong = [*house_violations(FOUND), *violations(FOUND), *namespace_violations(FOUND), *c_interface_violations(FOUND), *passed_doors(),
         *parts_with_pilot(FOUND)]
print("\n".join(wrong) or f"layers: ok, {len(FOUND)} folders in {len(HOUSES)} houses")
sys.exit(bool(wrong))
