#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every loop of the flight code that does not count says how often it turns at most: `at most` in a comment on its line or right above it.

usage: check_loops.py [ROOT]

What counts: a `for` over a list, and one with a beginning, an end, and a step of one variable by ++, --, += or -= of a number or a constant (kLikeThis).
All others, `while`, `do` and `goto` too, have to say it; that it is true is read by people. Exit 0: each says it."""
import pathlib
import re
import sys

FOLDERS = ("src/flight", "c")
LOOP = re.compile(r"\b(for|while|do|goto)\b")
STEP = re.compile(r"^(?:\+\+|--)?([\w.]+?)(?:\+\+|--| *[+-]= *(?:[\d.]+|k[A-Z]\w*))?$")
COMMENT = re.compile(r"^\s*(?://|/?\*)")
CONTINUES = re.compile(r"^\s*(?:while|if|for)\b")
SAYS_IT = re.compile(r"\bat\s+(?://\s*)?most\b", re.IGNORECASE)


def code_of(text):
    """The text with blanks in place of comments and of what is between quotes."""
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.DOTALL)


def header_at(code, begin):
    """What is between the brackets that open at or after `begin`."""
    first = code.find("(", begin)
    depth = 0
    for i in range(first, len(code)):
        depth += (code[i] == "(") - (code[i] == ")")
        if depth == 0:
            return code[first + 1:i]
    return ""


def parts_of(header):
    """A for's three parts; one where it goes over a list."""
    parts, depth = [""], 0
    for letter in header:
        depth += (letter in "({[") - (letter in ")}]")
        if letter == ";" and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def counts(header):
    parts = parts_of(header)
    if len(parts) == 1:
        return True
    first, condition, step = parts
    if first and condition and not step:
        return re.fullmatch(r"\w+-- > 0", condition) is not None
    if not first or not condition:
        return False
    # One that counts has to be asked about.
    steps = [STEP.match(each) for each in parts_of(step.replace(",", ";"))]
    return any(one and one[0] != one[1] and re.search(rf"(?<![\w.]){re.escape(one[1])}(?!\w)", condition) for one in steps)


def ends_do(code, place):
    """Whether the `while` at a place belongs to a `do`."""
    before = code[:place].rstrip()
    if not before.endswith("}"):
        return False
    depth = 0
    for i in range(len(before) - 1, -1, -1):
        depth += (before[i] == "}") - (before[i] == "{")
        if depth == 0:
            return re.search(r"\bdo\s*$", before[:i]) is not None
    return False


def silent_loops(text):
    """(line number, line) of each loop that does not count and has no bound beside it."""
    lines, code = text.splitlines(), code_of(text)
    for found in LOOP.finditer(code):
        if found[1] == "for" and counts(header_at(code, found.end())):
            continue
        if found[1] == "while" and ends_do(code, found.start()):
            continue
        number = code.count("\n", 0, found.start())
        above = number
        # One comment may be said of two loops in a row, or of a condition and its loop.
        while above > 0 and CONTINUES.match(lines[above - 1]):
            above -= 1
        while above > 0 and COMMENT.match(lines[above - 1]):
            above -= 1
        beside = [each.partition("//")[2] for each in (lines[number - 1] if number else "", lines[number])]
        if not SAYS_IT.search("\n".join([*lines[above:number], *beside])):
            yield number + 1, lines[number].strip()


def main(root):
    files = sorted(path for folder in FOLDERS for pattern in ("*.cpp", "*.hpp", "*.c", "*.h") for path in (root / folder).rglob(pattern))
    silent = [f"{path.relative_to(root)}:{number}: {line}" for path in files for number, line in silent_loops(path.read_text(encoding="utf-8"))]
    for each in silent:
        print(f"loops: say how often at most: {each}")
    print(f"loops: {len(files)} files, {len(silent)} loops without a bound")
    return 1 if silent or not files else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
