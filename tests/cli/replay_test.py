#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly replay and render: a short flight flown again, damaged in many ways; labelled pictures.

usage: replay_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import gzip
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest

from program import GATEFLY, Cli, main


class Replay(Cli):
    """One short rendered flight, which keeps no pictures, damaged in many ways."""
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-flight-")
        cls.addClassCleanup(folder.cleanup)
        cls.common_cache = pathlib.Path(folder.name) / "cache"
        cls.flight = pathlib.Path(folder.name) / "flight"
        cls.fly("--out", cls.flight)

    @classmethod
    def fly(cls, *arguments):
        environment = dict(os.environ, XDG_CACHE_HOME=str(cls.common_cache))
        subprocess.run([GATEFLY, "fly", "oval", "--laps", "1", "--quiet", "--set", "sim.timeout_s=5", *arguments],
                       env=environment, capture_output=True, timeout=120, check=False)

    def setUp(self):
        super().setUp()
        self.cache = self.common_cache  # replay renders the room, whose light is baked once

    def copy(self, flight=None):
        """The flight's log as a text to be edited."""
        shutil.rmtree(self.folder / "flight", ignore_errors=True)
        copy = pathlib.Path(shutil.copytree(flight or self.flight, self.folder / "flight"))
        packed = copy / "log_si.csv.gz"
        (copy / "log_si.csv").write_bytes(gzip.decompress(packed.read_bytes()))
        packed.unlink()
        return copy

    def edited(self, name, edit):
        path = self.copy() / name
        path.write_text(edit(path.read_text(encoding="utf-8")), encoding="utf-8")
        return path.parent

    def to_the_bit(self, *arguments, **variables):
        result = self.run_it("replay", *arguments, **variables)
        self.assertEqual((result.returncode, "to the bit" in result.stdout, result.stderr), (0, True, ""), result.stdout + result.stderr)

    def test_as_it_is_it_comes_out_to_the_bit(self):
        self.assertEqual(sorted(path.name for path in self.flight.iterdir()),
                         ["config-0.toml", "detections.csv", "flight.mcap", "images.csv", "log_si.csv.gz", "report.html", "settings.txt",
                          "summary.json", "track.toml"])
        self.to_the_bit(self.flight)
        self.to_the_bit(self.copy())  # unpacked
        answer = json.loads(self.run_it("replay", self.flight, "--json").stdout)
        self.assertEqual((answer["pictures_from"], answer["pictures_other"]), ("rendered", 0))
        self.assertEqual(answer["pictures_checked"], answer["pictures"])

    def test_it_counts_found_gates_as_the_flight_did(self):
        flown = json.loads((self.flight / "summary.json").read_text())["detection"]
        self.assertGreater(flown["with_gate_visible"], 10)
        replayed = json.loads(self.run_it("replay", self.flight, "--json").stdout)
        self.assertEqual(replayed["next_gate"], {"shown": flown["with_gate_visible"], "found": flown["true_positives"]})
        words = f"{flown['with_gate_visible']} show the next gate whole: in {flown['true_positives']} found"
        self.assertIn(words, self.run_it("replay", self.flight).stdout)
        blind = json.loads(self.run_it("replay", self.flight, "--json", "--set", "detector.min_score=9").stdout)
        self.assertEqual(blind["next_gate"], {"shown": flown["with_gate_visible"], "found": 0})

    def test_errors_are_counted_from_the_gate_and_in_earth_axes(self):
        answer = json.loads(self.run_it("replay", self.flight, "--json").stdout)
        for frame in ("gate_frame", "earth_frame"):
            self.assertEqual(len(answer[frame]["rms_m"]), 3)
            self.assertLess(max(answer[frame]["rms_m"]), 0.5)
            self.assertGreater(answer[frame]["nees"]["samples"], 5)
        self.assertGreater(answer["nis"]["samples"], 5)
        self.assertLess(answer["known_to_m"], 0.5)
        self.assertIsNone(answer["unknown"])
        self.assertEqual(len(answer["found"]["heading_deg"]), 2)
        stood = json.loads((self.flight / "summary.json").read_text())["true_gates"]
        self.assertEqual([sorted(gate) for gate in stood], 2 * [["heading_deg", "position_m"]])
        text = self.run_it("replay", self.flight).stdout
        for words in ("from the gate   rms x", "in earth axes   rms x", "NEES/3", "NIS/dof", "heading "):
            self.assertIn(words, text)
        # An older flight does not say where its gates stood.
        older = self.edited("summary.json", lambda text: text.replace('"true_gates"', '"other"'))
        self.assertIsNone(json.loads(self.run_it("replay", older, "--json").stdout)["gate_frame"])

    def test_who_sees_nothing_says_that_the_position_is_unknown(self):
        blind = self.run_it("replay", self.flight, "--set", "detector.min_score=9")
        self.assertEqual(blind.returncode, 1, blind.stderr)
        self.assertIn("unknown: no gate of the map was seen in ", blind.stdout)

    def test_trajectories_are_written_as_evo_reads_them(self):
        result = self.run_it("replay", self.flight, "--tum", "est.txt", "--csv", "est.csv")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        estimate, truth = ([[float(word) for word in line.split()] for line in (self.folder / name).read_text().splitlines()[1:]]
                           for name in ("est.txt", "est.truth.txt"))
        header, *rows = (self.folder / "est.csv").read_text().splitlines()
        log = gzip.decompress((self.flight / "log_si.csv.gz").read_bytes()).decode().splitlines()
        of_log = dict(zip(log[0].split(","), log[-1].split(",")))
        self.assertEqual({len(estimate), len(truth), len(rows)}, {len(log) - 1})
        self.assertEqual([row[0] for row in estimate], [row[0] for row in truth])
        self.assertEqual(estimate[-1][:4], [float(cell) for cell in rows[-1].split(",")[:4]])
        self.assertEqual(truth[-1][1:4], [float(of_log[name]) for name in ("ot_x_m", "ot_y_m", "ot_z_m")])
        for row, prefix in ((estimate[-1], "est"), (truth[-1], "true")):  # qx qy qz qw: body to north, east, down
            x, y, z, w = row[4:]
            self.assertAlmostEqual(x * x + y * y + z * z + w * w, 1, places=12)
            self.assertAlmostEqual(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)), float(of_log[prefix + "_yaw_rad"]), places=9)
            self.assertAlmostEqual(math.asin(2 * (w * y - z * x)), float(of_log[prefix + "_pitch_rad"]), places=9)
        self.assertEqual(self.run_it("replay", self.flight, "--tum", "est.txt").returncode, 0)  # its own kind is replaced

    def test_a_trajectory_replaces_nothing_of_the_users(self):
        copy = self.copy()
        for path in (copy / "log_si.csv", copy / "images.csv"):
            self.assertIn(path.name, self.refused("replay", copy, "--tum", path, "--force"))
        self.file("est.truth.txt", "notes\n")
        self.assertIn("est.truth.txt", self.refused("replay", copy, "--tum", "est.txt"))
        self.assertIn("writes two files", self.refused("replay", copy, "--tum", "-"))

    def test_another_pilot_sees_the_same_pictures(self):
        answer = json.loads(self.run_it("replay", self.flight, "--json", "--set", "control.speed_mps=1.1", "--set",
                                        "camera.latency_ms=35").stdout)
        self.assertEqual((answer["pictures_other"], answer["same_as_recorded"]), (0, False))

    def test_pictures_that_come_out_otherwise_are_said_once(self):
        other = self.edited("images.csv", lambda text: re.sub(r"(frame_0000[34].*),\w{16}", r"\1,0123456789abcdef", text))
        result = self.run_it("replay", other)
        self.assertEqual((result.returncode, "to the bit" in result.stdout), (0, True), result.stderr)
        self.assertRegex(result.stderr, r"^gatefly replay: 2 of \d+ pictures are not those of the flight, by their hashes, from "
                                        r"frame_00003.uyvy on: another version than .* or another kind of processor renders them otherwise"
                                        r", or the folder was changed\n$")
        other = self.edited("summary.json", lambda text: text.replace('"seed": 1', '"seed": 2'))
        result = self.run_it("replay", other)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stderr.count("are not those of the flight"), 1)
        self.assertIn("images.csv:2:5: 'abc', must be 16 hexadecimal digits", self.refused("replay", self.edited(
            "images.csv", lambda text: re.sub(r",\w{16}", ",abc", text, count=1))))

    def test_a_packed_log_that_is_damaged_is_one_line(self):
        packed = (self.flight / "log_si.csv.gz").read_bytes()
        middle = len(packed) // 2
        for content, said in ((b"", "is cut off"), (packed[:middle], "is cut off"), (b"t_ns,t_s\n1,1\n", "is no gzip file"),
                              (packed[:middle] + bytes(200) + packed[middle + 200:], "is damaged")):
            shutil.rmtree(self.folder / "flight", ignore_errors=True)
            shutil.copytree(self.flight, self.folder / "flight")
            (self.folder / "flight" / "log_si.csv.gz").write_bytes(content)
            self.assertIn(f"log_si.csv.gz: {said}", self.refused("replay", "flight"))

    def test_what_is_no_flight_is_one_line(self):
        (self.folder / "empty").mkdir()
        for given, said in (("empty", "empty/log_si.csv: cannot be read"), ("nowhere", "nowhere"), (self.file("a.txt", "hello"), "is no folder"),
                            (self.flight / "flight.mcap", "flight.mcap: is no folder"), (self.flight.parent / "cache", "log_si.csv: cannot be read")):
            self.assertIn(said, self.refused("replay", given))

    def test_what_a_killed_flight_left_is_one_line(self):
        with subprocess.Popen([GATEFLY, "fly", "oval", "--quiet", "--out", "X"], cwd=self.folder, stderr=subprocess.DEVNULL,
                              env=dict(os.environ, XDG_CACHE_HOME=str(self.cache))) as process:
            deadline = time.monotonic() + 60
            while not (self.folder / "X.partial" / "settings.txt").exists() and time.monotonic() < deadline:
                time.sleep(0.01)
            time.sleep(1.0)
            process.kill()
        self.assertIn("X.partial/log_si.csv.gz: is cut off", self.refused("replay", "X.partial"))

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg here")
    def test_kept_frames_are_replayed_to_the_bit(self):
        kept = self.folder / "kept"
        self.fly("--frames", "--out", kept)
        self.assertEqual((kept / "images.csv").read_bytes(), (self.flight / "images.csv").read_bytes())
        self.to_the_bit(kept)
        answer = json.loads(self.run_it("replay", kept, "--json").stdout)
        self.assertEqual((answer["pictures_from"], answer["pictures_other"]), ("film", 0))
        self.assertEqual(answer["pictures_checked"], answer["pictures"])
        # Without what renders them: the film is enough.
        for nonsense in ("", "{oops", "[]", '{"config": 7, "detection": [], "vision": 3, "flight_time_s": "x"}'):
            (kept / "summary.json").write_text(nonsense, encoding="utf-8")
            self.to_the_bit(kept)

        # As flights were before: each frame in its file, no hashes.
        raw = subprocess.run(["ffmpeg", "-v", "error", "-i", kept / "frames.mkv", "-f", "rawvideo", "-pix_fmt", "yuv422p", "-"],
                             capture_output=True, check=True, timeout=120).stdout
        size = 160 * 315 * 2
        old = self.copy(kept)
        images = (old / "images.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(raw), size * (len(images) - 1))
        for i, row in enumerate(images[1:]):
            planes, frame = raw[i * size:(i + 1) * size], bytearray(size)
            frame[1::2], frame[0::4], frame[2::4] = planes[:size // 2], planes[size // 2:3 * size // 4], planes[3 * size // 4:]
            (old / row.split(",")[0]).write_bytes(frame)
        (old / "images.csv").write_text("".join(",".join(row.split(",")[:4]) + "\n" for row in images), encoding="utf-8")
        (old / "frames.mkv").unlink()
        self.to_the_bit(old)
        answer = json.loads(self.run_it("replay", old, "--json").stdout)
        self.assertEqual((answer["pictures_from"], answer["pictures_checked"]), ("files", 0))
        (old / "frame_00003.uyvy").unlink()
        self.assertIn("frame_00003.uyvy: cannot be read", self.refused("replay", "flight"))

        # A film that is damaged, cut off, foreign, empty.
        film = (kept / "frames.mkv").read_bytes()
        for content in (b"", b"hello", film[:len(film) // 2]):
            (kept / "frames.mkv").write_bytes(content)
            self.assertIn("kept/frames.mkv: ", self.refused("replay", "kept"))
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "lavfi", "-i", "testsrc=size=64x48", "-frames:v", "99", "-c:v", "ffv1",
                        kept / "frames.mkv"], check=True, timeout=60)
        self.assertIn("frames.mkv: its pictures are 64 x 48, the camera's as stored 160 x 315", self.refused("replay", "kept"))

    def test_without_ffmpeg_frames_are_refused_before_the_flight(self):
        self.assertIn("ffmpeg: No such file or directory; --frames needs it (apt-get install ffmpeg)",
                      self.refused("fly", "oval", "--frames", PATH="/nowhere"))

    def test_what_fly_wrote_must_be_there(self):
        for name in ("images.csv", "track.toml", "settings.txt", "config-0.toml"):
            (self.copy() / name).unlink()
            self.assertIn(f"{name}: is missing, gatefly fly has put it there", self.refused("replay", "flight"))
        for name, content in (("track.toml", "name = 3"), ("config-0.toml", "[camera]\nfoo = 3\n")):
            (self.copy() / name).write_text(content, encoding="utf-8")
            self.assertIn(f"flight/{name}", self.refused("replay", "flight"))
        log = self.copy() / "log_si.csv"
        log.write_text(re.sub("motor_lb_radps", "motor_x_radps", log.read_text(encoding="utf-8")), encoding="utf-8")
        self.assertIn("log_si.csv:2: has no rotor speeds", self.refused("replay", "flight"))

    def test_rows_that_were_deleted_are_named(self):
        def without(row):
            return lambda text: "".join(line for i, line in enumerate(text.splitlines(True)) if i != row)
        self.assertIn("images.csv:16: came at", self.refused("replay", self.edited("log_si.csv", without(600))))
        self.assertIn("log_si.csv: ends at 5", self.refused("replay", self.edited(
            "summary.json", lambda text: text.replace('"flight_time_s": ', '"flight_time_s": 9'))))
        self.assertIn("images.csv: has ", self.refused("replay", self.edited("images.csv", without(20))))

    def test_a_number_that_was_changed_is_found_in_what_comes_out(self):
        def without_a_gyro(text):
            lines = text.splitlines(True)
            cells = lines[1200].split(",")
            lines[1200] = ",".join((*cells[:3], "", *cells[4:]))
            return "".join(lines)
        result = self.run_it("replay", self.edited("log_si.csv", without_a_gyro))
        self.assertEqual(result.returncode, 1)
        self.assertIn("other estimates from log_si.csv:1201 on", result.stdout)
        first = self.copy().joinpath("log_si.csv").read_text().splitlines()[1].split(",")[2]
        for wrong in ("x", "nan", "1e999"):
            self.assertIn(f"log_si.csv:2:3: gyro_p_radps = '{wrong}'", self.refused("replay", self.edited(
                "log_si.csv", lambda text: text.replace(f",{first},", f",{wrong},", 1))))

    def test_other_settings_are_named_and_the_users_own_are_no_fault(self):
        result = self.run_it("replay", self.edited("settings.txt", lambda text: text + "filter.sonar_sigma_m=0.5\n"))
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertIn("filter.sonar_sigma_m is 0.5, was ", result.stdout)
        told = self.run_it("replay", self.copy(), "--set", "filter.sonar_sigma_m=0.5", "--json")
        self.assertEqual((told.returncode, json.loads(told.stdout)["same_as_recorded"]), (0, False))
        for laps in ("many", "99999999999", "0", "2x", ""):
            error = self.refused("replay", self.edited("settings.txt", lambda text: f"laps={laps}\n"))
            self.assertIn(f"settings.txt: laps={laps}, must be a whole number in 1..100", error)

    def test_a_flight_from_before_a_key_was_renamed_comes_out_to_the_bit(self):
        self.edited("summary.json", lambda text: text.replace('"random_sigma_px"', '"white_px"'))
        path = self.folder / "flight" / "settings.txt"
        settings = path.read_text(encoding="utf-8")
        path.write_text(settings + "pose.white_px=0.35\n", encoding="utf-8")
        result = self.run_it("replay", "flight")
        self.assertEqual((result.returncode, "to the bit" in result.stdout), (0, True), result.stdout + result.stderr)
        # The fixes' errors are the drag filter's business: without the sonar the estimates are others.
        path.write_text(settings + "pose.white_px=0.5\nvehicle.sonar=none\n", encoding="utf-8")
        self.assertIn("pose.random_sigma_px is 0.5, was 0.35 in flight", self.run_it("replay", "flight").stdout)

    def test_a_summary_that_is_nonsense_does_not_say_the_seed(self):
        no_seed = "does not say the flight's seed, without which its pictures cannot be rendered again"
        for nonsense, why in (("", "is damaged"), ("{oops", "is damaged"), ("[]", no_seed),
                              ('{"config": 7, "detection": [], "vision": 3, "flight_time_s": "x", "seed": -1}', no_seed)):
            self.assertIn(f"summary.json: {why}", self.refused("replay", self.edited("summary.json", lambda text: nonsense)))

    def test_a_flight_without_pictures_and_a_summary_that_is_nonsense(self):
        self.run_it("fly", "oval", "--vision", "ideal", "--set", "sim.timeout_s=1", "--out", "drawn", "-q")
        for nonsense in ("", "{oops", "\x00"):
            (self.folder / "drawn" / "summary.json").write_text(nonsense, encoding="utf-8")
            self.assertIn("images.csv: lists no picture, and summary.json does not say that there was none", self.refused("replay", "drawn"))

    def test_a_wrong_setting_of_the_folder_is_not_blamed_on_set(self):
        for wrong, said in (("nonsense", "settings.txt nonsense: must be section.key=value"), ("camera.foo=3", "settings.txt: camera.foo is not a known key")):
            self.assertIn(said, self.refused("replay", self.edited("settings.txt", lambda text: wrong + "\n" + text)))

    def test_a_picture_listed_twice_is_refused(self):
        twice = self.edited("images.csv", lambda text: text.replace("frame_00007.uyvy", "frame_00006.uyvy"))
        self.assertIn("images.csv:9: image = 'frame_00006.uyvy', a second time", self.refused("replay", twice))

    def test_a_damaged_flight_among_others_is_named_and_the_rest_is_done(self):
        self.edited("log_si.csv", lambda text: text[:len(text) // 2].rsplit(",", 2)[0] + "\n").rename(self.folder / "a")
        shutil.copytree(self.flight, self.folder / "b")
        result = self.run_it("identify", ".")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertRegex(result.stderr, r"a/log_si.csv:\d+: has \d+ cells")
        self.assertRegex(result.stdout, r"b: \d+ pictures corrected the filter")

    def test_it_is_found_in_the_data_folder(self):
        for given, variable in ((("--data", self.flight.parent), ""), ((), str(self.flight.parent))):
            self.assertEqual(self.run_it("replay", "flight", *given, GATEFLY_DATA=variable).returncode, 0)
        self.assertIn("no-such-folder", self.refused("replay", "flight", "--data", "no-such-folder"))

    def test_what_pages_call_shared_data_is_looked_for_where_the_data_is(self):
        result = self.run_it("replay", "../shared/data/flight", GATEFLY_DATA=str(self.flight.parent))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, f"gatefly: ../shared/data/flight: is not there, taken from {self.flight}\n")
        self.assertIn("../shared/data/other", self.refused("replay", "../shared/data/other", GATEFLY_DATA=str(self.flight.parent)))

    def test_what_pages_try_things_on_comes_with_the_program(self):
        self.assertEqual(self.run_it("replay", "tests/replay/oval_flight").returncode, 0)
        self.assertEqual(self.run_it("track", "tests/courses/spiral.toml").returncode, 0)

    def test_a_flight_with_a_fitted_colour_table_carries_it(self):
        colors = "\n".join(f"{name} = {16 * [1024 * 'h']}" for name in ("absolute", "relative"))
        (self.folder / "mine").mkdir()
        table = self.file("mine/my.colors.toml", "version = 1\n" + colors + "\n")
        config = self.file("mine/mine.toml", '[color]\ntable = "my.colors.toml"\n')
        short = ("oval", "--set", "sim.timeout_s=2", "--quiet")
        for k, given in enumerate((("--config", config), ("--set", f"color.table={table}"))):
            self.assertEqual(self.run_it("fly", *short, *given, "--out", f"tabled{k}").returncode, 1)
        race = ("campaign", "oval", "--runs", "1", "--vision", "ideal", "--laps", "1", "--quiet", "--config", config, "--out", "races")
        self.assertEqual(self.run_it(*race).returncode, 0)
        (self.folder / "mine").rename(self.folder / "elsewhere")
        for k in range(2):
            result = self.run_it("replay", f"tabled{k}")
            self.assertIn("to the bit", result.stdout, result.stderr)
        moved = [str(word).replace("/mine/", "/elsewhere/") for word in race]
        self.assertEqual(self.run_it(*moved).returncode, 0)  # the same table, wherever it lies
        other = self.folder / "elsewhere" / "my.colors.toml"
        other.write_text(other.read_text().replace("hhhh", "hhih", 1))
        self.assertIn("the colour table has changed", self.refused(*moved))


class Render(Cli):
    ORDER = ("render", "oval", "--frames", "6", "--per-day", "3", "--quiet")

    def table(self, name):
        header, *rows = (self.folder / name).read_text().splitlines()
        return [dict(zip(header.split(","), row.split(","))) for row in rows]

    def test_pictures_have_labels_poses_and_masks_that_detect_and_score_read(self):
        result = self.run_it(*self.ORDER, "--masks", "--around", "50", "--out", "p")
        self.assertEqual(result.returncode, 0, result.stderr)
        images = [f"img_{i:05}.jpg" for i in range(6)]
        self.assertEqual(sorted(path.name for path in (self.folder / "p").glob("img_*")), images)
        self.assertEqual(len(list((self.folder / "p").glob("mask_*.pgm"))), 6)
        labels, poses, gates = self.table("p/labels.csv"), self.table("p/poses.csv"), self.table("p/gates.csv")
        self.assertEqual(list(dict.fromkeys(row["image"] for row in labels)), images)
        self.assertEqual([row["image"] for row in poses], images)
        self.assertEqual([row["seed"] for row in poses], ["1"] * 3 + ["2"] * 3)
        self.assertEqual({row["pose"] for row in poses}, {"race", "around"})
        whole = [row for row in gates if row["whole"] == "1"]
        self.assertEqual(len(whole), sum(row["has_gate"] == "1" for row in labels))
        for row in gates:
            self.assertEqual(row["whole"] == "1", all(row[f"{corner}_seen"] == "1" for corner in ("tl", "tr", "br", "bl")))
        self.assertIn("(EXIF)", self.run_it("detect", "p", "--csv", "found.csv").stderr)
        scored = self.run_it("score", "--detections", "found.csv", "--labels", "p/labels.csv", "--json")
        self.assertEqual(scored.returncode, 0, scored.stderr)

    def test_the_same_pictures_whatever_the_threads_and_other_ones_from_another_seed(self):
        for name, more in (("a", ("--jobs", "1")), ("b", ("--jobs", "2")), ("c", ("--seed", "5"))):
            self.assertEqual(self.run_it(*self.ORDER, *more, "--recording", "mjpeg-low", "--out", name).returncode, 0)
        content = {name: [(path.name, path.read_bytes()) for path in sorted((self.folder / name).glob("*.[jc]*"))] for name in "abc"}
        pictures = {name: [each for each in content[name] if each[0] != "render.json"] for name in "abc"}
        self.assertEqual(pictures["a"], pictures["b"])
        self.assertNotEqual(pictures["a"], pictures["c"])

    def test_varied_seeds_have_masks_where_the_labels_say(self):
        order = ("render", "oval", "--frames", "8", "--per-day", "2", "--quiet", "--varied", "--fast", "--masks",
                 "--around", "100", "--recording", "varied")
        for name in "ab":
            result = self.run_it(*order, "--jobs", "1" if name == "a" else "2", "--out", name)
            self.assertEqual(result.returncode, 0, result.stderr)
        files = [[(path.name, path.read_bytes()) for path in sorted((self.folder / name).glob("*_*"))] for name in "ab"]
        self.assertEqual(files[0], files[1])
        corners = 0
        for row in self.table("a/gates.csv"):
            if float(row["distance_m"]) > 5.0:
                continue
            mask = (self.folder / "a" / row["image"].replace("img", "mask").replace("jpg", "pgm")).read_bytes()[-315 * 160:]
            for corner in ("tl", "tr", "br", "bl"):
                u, v = (round(float(row[f"{corner}_{axis}"])) for axis in "uv")
                if row[f"{corner}_seen"] == "1" and 3 <= u < 312 and 3 <= v < 157:
                    corners += 1
                    near = {mask[(v + j) * 315 + u + i] for i in range(-3, 4) for j in range(-3, 4)}
                    self.assertIn(int(row["gate"]), near, row)
        self.assertGreater(corners, 4)

    def test_unusable_arguments(self):
        self.assertIn("--frames", self.refused("render", "oval"))
        self.assertIn("--frames", self.refused("render", "oval", "--frames", "0"))
        self.assertIn("--recording", self.refused("render", "oval", "--frames", "1", "--recording", "mp4"))
        thesis = self.folder / "thesis"
        thesis.mkdir()
        (thesis / "chapter1.tex").write_text("years of work", encoding="utf-8")
        self.assertIn("thesis", self.refused("render", "oval", "--frames", "1", "--out", thesis))


if __name__ == "__main__":
    main()
