#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the folders of src and who depends on whom, as each CMakeLists.txt says, into docs/architecture.md.

Counts arrows up, from a house to one after it, and folders in circles. An arrow is not drawn where others lead the same way;
counted are all. A library in a subfolder belongs to its folder here.

usage: draw_folders.py [ROOT] [--check]    --check changes nothing, and fails when the drawing is not the page's, or an arrow is up
                                           or in a circle"""
import pathlib
import re
import sys

HOUSES = {"flight": "flight: what runs on a drone", "workshop": "workshop: files, configuration, logs, pages",
          "simulator": "simulator", "studies": "studies"}
DEPENDS = re.compile(r"gatefly::(\w+)")
BEGIN, END = "<!-- drawn by tools/draw_folders.py -->\n", "<!-- end of the drawing -->\n"


def folders(root):
    """({folder: house}, {folder: the folders that it depends on})."""
    house, folder_of, said = {}, {}, {}
    for name in HOUSES:
        base = root / "src" / name / "gatefly"
        for cmake in sorted(base.rglob("CMakeLists.txt")):
            folder = cmake.relative_to(base).parts[0]
            house[folder] = name
            folder_of[cmake.parent.name] = folder
            said.setdefault(folder, set()).update(DEPENDS.findall(cmake.read_text()))
    return house, {folder: {folder_of[each] for each in libraries if each in folder_of} - {folder} for folder, libraries in said.items()}


def reached(start, arrows):
    """Every folder that `start` depends on, directly or not."""
    found, waiting = set(), [start]
    while waiting:
        for each in arrows[waiting.pop()] - found:
            found.add(each)
            waiting.append(each)
    return found


def drawing(house, arrows):
    """The page's text: houses as boxes, and each arrow that no way over other folders replaces."""
    lines = ["```mermaid", "flowchart BT"]
    for name, title in HOUSES.items():
        inside = [folder for folder in house if house[folder] == name]
        lines += [f'  subgraph {name}_house["{title}"]', *(f"    {folder}" for folder in inside), "  end"]
    for folder, others in arrows.items():
        further = set().union(*(reached(each, arrows) for each in others))
        lines += [f"  {folder} --> {' & '.join(sorted(others - further))}"] if others else []
    count = sum(len(others) for others in arrows.values())
    return "\n".join([*lines, "```", "", f"{len(house)} folders, {count} arrows ({counted(house, arrows)}); "
                      "drawn are those that others do not imply.", ""])


def counted(house, arrows):
    order = list(HOUSES)
    up = sum(order.index(house[other]) > order.index(house[folder]) for folder, others in arrows.items() for other in others)
    circles = sum(folder in reached(folder, arrows) for folder in arrows)
    return f"{up} up, {circles} in circles"


def main(root, checks):
    house, arrows = folders(root)
    page = root / "docs" / "architecture.md"
    before, rest = page.read_text().split(BEGIN)
    wanted = before + BEGIN + drawing(house, arrows) + END + rest.split(END)[1]
    print(f"folders: {len(house)}, {counted(house, arrows)}")
    if not checks:
        page.write_text(wanted)
        return 0
    if wanted != page.read_text():
        print(f"{page}: the drawing of the folders is not that of their CMakeLists.txt: tools/draw_folders.py draws it")
        return 1
    return counted(house, arrows) != "0 up, 0 in circles"


if __name__ == "__main__":
    named = [word for word in sys.argv[1:] if word != "--check"]
    sys.exit(main(pathlib.Path(named[0] if named else pathlib.Path(__file__).resolve().parent.parent), "--check" in sys.argv))
