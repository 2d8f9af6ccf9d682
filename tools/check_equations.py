#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when docs/paper/equations.md names a function or class that is not where it says, a link that leads nowhere, or lacks a row:
for an equation or algorithm of the paper, for a figure that we reproduce, or for an experiment.

    | 9 | what | label | [pose/ray_intersection.cpp](../../src/flight/gatefly/pose/ray_intersection.cpp): `nearest_point` |

Names in backticks belong to the last link to the source before them, a file or a folder."""
import functools
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
PAGE = ROOT / "docs" / "paper" / "equations.md"
EXPERIMENTS = ROOT / "src" / "studies" / "gatefly" / "experiments" / "experiment.cpp"

EQUATIONS = {str(n) for n in range(1, 36)} | {"Alg. 1", "Alg. 2"}
# The paper's figures and tables with a result; the others are drawings and photographs.
FIGURES = {"fig:system_structure", "fig:ROC min length", "fig:ROC cf", "fig:TPR vs distance", "fig:sequence",
           "fig:histogram_detection", "fig:LS vs PnP", "fig:histogram", "fig:EKF result", "fig:EKF error",
           "fig:feed forward control", "tab:feed-forward control accuracy", "fig:sim_different_intial_point",
           "fig:basement 3D"}
TOKEN = re.compile(r"\[[^\]]*\]\((?P<link>[^)]+)\)|`(?P<code>[^`]+)`")
NAME = re.compile(r"\w+(::\w+)*$")


@functools.cache
def code_of(path):
    """All C++ of a file or folder, without comments and texts: a name that is only spoken of does not count."""
    files = [path] if path.is_file() else sorted(path.rglob("*.[ch]pp"))
    return "\n".join(re.sub(r'//[^\n]*|"(?:\\.|[^"\\\n])*"', "", file.read_text()) for file in files)


def is_in(name, code):
    """A function `f`, a type `T`, or a method `T::f`, declared or defined."""
    *scope, last = name.split("::")
    found = rf"\b{last}\s*\(" if scope else rf"\b{last}\s*\(|\b(struct|class|using)\s+{last}\b"
    if scope and re.search(rf"\b{scope[-1]}::{last}\s*\(", code):
        return True
    return bool(re.search(found, code)) and all(re.search(rf"\b(struct|class)\s+{each}\b", code) for each in scope)


def rows():
    """(line number, cells) of each row of the page's tables but their heads."""
    lines = PAGE.read_text().splitlines()
    for number, line in enumerate(lines, 1):
        is_head = number < len(lines) and lines[number].startswith("| ---")
        if line.startswith("|") and not line.startswith("| ---") and not is_head:
            yield number, [cell.strip() for cell in line.strip("|").split(" | ")]


def link_error(link):
    path, _, anchor = link.partition("#")
    target = (PAGE.parent / path).resolve()
    if not target.exists():
        return f"{link} leads nowhere"
    if anchor and f'id="{anchor}"' not in target.read_text():
        return f"{path} has no place #{anchor}"
    return None


def violations():
    experiments = dict(re.findall(r'\{"([\w-]+)",\s*"[^"]*",\s*(\w+)', EXPERIMENTS.read_text()))
    found, shown = set(), set()
    for number, cells in rows():
        where = f"{PAGE}:{number}"
        if len(cells) != 4:
            yield f"{where}: has {len(cells)} cells, must be 4"
            continue
        found |= {part.strip() for part in cells[0].split(",")} | set(re.findall(r"`([^`]+)`", cells[2]))
        place, names = None, 0
        for token in TOKEN.finditer(cells[3]):
            link, name = token["link"], token["code"]
            if link:
                if error := link_error(link):
                    yield f"{where}: {error}"
                elif "/src/" in link:
                    place = (PAGE.parent / link).resolve()
            elif name.startswith("gatefly "):
                experiment = name.removeprefix("gatefly reproduce ")
                shown.add(experiment)
                if "reproduce" in name and experiment not in experiments:
                    yield f"{where}: there is no experiment {experiment}"
            elif place is None or not NAME.match(name):
                yield f"{where}: `{name}` is not a name behind a link to the source"
            else:
                names += 1
                if not is_in(name, code_of(place)):
                    yield f"{where}: {name} is not in {place.relative_to(ROOT.resolve())}"
        if not names and not re.search(r"\*\*not |^not needed", cells[3]):
            yield f"{where}: names no function, and does not say **not ...**"
    for missing in sorted(EQUATIONS - found):
        yield f"{PAGE}: has no row for {missing if missing.startswith('Alg') else 'Eq. ' + missing}"
    for missing in sorted(FIGURES - found):
        yield f"{PAGE}: has no row with `{missing}`"
    for missing in sorted(set(experiments) - shown):
        yield f"{PAGE}: has no row with `gatefly reproduce {missing}`"
    if not experiments:
        yield f"{EXPERIMENTS}: lists no experiments"


errors = list(violations())
print("\n".join(errors) or "equations: ok")
sys.exit(bool(errors))
