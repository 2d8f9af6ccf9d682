#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every loop of the flight code that does not count says how often it turns at most: `at most` in a comment on its line or right above it.

usage: check_loops.py [ROOT]

Looked at are `while`, `do` and every `for` of which a part is left out: a `for` over a list, or with a beginning, an end and a step, counts.
Exit 0: each says it."""
import pathlib
import re
import sys

FOLDERS = ("src/flight", "c")
OPEN = re.compile(r"\b(?:while|do) *[({]|\bfor *\( *;|\bfor *\([^;()]*;[^;-]*; *\) *[{\w]")
OPEN_OR_IF = re.compile(r"^\s*(?:while|if|for) *\(")
COMMENT = re.compile(r"^\s*(?://|/?\*)")
SAYS_IT = re.compile(r"\bat\s+(?://\s*)?most\b", re.IGNORECASE)


def silent_loops(text):
    """(line number, line) of each loop that does not count and has no bound beside it."""
    lines = text.splitlines()
    for i, line in enumerate(lines):
        code, _, comment = line.partition("//")
        if COMMENT.match(line) or not OPEN.search(code):
            continue
        above = i
        # One comment may be said of two loops in a row, or of a condition and its loop.
        while above > 0 and OPEN_OR_IF.match(lines[above - 1]):
            above -= 1
        while above > 0 and COMMENT.match(lines[above - 1]):
            above -= 1
        if not SAYS_IT.search("\n".join([*lines[above:i], comment, lines[i - 1].partition("//")[2]])):
            yield i + 1, line.strip()


def main(root):
    files = sorted(path for folder in FOLDERS for pattern in ("*.cpp", "*.hpp", "*.c", "*.h") for path in (root / folder).rglob(pattern))
    silent = [f"{path.relative_to(root)}:{number}: {line}" for path in files for number, line in silent_loops(path.read_text(encoding="utf-8"))]
    for each in silent:
        print(f"loops: say how often at most: {each}")
    print(f"loops: {len(files)} files, {len(silent)} loops without a bound")
    return 1 if silent or not files else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
