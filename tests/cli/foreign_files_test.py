#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files that others wrote, damaged or hostile, and arguments nobody means: one line, exit code 2, nothing half-written.

usage: foreign_files_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import gzip
import json
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile

from material import GATE, LABELS, picture
from program import GATEFLY, ROOT, Cli, main

OVAL = ROOT / "tests" / "replay" / "oval_flight"
KALIBR = ("cam0:\n  camera_model: pinhole\n  intrinsics: [300.0, 300.0, 160.0, 120.0]\n  distortion_model: none\n"
          "  distortion_coeffs: []\n  resolution: [320, 240]\n")


def little_memory():
    resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))


class ForeignFiles(Cli):
    def refused_soon(self, *arguments):
        """In a line that is not too long, with no memory to waste."""
        said = self.refused(*arguments, preexec_fn=little_memory)
        self.assertLess(len(said), 2200)
        for raw in ("json.exception", "std::", "terminate", "yaml-cpp", "toml::"):
            self.assertNotIn(raw, said)
        return said

    def refused(self, *arguments, preexec_fn=None, **variables):
        if preexec_fn is None:
            return super().refused(*arguments, **variables)
        run_it, self.run_it = self.run_it, lambda *a, **v: run_it(*a, preexec_fn=preexec_fn, **v)
        try:
            return super().refused(*arguments, **variables)
        finally:
            self.run_it = run_it


class Toml(ForeignFiles):
    def test_tables_in_tables_without_end(self):
        for text in ("a." * 20_000 + "a = 1", "a = " + "[" * 20_000, "a = " + "{a=" * 20_000, "[" + "a." * 20_000 + "a]",
                     "a." * 20_000 + "a = 1\n" + GATE):
            for command in (("fly",), ("config", "--config"), ("track",), ("calibrate", "--out", "c.yaml", "--from")):
                self.assertIn("mine.toml:1: is nested more than 16 levels deep", self.refused_soon(*command, self.file("mine.toml", text)))
        self.assertIn("--set", self.refused_soon("config", "--set", "control.speed_mps=" + "[" * 50_000))

    def test_megabytes_of_a_value_or_a_key(self):
        for text in ("[control]\nspeed_mps = [" + "1," * 8_000_000 + "]", "[control]\nspeed_mps = '" + "x" * (16 << 20) + "'",
                     "[control]\n" + "x" * (16 << 20) + " = 1"):
            self.assertIn("mine.toml: is longer than 1 MiB", self.refused_soon("config", "--config", self.file("mine.toml", text)))
        for text in ("[control]\nspeed_mps = [" + "1," * 500_000 + "]", "[control]\nspeed_mps = '" + "x" * 1_000_000 + "'",
                     "[control]\n" + "x" * 1_000_000 + " = 1", "[" + "x" * 1_000_000 + "]\nspeed_mps = 1",
                     "[control]\n" + "x" * 500_000 + ".speed_mps = 1"):
            said = self.refused_soon("config", "--config", self.file("mine.toml", text))
            self.assertLess(len(said), 800)
            self.assertNotIn("did you mean", said)

    def test_a_name_cannot_command_the_terminal(self):
        evil = "a\\u001b[2J\\u009b2J\\u0007b"
        for command in ("fly", "track"):
            result = self.run_it(command, self.file("mine.toml", f'name = "{evil}"\n' + GATE), *(("--vision", "ideal", "--set", "sim.timeout_s=1") if command == "fly" else ()))
            for character in "\x1b\x07\x9b":
                self.assertNotIn(character, result.stdout + result.stderr)
            self.assertIn("a [2J 2J b", result.stdout)
        for name in ("x\x1b]0;title\x07.toml", "x\x1b[2J\n.toml"):
            for said in (self.refused("track", name), self.run_it("track", self.file(name, GATE)).stdout,
                         self.run_it("track", self.file(name, GATE), "--draw", self.folder / "\x1b[2J.png").stdout):
                self.assertNotIn("\x1b", said)

    def test_a_fault_of_a_gate_that_is_not_there(self):
        for key in ("missing_gate", "moved_gate", "hidden_gate"):
            for number in (2, 99, 1_000_000_000):
                said = self.fly_track(GATE + f"[faults]\n{key} = {number}\n")
                self.assertIn(f"faults.{key} = {number}", said)
                self.assertRegex(said, r"has 1 gate\b|in (0|-1)\.\.100")
                track = self.file("mine.toml", GATE)
                self.assertIn(f"faults.{key} = {number}", self.refused("track", track, "--set", f"faults.{key}={number}"))


class Arguments(ForeignFiles):
    def test_empty_values(self):
        for arguments in (("campaign", "oval", "--runs", "1", "--shard", ""), ("tune", self.folder, "--describe", ""),
                          ("fly", "oval", "--set", ""), ("fly", "oval", "--config", ""), ("fly", ""), ("replay", "x", "--track", ""),
                          ("calibrate", "x", "--pattern", ""), ("calibrate", "x", "--zero", "")):
            self.assertIn("must not be empty", self.refused(*arguments))

    def test_long_names_are_not_echoed_whole(self):
        long = "A" * 5000
        for arguments in (("fly", long), ("fly", "oval", "--config", long), ("fly", "oval", "--set", long), (long,), ("fly", "--" + long),
                          ("fly", "oval", "--vision", long), ("fly", "oval", "--seed", long), ("view", long), ("replay", long),
                          ("detect", long), ("campaign", "--compare", long, long), ("fly", "oval", "--set", long + ".a=1"),
                          ("fly", "oval", "--set", "control.speed_mps=" + long), ("campaign", "oval", "--runs", "1", "--shard", long),
                          ("fly", " ".join([long] * 3)), ("tune", "x", "--describe", long), ("calibrate", "--from", long, "--out", "x")):
            said = self.refused(*arguments)
            self.assertLess(len(said), 1500, said)
            self.assertNotIn("A" * 300, said)

    def test_numbers_that_wrap(self):
        self.assertIn("have no seeds", self.refused("render", "oval", "--frames", "200", "--seed", 2**64 - 1, "--out", "out"))
        self.assertIn("-360..360", self.refused("replay", OVAL, "--heading-offset-deg", "1e308"))
        self.assertIn("1 <= i <= n", self.refused("campaign", "oval", "--runs", "1", "--shard", f"2/{2**64 - 1}"))

    def test_a_setting_is_one_line(self):
        self.assertIn("must be on one line", self.refused("fly", "oval", "--set", "control.speed_mps=1.5\nlaps=3"))


class Campaigns(ForeignFiles):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-campaign-")
        cls.addClassCleanup(folder.cleanup)
        cls.whole = pathlib.Path(folder.name) / "whole"
        for name, arguments in (("whole", ()), ("half1", ("--shard", "1/2")), ("half2", ("--shard", "2/2"))):
            subprocess.run([GATEFLY, "campaign", "oval", "--runs", "4", "--vision", "ideal", "--laps", "1", "--quiet", "--out",
                            cls.whole.parent / name, *arguments], check=True, capture_output=True, timeout=120)

    def setUp(self):
        super().setUp()
        for name in ("whole", "half1", "half2"):
            shutil.copytree(self.whole.parent / name, self.folder / name)

    def edited(self, name, edit):
        """A copy of what was a file of the campaign, changed."""
        path = self.folder / name
        if callable(edit):
            content = json.loads(path.read_text(encoding="utf-8"))
            edit(content)
            edit = json.dumps(content)
        path.write_text(edit, encoding="utf-8")

    DEEP = "[" * 50_000

    def broken_runs(self):
        def drop(run):
            del run["detection"]

        def mistyped(run):
            run["gates_passed"] = "many"

        def endless(run):
            run["race_time_s"] = [1] * 100_000

        def huge(run):
            run["searches"] = 1e300
        return {"": "ends early", "{": "damaged", self.DEEP: "nested more than 64", "[]": "must be an object", drop: "detection is missing",
                mistyped: 'gates_passed = "many", must be a whole number', endless: "race_time_s = [1, 1", huge: "searches = 1e+300"}

    def test_a_damaged_run_is_named_not_skipped(self):
        for broken, why in self.broken_runs().items():
            shutil.rmtree(self.folder / "whole")
            shutil.copytree(self.whole, self.folder / "whole")
            shutil.rmtree(self.folder / "other", ignore_errors=True)
            shutil.copytree(self.whole, self.folder / "other")
            self.edited("whole/run_000003.json", broken)
            for folders in (("whole", "other"), ("other", "whole")):
                said = self.refused_soon("campaign", "--compare", *folders)
                self.assertIn("whole/run_000003.json", said)
                self.assertIn(why, said)

    def test_nothing_is_merged_of_a_damaged_run(self):
        original = (self.folder / "half1" / "run_000003.json").read_text(encoding="utf-8")
        for broken in self.broken_runs():
            (self.folder / "half1" / "run_000003.json").write_text(original, encoding="utf-8")
            self.edited("half1/run_000003.json", broken)
            self.assertIn("half1/run_000003.json", self.refused_soon("campaign", "--merge", "half1", "half2", "--out", "merged"))

    def test_damaged_campaigns(self):
        def change(*path, value):
            def edit(campaign):
                for key in path[:-1]:
                    campaign = campaign[key]
                campaign[path[-1]] = value
            return edit
        cases = ((change("arguments", "runs", value=10**9), "arguments.runs = 1000000000, must be a whole number, in 1..1000000"),
                 (change("arguments", "runs", value=-1), "arguments.runs = -1"),
                 (change("arguments", "runs", value=2.5), "arguments.runs = 2.5"),
                 (change("arguments", "shard", value=[2, 2**64 - 1]), "arguments.shard"),
                 (change("arguments", "shard", value=[3, 2]), "arguments.shard"),
                 (change("arguments", "shard", value=[]), "arguments.shard"),
                 (change("arguments", "first_seed", value=2**64 - 1), "arguments.first_seed"),
                 (change("arguments", "track", value=[1]), "arguments.track = [1], must be text"),
                 (change("arguments", "vision", value=None), "arguments.vision is missing"),
                 (change("arguments", "commit", value=7), "arguments.commit = 7, must be text"),
                 (change("arguments", "config", value="x"), "arguments.config"),
                 (change("arguments", value=[]), "arguments = []"),
                 (change("fly", value={}), "fly = {}, must be text"),
                 ("", "is damaged"), ("[1]", "must be an object"), (self.DEEP, "is nested more than 64 levels deep"),
                 ('{"arguments":' * 50_000, "is nested more than 64 levels deep"))
        for edit, why in cases:
            shutil.copy(self.whole.parent / "half1" / "campaign.json", self.folder / "half1" / "campaign.json")
            self.edited("half1/campaign.json", edit)
            for arguments in (("--compare", "half1", "whole"), ("--compare", "whole", "half1"), ("--merge", "half1", "half2", "--out", "merged"),
                              ("oval", "--runs", "4", "--vision", "ideal", "--laps", "1", "--compare", "half1", "--out", "new")):
                said = self.refused_soon("campaign", *arguments)
                self.assertIn("half1/campaign.json:", said)
                self.assertIn(why, said)

    def test_runs_of_any_shape_are_listed(self):
        for number, broken in enumerate(self.broken_runs()):
            shutil.copy(self.folder / "whole" / "run_000001.json", self.folder / "whole" / "run_000002.json")
            self.edited("whole/run_000002.json", broken)
            process = subprocess.Popen([GATEFLY, "view", "whole"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            try:
                import urllib.request
                with urllib.request.urlopen(process.stdout.readline().strip(), timeout=20) as answer:
                    page = answer.read().decode()
                for seed in (1, 3, 4):
                    self.assertIn(f"oval-{seed}", page, number)
            finally:
                process.terminate()
                process.wait(timeout=20)
                process.stdout.close()


class Recordings(ForeignFiles):
    def setUp(self):
        super().setUp()
        self.flight = pathlib.Path(shutil.copytree(OVAL, self.folder / "flight"))
        self.log = next(self.flight.glob("log_si.csv*"))

    def text(self):
        content = self.log.read_bytes()
        return gzip.decompress(content) if self.log.suffix == ".gz" else content

    def with_log(self, packed):
        self.log.unlink()
        self.log = self.flight / "log_si.csv.gz"
        self.log.write_bytes(packed)

    def test_a_log_of_two_members_is_read_to_its_end(self):
        before = json.loads(self.run_it("replay", self.flight, "--json").stdout)
        lines = self.text().splitlines(keepends=True)
        half = len(lines) // 2
        self.with_log(gzip.compress(b"".join(lines[:half])) + gzip.compress(b"".join(lines[half:])))
        after = json.loads(self.run_it("replay", self.flight, "--json").stdout)
        self.assertEqual(after, before)

    def test_a_small_file_that_unpacks_to_gigabytes(self):
        header = self.text().splitlines(keepends=True)[0]
        rows = b"0" + b"," * header.count(b",") + b"\n"
        self.with_log(gzip.compress(header + rows * 3_000_000, 9))
        self.assertIn("unpacks to more than 32 times its size", self.refused_soon("replay", self.flight))

    def test_a_damaged_summary_is_said_to_be_damaged(self):
        self.assertEqual(self.run_it("fly", "oval", "--laps", "1", "-q", "--out", "flown", "--set", "sim.timeout_s=1").returncode, 1)
        whole = (self.folder / "flown" / "summary.json").read_text(encoding="utf-8")
        for text, why in ((whole[:len(whole) // 2], "is damaged"), ("[" * 50_000, "nested more than 64"), ("{}", "does not say the flight's seed")):
            (self.folder / "flown" / "summary.json").write_text(text, encoding="utf-8")
            for command in (("replay", "flown"), ("map", "flown", "--out", "learnt.toml")):
                said = self.refused_soon(*command)
                self.assertIn("flown/summary.json: ", said)
                self.assertIn(why, said)

    def test_pictures_of_another_size(self):
        (self.flight / "summary.json").unlink(missing_ok=True)
        table = (self.flight / "images.csv").read_text(encoding="utf-8").splitlines()
        columns = table[0].split(",")
        first = dict(zip(columns, table[1].split(",")))
        keep = [i for i, name in enumerate(columns) if name != "xxh64"]
        name = "small.ppm"
        first["image"] = name
        (self.flight / "images.csv").write_text(",".join(columns[i] for i in keep) + "\n" + ",".join(first[columns[i]] for i in keep) + "\n",
                                                encoding="utf-8")
        (self.flight / name).write_bytes(picture())
        for film in self.flight.glob("frames.*"):
            film.unlink()
        said = self.refused_soon("replay", self.flight)
        self.assertIn("small.ppm: is 160 x 120, the camera's as stored ", said)

    def test_a_pipe_in_a_folder_is_not_waited_for(self):
        (self.flight / "images.csv").unlink()
        os.mkfifo(self.flight / "images.csv")
        self.assertIn("images.csv: is a pipe", self.refused_soon("replay", self.flight))


class Cameras(ForeignFiles):
    def test_no_camera_that_detect_refuses_is_written(self):
        for old, new in (("300.0, 300.0", "1e9, 300.0"), ("320, 240", "1000000, 240"), ("320, 240", "3e300, 240"), ("320, 240", "0.5, 240"),
                         ("160.0, 120.0", "1e12, 120.0"), ("none\n  distortion_coeffs: []", "radtan\n  distortion_coeffs: [1e9, 0, 0, 0]")):
            camera = self.file("cam.yaml", KALIBR.replace(old, new))
            for form in ("toml", "kalibr", "ros"):
                self.assertIn("cam.yaml", self.refused_soon("calibrate", "--from", camera, "--to", form, "--out", "camera.toml"))
        self.assertEqual(self.run_it("calibrate", "--from", self.file("cam.yaml", KALIBR), "--out", "camera.toml").returncode, 0)
        (self.folder / "a.ppm").write_bytes(picture())
        self.assertEqual(self.run_it("detect", "a.ppm", "--config", "camera.toml").returncode, 0)

    def test_a_files_name_is_no_configuration(self):
        camera = self.file("x\n[control]\nspeed_mps = 9.0\n#.yaml", KALIBR)
        result = self.run_it("calibrate", "--from", camera, "--out", "camera.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("\n[control]", (self.folder / "camera.toml").read_text(encoding="utf-8"))

    def test_foreign_yaml(self):
        for text in ("[" * 50_000, "{a: " * 50_000, "? [1]\n: {intrinsics: 1}\n", "a: &a [*a]\n", "cam0: {intrinsics: [1]}", "- " * 50_000, "\x00",
                     "cam0:\n" + "  x: 1\n" * 100_000, "%" * 1000):
            self.refused_soon("calibrate", "--from", self.file("cam.yaml", text), "--out", "camera.toml")

    def test_foreign_tables(self):
        self.file("labels.csv", LABELS)
        for text in ("image" + ",a" * 1_000_000 + "\n", "\n" * 100_000, "image\n" + "a\n" * 100_000, "\x1b[2J,b\n1,2\n"):
            said = self.refused_soon("score", "--detections", self.file("found.csv", text), "--labels", "labels.csv")
            self.assertNotIn("\x1b", said)


if __name__ == "__main__":
    main()
