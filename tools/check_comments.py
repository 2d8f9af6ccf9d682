#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when more comments than the budget open with Of, What, Who, Whose, Whom, Whoever, Whatever, Where or Wherever.

Such an opening leaves out the noun that the comment is about: "Of its end [s]" for "End of the tick [s]". Counted are comments of src, c, apps, python and
tests: the first line of each block, and each comment behind code. --list prints them. The budget only ever goes down.

usage: check_comments.py [ROOT] [--list]"""
import collections
import pathlib
import re
import sys

BUDGET = 60
FOLDERS = ("src", "c", "apps", "python", "tests")
OPENING = r"(?:Of|What|Who|Whose|Whom|Whoever|Whatever|Where|Wherever)\b"
ALONE = {".py": re.compile(r"\s*#\s?(.*)"), "": re.compile(r"\s*//[/!]?<?\s?(.*)")}
BEHIND = {".py": re.compile(r"(?:#|\"\"\")\s*" + OPENING), "": re.compile(r"//[/!]?<?\s+" + OPENING)}
SUFFIXES = {".hpp", ".cpp", ".h", ".c", ".py"}


def openings(text, suffix):
    """Line number and line of each comment that opens like that."""
    alone, behind = (rules.get(suffix, rules[""]) for rules in (ALONE, BEHIND))
    in_block = False
    for number, line in enumerate(text.splitlines(), 1):
        if comment := alone.fullmatch(line):
            if not in_block and re.match(OPENING, comment[1]):
                yield number, line.strip()
            in_block = True
            continue
        in_block = False
        if behind.search(line):
            yield number, line.strip()


def main(root, lists):
    found = [(file.relative_to(root), number, line) for folder in FOLDERS for file in sorted((root / folder).rglob("*")) if file.suffix in SUFFIXES
             for number, line in openings(file.read_text(encoding="utf-8"), file.suffix)]
    if lists:
        print("\n".join(f"{file}:{number}: {line}" for file, number, line in found))
    by_folder = collections.Counter("/".join(file.parts[:4 if file.parts[0] == "src" else 1]) for file, _, _ in found)
    if len(found) <= BUDGET:
        print(f"comments: ok, {len(found)} of {BUDGET}")
        return 0
    print("\n".join(f"{folder}: {count}" for folder, count in by_folder.most_common()))
    print(f"{len(found)} comments open with Of, What, Who or Where; the budget is {BUDGET}. Say the noun first (--list names them).")
    return 1


if __name__ == "__main__":
    paths = [word for word in sys.argv[1:] if word != "--list"]
    sys.exit(main(pathlib.Path(paths[0] if paths else pathlib.Path(__file__).resolve().parent.parent), "--list" in sys.argv))
