#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The numbers of README.md and docs/ are those that their commands print: numbers.toml, beside this file.

usage: numbers_test.py GATEFLY REPOSITORY_ROOT [--full] [unittest arguments]

Each claim is looked for on its page, word by word, and its command is run: those of ten CPU seconds and less always, the others with
--full. What needs real data is left out, with a line, where there is none.
"""
import csv
import json
import os
import pathlib
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
import tomllib
import unittest

GATEFLY, ROOT = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
FULL = "--full" in sys.argv
DATA = pathlib.Path(os.environ.get("GATEFLY_DATA") or ROOT.parent / "shared" / "data")
TABLE = tomllib.loads((ROOT / "tests" / "docs" / "numbers.toml").read_text(encoding="utf-8"))["claim"]
# Limits of a test that always runs, and of all of them together [s of CPU].
MOST_OF_ONE, MOST_OF_ALL = 10, 60
NEEDS_DATA = re.compile(r"tudelft_|washington|broad_|fisheye_|reproduce (?!feasible|pose-ls|pose-bars)")


def words_of(text):
    """On one line: a page may break its lines where it likes."""
    return " ".join(text.split())


def as_said(number):
    """A pattern for a number however many zeros it has: 0.96 is 0.960 and .96."""
    return r"(?<![\d.])" + re.sub(r"^0\\\.", r"0?\.", re.escape(str(abs(number)))) + r"0*(?!\d)"


def is_cheap(claim):
    return claim["cpu_s"] <= MOST_OF_ONE


def name_of(claim):
    return f"{claim['page']}: {claim['says'][:60]}"


class Output:
    """Output of a command: printed and written."""

    def __init__(self, commands, folder, cache):
        environment = dict(os.environ, XDG_CACHE_HOME=str(cache))
        if DATA.is_dir():
            environment["GATEFLY_DATA"] = str(DATA)
        self.folder, self.text = folder, ""
        before = os.times()
        for command in commands:
            done = subprocess.run([GATEFLY, *shlex.split(command)], cwd=folder, env=environment, capture_output=True, text=True,
                                  timeout=3600, check=False)
            if done.returncode not in {0, 1}:
                raise AssertionError(f"gatefly {command}: exit {done.returncode}\n{done.stderr[-800:]}")
            self.text = done.stdout
        after = os.times()
        self.cpu_s = after.children_user + after.children_system - before.children_user - before.children_system

    def value(self, where):
        """The number that `where` leads to: a path in JSON, a column of a table, or a pattern in what was printed."""
        if "column" in where:
            with (self.folder / where["file"]).open(encoding="utf-8") as table:
                rows = [row for row in csv.DictReader(table) if not where.get("finished") or row["finished"] == "1"]
            return getattr(statistics, where.get("of", "median"))(float(row[where["column"]]) for row in rows)
        text = (self.folder / where["file"]).read_text(encoding="utf-8") if "file" in where else self.text
        if "pattern" in where:
            match = re.search(where["pattern"], text)
            if not match:
                raise AssertionError(f"nothing like {where['pattern']} in:\n{text[-1500:]}")
            return float(match[1])
        value = json.loads(text)
        for step in where["at"].split("/"):
            value = value[int(step) if isinstance(value, list) else step]
        return float(value) * where.get("times", 1)


class Table(unittest.TestCase):
    def test_every_claim_stands_on_its_page_with_its_numbers(self):
        for claim in TABLE:
            with self.subTest(name_of(claim)):
                page = words_of((ROOT / claim["page"]).read_text(encoding="utf-8"))
                self.assertIn(words_of(claim["says"]), page, "the page says it no more: bring page and table together")
                for each in claim["values"]:
                    self.assertRegex(claim["says"], as_said(each["number"]), "is not in what is said")

    def test_every_claim_says_how_near_and_on_which_seeds(self):
        for claim in TABLE:
            with self.subTest(name_of(claim)):
                self.assertTrue(claim["seeds"])
                self.assertTrue(claim["values"])
                for each in claim["values"]:
                    self.assertGreaterEqual(each["within"], 0)

    def test_what_always_runs_is_cheap(self):
        costs = {str(claim["command"]): claim["cpu_s"] for claim in TABLE if is_cheap(claim)}
        self.assertLessEqual(sum(costs.values()), MOST_OF_ALL)


class Numbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="gatefly-numbers-")
        cls.addClassCleanup(temporary.cleanup)
        cls.top, cls.made = pathlib.Path(temporary.name), {}

    def output_of(self, claim):
        commands = claim["command"] if isinstance(claim["command"], list) else [claim["command"]]
        key = tuple(commands)
        if key not in self.made:  # several claims may be of one
            folder = self.top / str(len(self.made))
            folder.mkdir()
            self.made[key] = Output(commands, folder, self.top / "cache")
            print(f"{self.made[key].cpu_s:.1f} s of CPU (said: {claim['cpu_s']}): gatefly {commands[-1]}", flush=True)
        return self.made[key]

    def check(self, claim):
        if NEEDS_DATA.search(str(claim["command"])) and not DATA.is_dir():
            self.skipTest(f"no real data ({DATA}): {name_of(claim)}")
        output = self.output_of(claim)
        for each in claim["values"]:
            with self.subTest(number=each["number"], said=claim["says"]):
                self.assertAlmostEqual(output.value(each), float(each["number"]), delta=each["within"] + 1e-12)


def add_tests():
    for i, claim in enumerate(TABLE):
        if FULL or is_cheap(claim):
            name = re.sub(r"\W+", "_", pathlib.Path(claim["page"]).stem.lower())
            setattr(Numbers, f"test_{i:02}_{name}", lambda self, claim=claim: self.check(claim))


if __name__ == "__main__":
    add_tests()
    unittest.main(argv=[sys.argv[0], *(each for each in sys.argv[3:] if each != "--full")])
