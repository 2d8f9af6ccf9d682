#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The schemas for editors allow what the readers allow, and refuse what they refuse.

usage: schema_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
Where Python's jsonschema is installed it judges as well.
"""
import copy
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

try:
    import jsonschema
except ImportError:
    jsonschema = None

GATEFLY, ROOT = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
DRAWN = {"randomize", "faults"}  # shown when they are set
TYPES = {"object": dict, "array": list, "string": str}


def run(*arguments):
    return subprocess.run([GATEFLY, *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False)


def schema_of(command):
    return json.loads(run(command, "--schema").stdout)


def fits(rule, value):
    """As much of JSON Schema as ours use."""
    if "anyOf" in rule:
        return any(fits(each, value) for each in rule["anyOf"])
    if "oneOf" in rule and sum(all(key in value for key in each["required"]) for each in rule["oneOf"]) != 1:
        return False
    kind = rule["type"]
    if kind in {"number", "integer"}:
        return (isinstance(value, (int, float)) and not isinstance(value, bool) and rule["minimum"] <= value <= rule["maximum"]
                and (kind == "number" or value == int(value)))
    if not isinstance(value, TYPES[kind]) or ("enum" in rule and value not in rule["enum"]):
        return False
    if kind == "array":
        return rule["minItems"] <= len(value) <= rule["maxItems"] and all(fits(rule["items"], each) for each in value)
    if kind == "object":
        return (all(key in rule["properties"] and fits(rule["properties"][key], each) for key, each in value.items())
                and all(key in value for key in rule.get("required", ())))
    return True


def toml(value):
    """A value as an inline TOML value."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(each)}" for key, each in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


class Schema(unittest.TestCase):
    def judge(self, schema, value):
        said = fits(schema, value)
        if jsonschema is not None:
            self.assertEqual(jsonschema.Draft7Validator(schema).is_valid(value), said)
        return said


class Tracks(Schema):
    FULL = {"name": "mine", "laps": 2, "start": {"position_m": [0.0, 0.0], "heading_deg": 0.0},
            "gates": [{"position_m": [4.0, 0.0, -1.5], "heading_deg": 0.0, "side_m": 1.0, "bar_m": 0.05, "depth_m": 0.05, "color": "red",
                       "exit": {"run_m": 0.5, "turn": "right", "angle_deg": 180.0, "radius_m": 1.5}},
                      {"position_m": [0.0, 3.0, -1.5], "heading_deg": 180.0, "color": [0.1, 0.4, 1.0]}],
            "obstacles": [{"box_m": [0.4, 0.4, 2.0], "position_m": [2.0, 1.5], "heading_deg": 0.0},
                          {"pole_m": [0.1, 2.0], "position_m": [1.0, 1.0]}],
            "room": {"size_m": [14.0, 12.0, 3.5], "center_m": [2.0, 1.5], "look": "hall"},
            "randomize": {"level": "hard", "drag_percent": 5.0}, "faults": {"camera_out_s": [3.0, 4.0], "false_gates": 2}}

    @classmethod
    def setUpClass(cls):
        cls.schema = schema_of("track")
        temporary = tempfile.TemporaryDirectory(prefix="gatefly-schema-")
        cls.addClassCleanup(temporary.cleanup)
        cls.file = pathlib.Path(temporary.name) / "track.toml"

    def answer(self, track):
        """The program's reading of it; None when the file cannot be used."""
        self.file.write_text("\n".join(f"{key} = {toml(value)}" for key, value in track.items()) + "\n", encoding="utf-8")
        done = run("track", self.file, "--json")
        return json.loads(done.stdout) if done.returncode != 2 else None

    def expect_the_same(self, track):
        self.assertEqual(self.judge(self.schema, track), self.answer(track) is not None, track)

    def places(self, value=FULL, path=()):
        """Each table and key, by the way to it."""
        for key, each in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
            yield (*path, key)
            yield from self.places(each, (*path, key))

    def changed(self, path, how):
        track = copy.deepcopy(self.FULL)
        place = track
        for step in path[:-1]:
            place = place[step]
        how(place, path[-1])
        return track

    def test_every_track_there_is_fits(self):
        tracks = [*(ROOT / "tracks").glob("*.toml"), *(ROOT / "tests" / "courses").glob("*.toml")]
        self.assertGreater(len(tracks), 8)
        for path in tracks:
            self.assertTrue(self.judge(self.schema, tomllib.loads(path.read_text(encoding="utf-8"))), path)
        self.assertTrue(self.judge(self.schema, tomllib.loads(run("new", "track", "-").stdout)))
        self.assertTrue(self.judge(self.schema, self.FULL))
        self.assertIsNotNone(self.answer(self.FULL))

    def test_a_key_may_be_left_out_where_the_reader_says_so(self):
        for path in self.places():
            if isinstance(path[-1], str):
                with self.subTest(path):
                    self.expect_the_same(self.changed(path, lambda place, key: place.pop(key)))

    def test_a_wrong_key_or_type_or_number_is_refused_by_both(self):
        for path in self.places():
            for wrong in (True, "no such word", -1e6, [], {}):
                if isinstance(path[-1], str) and path[-1] != "name":
                    with self.subTest(path=path, wrong=wrong):
                        track = self.changed(path, lambda place, key, wrong=wrong: place.__setitem__(key, wrong))
                        if wrong == {} and path[-1] in {"randomize", "room", "faults"}:
                            continue  # an empty table says nothing
                        if wrong == [] and path[-1] == "obstacles":
                            continue
                        self.assertFalse(self.judge(self.schema, track))
                        self.assertIsNone(self.answer(track))
        for path in ((), ("start",), ("gates", 0), ("gates", 0, "exit"), ("obstacles", 0), ("room",), ("randomize",), ("faults",)):
            with self.subTest(path):
                track = self.changed((*path, "colour"), lambda place, key: place.__setitem__(key, 1))
                self.assertFalse(self.judge(self.schema, track))
                self.assertIsNone(self.answer(track))

    def test_without_a_key_holds_what_the_schema_says(self):
        plain = {"name": "track", "start": {"position_m": [0.0, 0.0]}, "gates": self.FULL["gates"][:1], "randomize": {"level": "none"},
                 "room": {"size_m": [14, 16, 3.2]}}
        answer = self.answer(plain)
        tables = ((plain, self.schema), (plain["start"], self.schema["properties"]["start"]),
                  (plain["gates"][0], self.schema["properties"]["gates"]["items"]), (plain["room"], self.schema["properties"]["room"]))
        told = 0
        for table, rules in tables:
            for key, rule in rules["properties"].items():
                otherwise = rule.get("description", "").partition("; without it ")[2]
                if not re.fullmatch(r"-?[\d.]+|\[.*\]|hall", otherwise):
                    continue
                value = json.loads(otherwise) if otherwise != "hall" else otherwise
                kept = table.get(key)
                table.pop(key, None)
                without = self.answer(plain)
                table[key] = value
                self.assertEqual(self.answer(plain), without, key)
                table.pop(key) if kept is None else table.__setitem__(key, kept)
                told += 1
        self.assertGreaterEqual(told, 6)
        self.assertIsNotNone(answer)

    def test_the_page_has_the_table_that_the_program_reads(self):
        done = subprocess.run([sys.executable, ROOT / "tools" / "track_key_table.py", GATEFLY, ROOT, "--check"], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)


class Configurations(Schema):
    @classmethod
    def setUpClass(cls):
        cls.schema = schema_of("config")

    def test_every_configuration_there_is_fits(self):
        files = [path for folder in ("configs", "cameras", "vehicles") for path in (ROOT / folder).glob("*.toml")]
        self.assertGreater(len(files), 6)
        for path in files:
            self.assertTrue(self.judge(self.schema, tomllib.loads(path.read_text(encoding="utf-8"))), path)
        self.assertTrue(self.judge(self.schema, tomllib.loads(run("new", "config", "-").stdout)))
        self.assertTrue(self.judge(self.schema, json.loads(run("config", "--json").stdout)))

    def test_it_has_every_key_and_no_other(self):
        keys = {f"{section}.{key}" for section, table in json.loads(run("config", "--json").stdout).items() if section not in DRAWN for key in table}
        told = {f"{section}.{key}" for section, table in self.schema["properties"].items() if section not in DRAWN for key in table["properties"]}
        self.assertEqual(told, keys)

    def test_a_wrong_value_is_refused_by_both(self):
        for section, table in self.schema["properties"].items():
            for key, rule in list(table["properties"].items())[:6]:
                for wrong in (True, -1e7, [1, 2, 3, 4, 5, 6, 7]):
                    with self.subTest(f"{section}.{key} = {wrong}"):
                        self.assertFalse(self.judge(self.schema, {section: {key: wrong}}), rule)
                        self.assertEqual(run("config", "--set", f"{section}.{key}={json.dumps(wrong)}").returncode, 2)
        self.assertFalse(self.judge(self.schema, {"control": {"speed": 1.0}}))
        self.assertFalse(self.judge(self.schema, {"contrl": {}}))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
