#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the table of a track file's keys into docs/own_course.md, between its two marks; --check: says whether it is there as it stands.

What it says is what `gatefly track --schema` prints, which is made of the reader's own table (src/workshop/gatefly/config/track_keys.cpp).

usage: track_key_table.py GATEFLY [ROOT] [--check]"""
import json
import pathlib
import re
import subprocess
import sys

BEGIN, END = "<!-- keys: made by tools/track_key_table.py -->\n", "<!-- /keys -->"


def number(value):
    return f"{value:g}"


def allowed(rule):
    if "anyOf" in rule:
        return " or ".join(allowed(each) for each in rule["anyOf"])
    if "enum" in rule:
        return ", ".join(f'`"{word}"`' for word in rule["enum"])
    if rule["type"] == "array":
        return f"{rule['minItems']} numbers, each {allowed(rule['items'])}"
    if rule["type"] == "string":
        return "text"
    span = f"{number(rule['minimum'])} … {number(rule['maximum'])}".replace("-", "−")
    return span + (", whole" if rule["type"] == "integer" else "")


def rows(table):
    needed = set(table.get("required", ()))
    for name, rule in table["properties"].items():
        if "description" not in rule or rule.get("type") == "object" or "properties" in rule.get("items", {}):
            continue
        what, _, otherwise = rule["description"].partition("; without it ")
        example = json.dumps(rule["examples"][0])
        without = "**must be there**" if name in needed else otherwise
        yield f"| `{name} = {example}` | {what} | {allowed(rule)} | {without} |"


def key_table(schema):
    top = schema["properties"]
    gate = top["gates"]["items"]
    parts = ((schema, "Top of the file"), (top["start"], "`[start]`"), (gate, "`[[gates]]`, one each, in the order of flight"),
             (gate["properties"]["exit"], "`[gates.exit]`: " + gate["properties"]["exit"]["description"].replace('control.mode = "paper"', '`control.mode = "paper"`')),
             (top["obstacles"]["items"], "`[[obstacles]]`, one each: a box or a pole"), (top["room"], "`[room]`"))
    for table, title in parts:
        yield f"**{title}**\n"
        yield "| key, example | what | allowed | without it |\n| --- | --- | --- | --- |"
        yield "\n".join(rows(table)) + "\n"


def main(arguments):
    check = "--check" in arguments
    program, *rest = [each for each in arguments if each != "--check"]
    root = pathlib.Path(rest[0] if rest else pathlib.Path(__file__).resolve().parent.parent)
    page = root / "docs" / "own_course.md"
    schema = json.loads(subprocess.run([program, "track", "--schema"], capture_output=True, text=True, check=True).stdout)
    old = page.read_text(encoding="utf-8")
    table = "\n" + "\n".join(key_table(schema)) + "\n"
    new = re.sub(f"(?<={re.escape(BEGIN)}).*?(?={re.escape(END)})", lambda _: table, old, flags=re.S)
    if check and new != old:
        print(f"{page}: its table of keys is not what the program reads; run tools/track_key_table.py GATEFLY", file=sys.stderr)
        return 1
    if not check:
        page.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
