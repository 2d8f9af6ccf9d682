#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The program from outside: exit codes, one line on stderr, and that it says what is allowed.

usage: cli_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
Nothing here renders or flies but the few seconds of Video: every other case is refused before take-off, or
only prints.
"""
import gzip
import html.parser
import json
import math
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest

GATEFLY = ""
ROOT = pathlib.Path()

GATE = "[[gates]]\nposition_m = [3.0, 0.0, -1.5]\n"


class Cli(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.cache = self.folder / "cache"

    def run_it(self, *arguments, preexec_fn=None, **variables):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.cache), **variables)
        return subprocess.run([GATEFLY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder,
                              env=environment, timeout=120, check=False, preexec_fn=preexec_fn)

    def file(self, name, content):
        path = self.folder / name
        path.write_text(content, encoding="utf-8")
        return path

    def refused(self, *arguments, **variables):
        """Runs what must be refused: exit 2, nothing on stdout, one line on stderr, nothing left behind."""
        before = sorted(path for path in self.folder.rglob("*"))
        result = self.run_it(*arguments, **variables)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(sorted(path for path in self.folder.rglob("*")), before)
        return result.stderr

    def fly_track(self, content):
        return self.refused("fly", self.file("mine.toml", content))


class Help(Cli):
    def test_help_of_the_program_and_every_command_has_an_example(self):
        listing = self.run_it("--help")
        self.assertEqual(listing.returncode, 0)
        for command in ("fly", "config", "detect", "score", "campaign", "bench", "calibrate", "identify", "tune", "reproduce",
                        "track", "doctor", "new"):
            self.assertIn(command, listing.stdout)
            text = self.run_it(command, "--help")
            self.assertEqual(text.returncode, 0)
            self.assertEqual(text.stderr, "")
            self.assertIn("Example", text.stdout)
            self.assertIn("gatefly " + command, text.stdout)
            for flag in ("--config", "--set", "--quiet"):
                self.assertIn(flag, text.stdout)

    def test_version(self):
        result = self.run_it("--version")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stdout, r"^gatefly \d+\.\d+\.\d+\n$")


class Words(Cli):
    """What the program says of itself and of its work."""
    def test_help_and_version_are_commands_too(self):
        self.assertEqual(self.run_it("help", "fly").stdout, self.run_it("fly", "--help").stdout)
        self.assertEqual(self.run_it("help", "tune").stdout, self.run_it("tune", "--help").stdout)  # the sibling's
        self.assertEqual(self.run_it("help").stdout, self.run_it("--help").stdout)
        self.assertEqual(self.run_it("version").stdout, self.run_it("--version").stdout)
        self.assertIn("did you mean 'fly'", self.refused("help", "flyy"))

    def test_help_shows_config_and_set_as_they_are_taken(self):
        text = self.run_it("fly", "--help").stdout
        for flag in ("--config FILE", "--set SECTION.KEY=VALUE"):
            self.assertIn(flag, text)
            self.assertNotIn(flag + " ...", text)
        slow, fast = self.file("slow.toml", "[control]\nspeed_mps = 1.1\n"), self.file("fast.toml", "[control]\nspeed_mps = 1.9\n")
        both = self.run_it("config", "--json", "--config", slow, "--config", fast, "--set", "camera.tilt_deg=1", "--set", "camera.rate_hz=9")
        answer = json.loads(both.stdout)
        self.assertEqual((answer["control"]["speed_mps"], answer["camera"]["tilt_deg"], answer["camera"]["rate_hz"]), (1.9, 1, 9))
        self.refused("config", "--config", slow, fast)

    def test_counts_of_fly_and_replay_say_what_they_count(self):
        flown = self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1")
        self.assertRegex(flown.stdout, r"detection +\d+ pictures, \d+ show the next gate whole: in \d+ found, \d+ false detections")

    def test_a_narrow_terminal_gets_one_line_of_progress(self):
        import fcntl, pty, struct, termios
        for columns in (20, 30, 60):
            terminal, end = pty.openpty()
            fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
            program = subprocess.Popen([GATEFLY, "fly", "oval", "--laps", "100", "--vision", "ideal", "--set", "sim.timeout_s=400",
                                        "--out", str(columns)],
                                       cwd=self.folder, stdout=subprocess.DEVNULL, stderr=end)
            os.close(end)
            said = b""
            try:
                while piece := os.read(terminal, 65536):
                    said += piece
            except OSError:  # the other end is closed
                pass
            program.wait()
            os.close(terminal)
            updates = said.decode().split("\r\x1b[K")[1:]
            self.assertGreater(len(updates), 2)
            self.assertLess(max(map(len, updates)), columns)


class Bench(Cli):
    def test_costs_of_a_pattern_stand_beside_their_baseline(self):
        result = self.run_it("bench", "--pictures", "checker:8", "gate", "--stage", "snakes", "flown", "--quick", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        stages = json.loads(result.stdout)["detection"]
        self.assertEqual([stage["name"] for stage in stages], ["snakes", "flown"])
        for stage in stages:
            self.assertGreater(stage["median_us"], 0)
            self.assertLessEqual(stage["median_us"], stage["max_us"])

    def test_one_call_a_picture_names_the_pictures(self):
        result = self.run_it("bench", "--once", "--stage", "careful", "--pictures", "all", "noise:4:0.1:0")
        self.assertEqual((result.returncode, result.stdout.splitlines()), (0, ["all:0.5:0.5:0.5", "noise:4:0.1:0"]))

    def test_what_it_does_not_know_is_said(self):
        self.assertIn("did you mean 'careful'", self.refused("bench", "--stage", "carefull", "--pictures", "all"))
        self.assertIn("there are: gate, all, checker", self.refused("bench", "--pictures", "chess:8"))
        self.assertIn("must be in 1..60", self.refused("bench", "--pictures", "checker:0"))
        self.assertIn("one --stage", self.refused("bench", "--once", "--pictures", "all"))


class CommandLine(Cli):
    def test_no_command(self):
        self.assertIn("--help", self.refused())

    def test_unknown_command_suggests_the_nearest(self):
        self.assertIn("did you mean 'fly'", self.refused("flyy", "showroom"))
        self.assertIn("config", self.refused("confg"))

    def test_unknown_flag_suggests_the_nearest(self):
        error = self.refused("fly", "--sed", "3")
        self.assertIn("gatefly fly:", error)
        self.assertIn("'--seed'", error)

    def test_wrong_values_of_flags(self):
        self.assertIn("--seed", self.refused("fly", "--seed", "many"))
        self.assertIn("--seed", self.refused("fly", "--seed", "-1"))
        self.assertIn("--laps", self.refused("fly", "--laps", "0"))
        self.assertIn("--laps: '1x', must be a whole number", self.refused("fly", "--laps", "1x"))
        self.assertIn("--gate-height-m: 'high', must be a number", self.refused("calibrate", "--gate-height-m", "high"))

    def test_a_seed_is_never_another_one(self):
        most = 2**64 - 1
        self.assertIn(f"{most + 1} is too large", self.refused("fly", "oval", "--seed", most + 1))
        self.assertIn("is too large", self.refused("campaign", "oval", "--runs", "1", "--first-seed", 10**30))
        self.assertIn("no seeds", self.refused("campaign", "oval", "--runs", "2", "--first-seed", most))
        flown = self.run_it("fly", "oval", "--vision", "ideal", "--set", "sim.timeout_s=1", "--json", "--seed", most)
        self.assertEqual(json.loads(flown.stdout)["seed"], most)

    def test_files_without_end_and_impossible_names_are_one_line(self):
        for arguments in (("fly", "/dev/zero"), ("config", "--config", "/dev/zero"), ("score", "--detections", "/dev/zero", "--labels", "x")):
            self.assertIn("/dev/zero: is longer than", self.refused(*arguments))
        for arguments in (("replay",), ("identify",), ("detect",), ("fly",), ("tune", "--out", "m.toml")):
            self.assertNotIn("filesystem error", self.refused(*arguments, 300 * "a"))

    def test_a_track_from_a_pipe_is_in_the_flights_folder_too(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        program = subprocess.Popen([GATEFLY, "fly", pipe, "--vision", "ideal", "--set", "sim.timeout_s=1", "--out", self.folder / "flown"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        oval = (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8")
        pipe.write_text(oval, encoding="utf-8")
        program.communicate(timeout=60)
        self.assertEqual((self.folder / "flown" / "track.toml").read_text(encoding="utf-8"), oval)

    def test_values_of_vision(self):
        self.assertIn("--vision", self.refused("fly", "--vision", "real"))


class IdealVision(Cli):
    def test_same_seed_same_summary_and_it_says_ideal(self):
        flights = []
        for name in ("one", "two"):
            result = self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1", "--json", "--out", name)
            self.assertEqual(result.returncode, 0, result.stderr)
            summary = json.loads(result.stdout)
            del summary["timings"]
            flights.append(summary)
        self.assertEqual(flights[0], flights[1])
        self.assertEqual(flights[0]["vision"], "ideal")
        self.assertGreater(flights[0]["detection"]["true_positives"], 0)
        logs = [(self.folder / name / "log_si.csv").read_bytes() for name in ("one", "two")]
        self.assertEqual(logs[0], logs[1])
        self.assertEqual(sorted(path.name for path in (self.folder / "one").iterdir()),
                         ["config-0.toml", "detections.csv", "flight.mcap", "images.csv", "log_si.csv", "report.html", "settings.txt",
                          "summary.json", "track.toml"])
        self.assertEqual(*((self.folder / name / "flight.mcap").read_bytes() for name in ("one", "two")))
        self.assertIn("--frames: a flight with --vision ideal has none", self.refused("fly", "oval", "--vision", "ideal", "--frames"))

    def test_a_flight_without_pictures_is_not_replayed(self):
        self.assertEqual(self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1", "--out", "blind").returncode, 0)
        self.assertIn("--vision ideal", self.refused("replay", "blind"))

    def colored(self, first, second):
        oval = (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8")
        parts = oval.split('"orange"')
        return self.file("colored.toml", f'{parts[0]}"{first}"{parts[1]}"{second}"{parts[2]}')

    def test_the_tracks_colour_is_looked_for_and_another_is_not_seen(self):
        fly = ("fly", self.colored("blue", "blue"), "--laps", "1", "--vision")
        for vision in ("ideal", "rendered"):
            result = self.run_it(*fly, vision)
            self.assertEqual((result.returncode, "not of the colour" in result.stderr), (0, False), vision + result.stderr)
        self.assertIn("to the bit", self.run_it("replay", "out/colored-1").stdout)
        red = self.run_it(*fly, "ideal", "--set", "color.rgb=[0.9, 0.1, 0.1]")
        self.assertEqual(red.returncode, 1)
        self.assertIn("oval: gate 1, 2 not of the colour that the pilot looks for (color.rgb", red.stderr)
        mixed = self.run_it("fly", self.colored("orange", "white"), "--laps", "1", "--vision", "ideal")
        self.assertEqual((mixed.returncode, mixed.stdout.count("1 of 2 gates")), (1, 1))
        self.assertIn("gate 2 not of the colour", mixed.stderr)

    def test_another_detector_flies_another_flight(self):
        errors = []
        for detector in ("ours", "paper"):
            result = self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1", "--json", "--out", detector,
                                 "--set", f"sim.ideal_detector={detector}")
            errors.append(json.loads(result.stdout)["detection"]["true_positives"])
        self.assertGreater(errors[0], errors[1])
        self.assertIn("ours", self.refused("fly", "oval", "--set", "sim.ideal_detector=theirs"))


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
        """Of the flight, its log as a text to be edited."""
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
        path.write_text(settings + "pose.white_px=0.5\n", encoding="utf-8")
        self.assertIn("pose.random_sigma_px is 0.5, was 0.35 in flight", self.run_it("replay", "flight").stdout)

    def test_a_summary_that_is_nonsense_does_not_say_the_seed(self):
        for nonsense in ("", "{oops", "[]", '{"config": 7, "detection": [], "vision": 3, "flight_time_s": "x", "seed": -1}'):
            self.assertIn("summary.json: does not say the flight's seed, without which its pictures cannot be rendered again",
                          self.refused("replay", self.edited("summary.json", lambda text: nonsense)))

    def test_a_wrong_setting_of_the_folder_is_not_blamed_on_set(self):
        for wrong, said in (("nonsense", "settings.txt nonsense: must be section.key=value"), ("camera.foo=3", "settings.txt: camera.foo is not a known key")):
            self.assertIn(said, self.refused("replay", self.edited("settings.txt", lambda text: wrong + "\n" + text)))

    def test_a_picture_listed_twice_is_refused(self):
        twice = self.edited("images.csv", lambda text: text.replace("frame_00007.uyvy", "frame_00006.uyvy"))
        self.assertIn("images.csv:9: image = 'frame_00006.uyvy', a second time", self.refused("replay", twice))

    def test_a_damaged_flight_among_others_is_named_and_the_rest_is_done(self):
        self.edited("log_si.csv", lambda text: text[:len(text) // 2]).rename(self.folder / "a")
        shutil.copytree(self.flight, self.folder / "b")
        result = self.run_it("identify", ".")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertRegex(result.stderr, r"a/log_si.csv:\d+: has \d+ cells")
        self.assertIn("./b: no second above 0.9 m", result.stderr)

    def test_it_is_found_in_the_data_folder(self):
        for given, variable in ((("--data", self.flight.parent), ""), ((), str(self.flight.parent))):
            self.assertEqual(self.run_it("replay", "flight", *given, GATEFLY_DATA=variable).returncode, 0)
        self.assertIn("no-such-folder", self.refused("replay", "flight", "--data", "no-such-folder"))

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

    def test_varied_days_have_masks_where_the_labels_say(self):
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


class Faults(Cli):
    def test_they_are_said_in_a_track_file_a_configuration_or_on_the_command_line(self):
        oval = (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8")
        track = self.file("broken.toml", oval + "\n[faults]\nmissing_gate = 1\ncamera_out_s = [3, 1]\n")
        config = self.file("mended.toml", "[faults]\ncamera_out_s = [0, 0]\n")
        fly = ("fly", track, "--vision", "ideal", "--laps", "1", "--json", "--out")
        summary = json.loads(self.run_it(*fly, "a").stdout)
        self.assertEqual(summary["gates_passed"], 0)
        self.assertEqual((summary["config"]["faults"]["missing_gate"], summary["config"]["faults"]["camera_out_s"]), (1, [3, 1]))
        over = json.loads(self.run_it(*fly, "b", "--config", config, "--set", "faults.missing_gate=0").stdout)
        self.assertEqual((over["config"]["faults"]["missing_gate"], over["config"]["faults"]["camera_out_s"]), (0, [0, 0]))
        self.assertEqual(over["gates_passed"], 2)

    def test_wrong_ones_are_refused(self):
        fly = ("fly", "oval", "--vision", "ideal", "--set")
        self.assertIn("did you mean 'camera_out_s'", self.refused(*fly, "faults.camera_ot_s=[1, 2]"))
        self.assertIn("2 numbers", self.refused(*fly, "faults.camera_out_s=1"))
        self.assertIn("has 2 gates", self.refused(*fly, "faults.missing_gate=3"))
        track = self.file("t.toml", (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8") + "\n[faults]\nweak_rotor = 5\n")
        self.assertRegex(self.refused("fly", track, "--vision", "ideal"), r"t\.toml:\d+: faults\.weak_rotor = 5, must be a whole number in 0\.\.4")


class Campaign(Cli):
    FLIGHT = ("--vision", "ideal", "--laps", "1")

    def campaign(self, out, *arguments, runs=6):
        return self.run_it("campaign", "oval", "--runs", runs, *self.FLIGHT, "--out", out, *arguments)

    def results(self, out):
        return [(self.folder / out / name).read_bytes() for name in ("runs.csv", "campaign.json")]

    def test_a_row_for_every_seed_and_their_statistics(self):
        result = self.campaign("all", "--first-seed", "11", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        header, *rows = (self.folder / "all" / "runs.csv").read_text().splitlines()
        self.assertEqual(header, "seed,finished,gates,gates_total,time_s,mean_speed_mps,max_speed_mps,cause,"
                                 "rmse_x_m,rmse_y_m,rmse_z_m,frames,true_positives,false_positives,searches,"
                                 "nees_mean,nees_inside,nis_mean,nis_inside,divergences,commit,configuration")
        cells = [dict(zip(header.split(","), row.split(","))) for row in rows]
        self.assertEqual([cell["seed"] for cell in cells], [str(seed) for seed in range(11, 17)])
        answer = json.loads(result.stdout)
        self.assertEqual(answer, json.loads((self.folder / "all" / "campaign.json").read_text()))
        finished = sum(cell["finished"] == "1" for cell in cells)
        self.assertEqual(answer["result"]["finished"], finished)
        low, high = answer["result"]["completion_wilson95"]
        self.assertLess(low, finished / 6)
        self.assertGreaterEqual(high, finished / 6)
        for cell in cells:  # what fly says of the same seed
            run = json.loads((self.folder / "all" / f"run_{int(cell['seed']):06}.json").read_text())
            self.assertEqual(float(cell["time_s"]), run["race_time_s"])
        alone = json.loads(self.run_it("fly", "oval", *self.FLIGHT, "--seed", "13", "--json").stdout)
        flown = json.loads((self.folder / "all" / "run_000013.json").read_text())
        for summary in (alone, flown):
            del summary["timings"]
        self.assertEqual(alone, flown)

    def test_the_number_of_jobs_changes_nothing(self):
        for jobs in ("1", "3"):
            self.assertEqual(self.campaign("jobs" + jobs, "--jobs", jobs).returncode, 0)
        self.assertEqual(self.results("jobs1"), self.results("jobs3"))

    def test_interrupted_or_killed_it_flies_only_what_is_missing(self):
        arguments = ("campaign", "oval", "--runs", "40", "--vision", "ideal", "--jobs", "2", "--quiet", "--out")
        self.assertEqual(self.run_it(*arguments, "whole").returncode, 0)
        for name, sent, code in (("interrupted", signal.SIGINT, 130), ("killed", signal.SIGKILL, -signal.SIGKILL)):
            out = self.folder / name
            process = subprocess.Popen([GATEFLY, *arguments, name], cwd=self.folder, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            deadline = time.monotonic() + 60
            while len(list(out.glob("run_*.json"))) < 4 and time.monotonic() < deadline:
                time.sleep(0.01)
            process.send_signal(sent)
            stdout, stderr = process.communicate(timeout=60)
            self.assertEqual(process.returncode, code, stderr)
            self.assertEqual(stdout, "")
            kept = {path: path.stat().st_mtime_ns for path in out.glob("run_*.json")}
            self.assertGreaterEqual(len(kept), 4)
            self.assertLess(len(kept), 40)
            if sent == signal.SIGINT:
                self.assertIn(f"{len(kept)} of 40 runs kept", stderr)
            self.assertFalse((out / "runs.csv").exists())

            self.assertEqual(self.run_it(*arguments, name).returncode, 0)
            for path, written in kept.items():
                self.assertEqual(path.stat().st_mtime_ns, written, path)
            self.assertEqual(self.results(name), self.results("whole"))
            self.assertEqual(list(out.glob("*.partial")), [])

    def test_a_damaged_run_is_flown_again(self):
        self.assertEqual(self.campaign("hurt").returncode, 0)
        before = self.results("hurt")
        (self.folder / "hurt" / "run_000003.json").write_text('{"seed": 3, "fini', encoding="utf-8")
        self.assertEqual(self.campaign("hurt").returncode, 0)
        self.assertEqual(self.results("hurt"), before)

    def test_shards_together_are_the_whole(self):
        self.assertEqual(self.campaign("whole", runs=7).returncode, 0)
        for shard in ("1", "2", "3"):
            self.assertEqual(self.campaign("part" + shard, "--shard", shard + "/3", runs=7).returncode, 0)
        self.assertEqual(len(list((self.folder / "part2").glob("run_*.json"))), 2)
        self.assertIn("seed 2", self.refused("campaign", "--merge", "part1", "part3", "--out", "merged"))
        result = self.run_it("campaign", "--merge", "part1", "part2", "part3", "--out", "merged")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.results("merged"), self.results("whole"))

    def test_a_campaign_from_before_a_key_was_renamed_goes_on(self):
        setting = ("--set", "sim.outliers_percent=20")
        self.assertEqual(self.campaign("mine", *setting, runs=2).returncode, 0)
        written = self.folder / "mine" / "campaign.json"
        before = json.loads(written.read_text(encoding="utf-8"))
        written.write_text(written.read_text(encoding="utf-8").replace('"outliers_percent"', '"ghosts_percent"'), encoding="utf-8")
        result = self.campaign("mine", "--set", "sim.ghosts_percent=20", runs=2)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("sim.ghosts_percent is the old name of sim.outliers_percent", result.stderr)
        after = json.loads(written.read_text(encoding="utf-8"))
        for key in ("arguments", "result"):
            self.assertEqual(after[key], before[key])

    def test_shards_of_different_campaigns_are_not_merged(self):
        self.assertEqual(self.campaign("one", "--shard", "1/2", runs=2).returncode, 0)
        self.assertEqual(self.campaign("two", "--shard", "2/2", "--set", "control.speed_mps=1.5", runs=2).returncode, 0)
        error = self.refused("campaign", "--merge", "one", "two", "--out", "merged")
        self.assertIn("two", error)
        self.assertIn("config.control.speed_mps", error)

    def test_what_another_commit_flew_is_not_mixed_in(self):
        self.assertEqual(self.campaign("mine", runs=2).returncode, 0)
        written = self.folder / "mine" / "campaign.json"
        mine = json.loads(written.read_text(encoding="utf-8"))
        commit = mine["arguments"]["commit"]
        rows = (self.folder / "mine" / "runs.csv").read_text().splitlines()[1:]
        self.assertEqual({row.split(",")[-2] for row in rows}, {commit})
        self.assertEqual(len({row.split(",")[-1] for row in rows}), 1)  # all of one configuration
        run = self.folder / "mine" / "run_000002.json"
        whole = run.read_text(encoding="utf-8")
        run.write_text(whole.replace(f'"commit": "{commit}"', '"commit": "0123456789ab"'), encoding="utf-8")
        self.assertIn('run_000002.json: flown by commit "0123456789ab"', self.refused("campaign", "oval", "--runs", "2", *self.FLIGHT, "--out", "mine"))
        run.write_text(whole, encoding="utf-8")
        mine["arguments"]["commit"] = "0123456789ab"
        written.write_text(json.dumps(mine), encoding="utf-8")
        error = self.refused("campaign", "oval", "--runs", "2", *self.FLIGHT, "--out", "mine")
        self.assertIn(f'commit was "0123456789ab", is "{commit}"', error)
        self.assertEqual(self.campaign("part", "--shard", "2/2", runs=2).returncode, 0)
        self.assertIn("commit", self.refused("campaign", "--merge", "part", "mine", "--out", "merged"))

    def test_two_campaigns_are_compared_seed_by_seed(self):
        self.assertEqual(self.campaign("early", "--set", "sim.timeout_s=5", runs=3).returncode, 0)
        result = self.campaign("late", "--first-seed", "2", "--compare", "early", "--json", runs=3)
        self.assertEqual(result.returncode, 0, result.stderr)
        comparison = json.loads(result.stdout)["comparison"]
        self.assertEqual(comparison["pairs"], 2)  # seeds 2 and 3
        self.assertEqual(comparison["unpaired"], 2)
        self.assertEqual((comparison["only_first"], comparison["only_second"]), ([], [2, 3]))
        self.assertAlmostEqual(comparison["mcnemar_p"], 0.5)
        self.assertEqual(comparison["differences"], ["sim.timeout_s: 5.0 | 240.0"])
        stored = json.loads((self.folder / "late" / "campaign.json").read_text())
        self.assertNotIn("comparison", stored)
        again = self.run_it("campaign", "--compare", "early", "late")
        self.assertIn("0 | 2 by one alone", again.stdout)
        self.assertIn("only the second seed 2, 3", again.stdout)
        self.assertEqual(self.campaign("other", "--first-seed", "900", runs=1).returncode, 0)
        self.assertIn("no seed in common", self.refused("campaign", "--compare", "early", "other"))
        self.assertIn("nowhere/campaign.json", self.refused("campaign", "oval", "--runs", "1", "--compare", "nowhere"))
        self.assertIn("--compare", self.refused("campaign", "--compare", "early", "late", "other"))

    def test_a_folder_with_other_arguments_is_refused(self):
        self.assertEqual(self.campaign("mine", runs=1).returncode, 0)
        error = self.refused("campaign", "oval", "--runs", "2", *self.FLIGHT, "--out", "mine")
        self.assertIn("runs was 1, is 2", error)
        error = self.refused("campaign", "oval", "--runs", "1", *self.FLIGHT, "--out", "mine",
                             "--set", "control.speed_mps=1.5")
        self.assertIn("config.control.speed_mps", error)
        thesis = self.folder / "thesis"
        thesis.mkdir()
        (thesis / "chapter1.tex").write_text("years of work", encoding="utf-8")
        self.assertIn("thesis", self.refused("campaign", "oval", "--runs", "1", *self.FLIGHT, "--out", thesis))

    def test_a_damaged_campaign_is_named(self):
        (self.folder / "bad").mkdir()
        for damage in ("", "[]", '{"arguments": {"runs": "x"}}', '{"arguments": {"runs": 0, "first_seed": 1, "shard": [1, 1]}, "fly": ""}',
                       '{"arguments": {"runs": 2, "first_seed": 1, "shard": [0, 0]}, "fly": ""}', '{"arguments": {"runs": 2, "first_seed": 1, "shard": [1, 1]}, "fly": 7}'):
            self.file("bad/campaign.json", damage)
            self.assertIn("bad/campaign.json: is damaged", self.refused("campaign", "--merge", "bad", "--out", "merged"))

    def test_the_printed_command_flies_the_failed_run_again(self):
        track = self.file("my track.toml", (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8"))
        result = self.run_it("campaign", track, "--runs", "2", *self.FLIGHT, "--set", "sim.timeout_s=5", "--out", "late")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("2 x timeout (seed 1, 2)", result.stdout)
        (line,) = [line for line in result.stdout.splitlines() if "fly one again" in line]
        program, *arguments = shlex.split(line.split("again", 1)[1])
        self.assertEqual(program, "gatefly")
        again = self.run_it(*arguments, "--json")
        self.assertEqual(again.returncode, 1, again.stderr)
        summaries = [json.loads(again.stdout), json.loads((self.folder / "late" / "run_000001.json").read_text())]
        for summary in summaries:
            del summary["timings"]
        self.assertEqual(summaries[0], summaries[1])

    def test_unusable_arguments(self):
        self.assertIn("--runs", self.refused("campaign", "oval"))
        self.assertIn("--runs", self.refused("campaign", "oval", "--runs", "0"))
        self.assertIn("--first-seed", self.refused("campaign", "oval", "--runs", "1", "--first-seed", "-1"))
        self.assertIn("--shard x", self.refused("campaign", "oval", "--shard", "x"))
        for shard in ("3/2", "0/2", "1", "1/2/3", "a/b", "-1/2"):
            self.assertIn("--shard", self.refused("campaign", "oval", "--runs", "2", "--shard", shard))
        self.assertIn("--out", self.refused("campaign", "--merge", "a", "b"))
        self.assertIn("campaign.json", self.refused("campaign", "--merge", "a", "b", "--out", "c"))


class Tracks(Cli):
    def test_unknown_track_lists_the_available_ones(self):
        error = self.refused("fly", "showrom")
        self.assertIn("darkhall, exhibition, figure8, flights, grandprix, lanes, oval", error)
        self.assertIn("did you mean 'showroom'", error)

    def test_broken_toml_names_the_line(self):
        self.assertIn("mine.toml:2:", self.fly_track("laps = 1\nstart = = 3\n" + GATE))

    def test_unknown_key_suggests_the_nearest(self):
        error = self.fly_track(GATE + "hedding_deg = 3\n")
        self.assertIn("gate 1: hedding_deg", error)
        self.assertIn("'heading_deg'", error)

    def test_not_a_number_is_refused(self):
        self.assertIn("gate 1: position_m = [nan, 0, -1.5]",
                      self.fly_track("[[gates]]\nposition_m = [nan, 0.0, -1.5]\n"))

    def test_negative_side_names_file_key_value_and_range(self):
        self.assertIn("mine.toml:3: gate 1: side_m = -1, must be in 0.3..5", self.fly_track(GATE + "side_m = -1\n"))

    def test_gate_too_low_is_refused_before_take_off(self):
        error = self.fly_track("[[gates]]\nposition_m = [3.0, 0.0, -0.3]\n")
        self.assertIn("mine.toml", error)
        self.assertIn("gate 1: position_m", error)

    def test_course_without_a_way_is_refused_before_take_off(self):
        wall = "[[obstacles]]\nbox_m = [0.3, 10.0, 3.0]\nposition_m = [1.5, 0.0]\n"
        room = "[room]\nsize_m = [12.0, 10.0, 3.2]\n"
        error = self.fly_track(GATE + wall + room)
        self.assertIn("mine.toml: cannot be flown", error)

    def test_empty_and_binary_files(self):
        self.assertIn("gates", self.fly_track(""))
        path = self.folder / "noise.toml"
        path.write_bytes(bytes(range(256)))
        self.assertIn("noise.toml", self.refused("fly", path))


class Courses(Cli):
    """tests/courses: written by an organiser who has not seen the planner."""

    def test_impossible_courses_are_refused_with_the_reason(self):
        reasons = {
            "gate_above_ceiling": "gate 2: position_m = [3.5, 4, -4.5], must be below the ceiling",
            "gate_in_floor": "the lower bar is 0.05 m above the floor",
            "gate_outside_room": "must be inside the room",
            "gate_too_small": "gate 2 is too small to fly through",
            "no_room_to_turn": "no way from gate 1 to gate 2",
            "pole_in_gate": "obstacle 1 stands in the opening of gate 2",
            "start_in_box": "the start is in obstacle 1",
            "wall_between_gates": "no way from gate 1 to gate 2: obstacle 1 is in the way",
        }
        courses = sorted((ROOT / "tests" / "courses" / "impossible").glob("*.toml"))
        self.assertEqual([course.stem for course in courses], sorted(reasons))
        for course in courses:
            error = self.refused("fly", course)
            self.assertIn(course.name, error)
            self.assertIn(reasons[course.stem], error)

    def test_every_other_course_has_a_way_and_is_begun(self):
        for course in sorted([*(ROOT / "tests" / "courses").glob("*.toml"), *(ROOT / "tracks").glob("*.toml")]):
            result = self.run_it("fly", course, "--vision", "ideal", "--laps", "1", "--json", "--out", "flown-" + course.stem)
            self.assertIn(result.returncode, (0, 1), result.stderr)
            self.assertGreaterEqual(json.loads(result.stdout)["gates_passed"], 1, course)


class CheckedCourse(Cli):
    def track(self, *arguments, code=0):
        result = self.run_it("track", *arguments, "--json")
        self.assertEqual(result.returncode, code, result.stderr)
        return json.loads(result.stdout)

    def test_every_shipped_course_can_be_flown_at_the_wanted_clearance(self):
        for path in sorted((ROOT / "tracks").glob("*.toml")):
            with self.subTest(track=path.stem):
                answer = self.track(path.stem)
                self.assertTrue(answer["can_be_flown"])
                self.assertGreaterEqual(answer["least_clearance_m"], answer["wanted_clearance_m"])
                self.assertEqual([leg["to_gate"] for leg in answer["legs"][:answer["gates"]]], list(range(1, answer["gates"] + 1)))

    def test_lengths_and_times_are_the_legs_own(self):
        answer = self.track("showroom")
        start, *laps = answer["legs"]
        self.assertAlmostEqual(answer["lap_length_m"], sum(leg["length_m"] for leg in laps))
        self.assertAlmostEqual(answer["race_length_m"], start["length_m"] + 3 * answer["lap_length_m"] - laps[-1]["length_m"])
        self.assertAlmostEqual(answer["race_time_s"], start["time_s"] + 3 * answer["lap_time_s"] - laps[-1]["time_s"])
        self.assertEqual(answer["tightest_radius_m"], min(leg["tightest_radius_m"] for leg in laps))

    def test_a_straight_course_is_as_long_as_it_is(self):
        answer = self.track(self.file("line.toml", "[[gates]]\nposition_m = [4.0, 0.0, -1.5]\n"), "--set", "control.speed_mps=2")
        self.assertAlmostEqual(answer["race_length_m"], 4.0, places=3)
        self.assertAlmostEqual(answer["race_time_s"], 2.0, places=3)
        self.assertIsNone(answer["tightest_radius_m"])
        self.assertIsNone(answer["lap_length_m"])

    def test_the_screen_is_one_and_says_what_matters(self):
        screen = self.run_it("track", "showroom").stdout
        self.assertLessEqual(screen.count("\n"), 24)
        self.assertTrue(screen.startswith("showroom: can be flown\n"))
        for line in ("gates  ", "room  ", "lap  ", "race  ", "speed  ", "tightest turn  ", "shortest run-in  ", "least clearance  "):
            self.assertIn("\n  " + line, screen)
        self.assertEqual(self.run_it("track", "showroom", "--quiet").stdout, "showroom: can be flown\n")

    def test_what_cannot_be_flown_is_exit_1_with_the_planners_reason(self):
        impossible = ROOT / "tests" / "courses" / "impossible"
        for name, reason in (("pole_in_gate", "obstacle 1 stands in the opening of gate 2"),
                             ("wall_between_gates", "no way from gate 1 to gate 2: obstacle 1 is in the way")):
            answer = self.track(impossible / (name + ".toml"), "--draw", name + ".png", code=1)
            self.assertFalse(answer["can_be_flown"])
            self.assertEqual(answer["reason"], reason)
            self.assertTrue((self.folder / (name + ".png")).exists())
        self.assertIn("has no exit", self.track("oval", "--set", "control.mode=paper", code=1)["reason"])

    def test_what_cannot_be_read_is_exit_2(self):
        self.assertIn("did you mean 'showroom'", self.refused("track", "showrom"))
        self.assertIn("mine.toml:3: gate 1: side_m", self.refused("track", self.file("mine.toml", GATE + "side_m = -1\n")))
        self.assertIn("TRACK", self.refused("track"))

    def test_the_drawing_is_a_picture_and_replaces_its_own_kind_only(self):
        for _ in range(2):
            self.assertEqual(self.run_it("track", "oval", "--draw", "oval.png").returncode, 0)
        self.assertEqual((self.folder / "oval.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        mine = self.file("mine.toml", GATE)
        self.assertIn("mine.toml", self.refused("track", mine, "--draw", mine, "--force"))
        self.file("notes.png", "mine\n")
        self.assertIn("--force", self.refused("track", "oval", "--draw", "notes.png"))
        self.assertEqual(self.run_it("track", "oval", "--draw", "notes.png", "--force").returncode, 0)


class Doctor(Cli):
    def doctor(self, *arguments, code=0, **variables):
        result = self.run_it("doctor", *arguments, "--json", **variables)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        answer = json.loads(result.stdout)
        return answer, {check["name"]: check for check in answer["checks"]}

    def test_says_that_a_race_can_be_flown_and_leaves_nothing_behind(self):
        answer, checks = self.doctor()
        self.assertTrue(answer["can_fly"])
        self.assertEqual(list(self.folder.iterdir()), [])
        for name in ("simulator", "processor", "shipped files", "configuration", "track", "out folder"):
            self.assertTrue(checks[name]["needed_to_fly"] and checks[name]["ok"], checks[name])
        screen = self.run_it("doctor").stdout
        self.assertIn(": a race can be flown\n", screen)
        self.assertEqual(screen.count("\n  ok ") + screen.count("\n  missing "), len(checks))
        self.assertEqual(screen.count("-> "), sum(not check["ok"] for check in checks.values()))

    def test_data_is_where_the_variable_says(self):
        (self.folder / "data" / "my_flights").mkdir(parents=True)
        checks = self.doctor(GATEFLY_DATA=str(self.folder / "data"))[1]
        self.assertTrue(checks["real data"]["found"].endswith("data: my_flights"))
        missing = self.doctor(GATEFLY_DATA=str(self.folder / "nowhere"))[1]["real data"]
        self.assertFalse(missing["ok"])
        self.assertIn("$GATEFLY_DATA", missing["advice"])

    def test_programs_that_are_not_there_are_missing_but_not_needed(self):
        checks = self.doctor(PATH=str(self.folder))[1]
        for name in ("ffmpeg", "Python module"):
            self.assertEqual((checks[name]["ok"], checks[name]["needed_to_fly"]), (False, False))

    def test_an_out_that_cannot_be_written_is_exit_1(self):
        self.file("out", "a file\n")
        answer, checks = self.doctor(code=1)
        self.assertFalse(answer["can_fly"] or checks["out folder"]["ok"])
        self.assertIn("for want of: out folder", self.run_it("doctor", "--quiet").stdout)

    def test_a_configuration_that_does_not_load_is_named(self):
        checks = self.doctor("--set", "camera.tilt_deg=900", code=1)[1]
        self.assertIn("camera.tilt_deg = 900", checks["configuration"]["found"])

    def test_a_program_without_its_files_is_told_where_they_belong(self):
        lone = self.folder / "lone"
        lone.mkdir()
        shutil.copy(GATEFLY, lone)
        result = subprocess.run([lone / "gatefly", "doctor", "--json"], cwd=lone, capture_output=True, text=True, check=False,
                                env=dict(os.environ, XDG_DATA_DIRS=str(lone)), timeout=60)
        self.assertEqual(result.returncode, 1, result.stderr)
        wrong = [check["name"] for check in json.loads(result.stdout)["checks"] if check["needed_to_fly"] and not check["ok"]]
        self.assertEqual(wrong, ["shipped files", "configuration", "track"])


class New(Cli):
    def new(self, *arguments):
        result = self.run_it("new", *arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result.stdout

    def test_a_new_track_can_be_flown_as_it_stands(self):
        self.assertIn("gatefly track mine.toml", self.new("track", "mine.toml"))
        answer = json.loads(self.run_it("track", "mine.toml", "--json").stdout)
        self.assertTrue(answer["can_be_flown"])
        self.assertGreaterEqual(answer["least_clearance_m"], answer["wanted_clearance_m"])
        flown = self.run_it("fly", "mine.toml", "--vision", "ideal", "--json")
        self.assertEqual(json.loads(flown.stdout)["gates_passed"], 4, flown.stderr)

    def test_a_track_drawn_at_random_is_the_seeds_own(self):
        one, again, other = (self.run_it("new", "track", "--random", seed, "-").stdout for seed in ("7", "7", "8"))
        self.assertEqual(one, again)
        self.assertNotEqual(one, other)
        self.assertIn('name = "random 7"', one)
        self.assertIn("new: --random = 7 is for KIND = track, not camera", self.refused("new", "camera", "--random", "7", "-"))

    def test_every_key_of_a_new_track_is_one_that_the_reader_knows(self):
        # What may be left out is a comment "# key = value  # what"; box_m and pole_m exclude each other.
        lines = self.new("track", "-").splitlines()
        full = [re.sub(r"^# (?=\w+ = |\[gates\.exit\])", "", line) for line in lines]
        for without in ("box_m", "pole_m"):
            track = self.file("full.toml", "\n".join(line for line in full if not line.startswith(without)))
            self.assertEqual(self.run_it("track", track).returncode, 0, self.run_it("track", track).stderr)
        keys = tomllib.loads("\n".join(full))
        self.assertEqual(set(keys), {"name", "laps", "start", "gates", "obstacles", "room", "randomize", "faults"})
        self.assertEqual(set(keys["gates"][0]), {"position_m", "heading_deg", "side_m", "bar_m", "color", "exit"})
        self.assertIn("gate_position_m", keys["randomize"])
        self.assertIn("camera_out_s", keys["faults"])
        for line in lines:
            if re.match(r"(# )?\w+ = ", line):
                self.assertRegex(line, r"  # \w|^(position_m|heading_deg) =")

    def test_a_new_camera_and_configuration_change_nothing(self):
        defaults = self.run_it("config", "--json").stdout
        for kind in ("camera", "config"):
            self.new(kind)
            self.assertEqual(self.run_it("config", "--json", "--config", kind + ".toml").stdout, defaults)
        self.assertEqual(list(tomllib.loads(self.new("camera", "-"))), ["camera"])
        sections = tomllib.loads(self.new("config", "-"))
        sections.setdefault("randomize", {})
        self.assertEqual({name: set(keys) for name, keys in sections.items()},
                         {name: set(keys) for name, keys in json.loads(defaults).items()})

    def test_a_file_that_is_there_stays_without_force(self):
        self.new("track", "mine.toml")
        for content in ("mine\n", "", (self.folder / "mine.toml").read_text(encoding="utf-8")):
            self.file("mine.toml", content)
            self.assertIn("mine.toml: is there already (--force replaces it)", self.refused("new", "track", "mine.toml"))
            self.assertEqual((self.folder / "mine.toml").read_text(encoding="utf-8"), content)
        self.new("track", "mine.toml", "--force")
        self.assertEqual((self.folder / "mine.toml").read_text(encoding="utf-8"), self.new("track", "-"))

    def test_what_is_no_kind_and_no_place_is_refused(self):
        self.assertIn("{track,camera,config}", self.refused("new", "drone"))
        self.assertIn("KIND", self.refused("new"))


class Vehicles(Cli):
    def test_one_that_cannot_lift_itself_or_come_down_is_refused_before_take_off(self):
        for command in (("fly", "oval"), ("campaign", "oval", "--runs", "2")):
            self.assertIn("vehicle.mass_kg = 1.2, but four rotors at vehicle.max_rotor_radps = 1250 lift 1.1 kg",
                          self.refused(*command, "--set", "vehicle.mass_kg=1.2"))
        self.assertIn("to come down", self.refused("fly", "oval", "--set", "vehicle.min_rotor_radps=800"))


class Interrupted(Cli):
    def test_ctrl_c_in_flight_keeps_nothing_and_says_so(self):
        process = subprocess.Popen([GATEFLY, "fly", "showroom", "--laps", "100", "--vision", "ideal", "--out", "flown"],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        log = self.folder / "flown.partial" / "log_si.csv"  # its first piece is written in flight
        deadline = time.monotonic() + 60
        while not (log.exists() and log.stat().st_size > 0) and time.monotonic() < deadline:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=60)
        self.assertEqual((process.returncode, stdout), (130, ""))
        self.assertEqual(stderr.splitlines()[-1], "gatefly fly: interrupted, nothing kept")
        self.assertEqual(list(self.folder.iterdir()), [])


class Output(Cli):
    def test_out_that_cannot_be_written(self):
        file = self.file("taken", "x")
        self.assertIn("taken", self.refused("fly", "oval", "--out", file))
        self.assertIn("cannot be written", self.refused("fly", "oval", "--out", file / "below"))

    def test_out_that_holds_something_else_is_left_alone(self):
        folder = self.folder / "thesis"
        folder.mkdir()
        (folder / "chapter1.tex").write_text("years of work", encoding="utf-8")
        self.assertIn("no earlier flight", self.refused("fly", "oval", "--out", folder))


class Video(Cli):
    SHORT = ("--laps", "1", "--set", "sim.timeout_s=4")

    def test_without_ffmpeg_nothing_flies(self):
        self.assertIn("ffmpeg", self.refused("fly", "oval", "--video", *self.SHORT, PATH=str(self.folder)))

    @unittest.skipUnless(shutil.which("ffmpeg") and shutil.which("ffprobe"), "there is no ffmpeg")
    def test_the_film_plays_as_long_as_the_flight(self):
        result = self.run_it("fly", "oval", "--video", "--json", *self.SHORT)
        self.assertEqual(result.returncode, 1, result.stderr)  # four seconds are no race
        flown = json.loads(result.stdout)["flight_time_s"]
        film = self.folder / "out" / "oval-1" / "flight.mp4"
        self.assertEqual(list(film.parent.glob("*.partial")), [])
        probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_streams", "-show_format",
                                "-of", "json", film], capture_output=True, check=True)
        answer = json.loads(probe.stdout)
        (stream,) = answer["streams"]
        self.assertEqual((stream["codec_name"], stream["pix_fmt"]), ("h264", "yuv420p"))
        self.assertEqual((stream["width"], stream["height"]), (1600, 900))
        seconds = float(answer["format"]["duration"])
        self.assertGreaterEqual(seconds, flown)
        self.assertLessEqual(seconds, flown + 5.5)  # the card stays for a while
        self.assertAlmostEqual(int(stream["nb_read_frames"]), 20 * seconds, delta=1)


def picture(gate=True, width=160, height=120, up=0):
    """A PPM of an orange square frame on grey, so many rows above the middle."""
    def frame(u, v):
        out = max(abs(u - 80), abs(v + up - 60))
        return gate and 36 <= out <= 40
    pixels = b"".join(b"\xe0\x60\x20" if frame(u, v) else b"\x70\x70\x70" for v in range(height) for u in range(width))
    return b"P6\n%d %d\n255\n" % (width, height) + pixels


def tilted(tilt, turn):
    """The rotation by `tilt` about the direction `turn` in the picture, row by row."""
    c, s = math.cos(tilt), math.sin(tilt)
    x, y = math.cos(turn), math.sin(turn)
    return [[c + x * x * (1 - c), x * y * (1 - c), y * s],
            [x * y * (1 - c), c + y * y * (1 - c), -x * s],
            [-y * s, x * s, c]]


def board_picture(tilt, turn, width=240, height=180, focal=200.0):
    """A PPM of a board of 7x5 inner corners, 30 mm squares, tilted about the direction `turn`, 0.26 m away."""
    rotation = tilted(tilt, turn)
    normal = [row[2] for row in rotation]
    origin = [sum(row[k] * (-0.09, -0.06)[k] for k in range(2)) + (0, 0, 0.26)[i] for i, row in enumerate(rotation)]
    ahead = sum(n * o for n, o in zip(normal, origin))
    pixels = bytearray()
    for v in range(height):
        for u in range(width):
            ray = ((u - 118) / focal, (v - 91) / focal, 1.0)
            distance = ahead / sum(n * r for n, r in zip(normal, ray))
            p = [distance * r - o for r, o in zip(ray, origin)]
            i, j = (sum(rotation[k][column] * p[k] for k in range(3)) / 0.03 for column in range(2))
            grey = 230.0
            if -1 < i < 7 and -1 < j < 5:
                edge = 0.03 * focal / distance * math.sin(math.pi * i) * math.sin(math.pi * j) / math.pi
                grey = 128 + 100 * max(-1.0, min(1.0, 2 * edge))
            pixels += bytes((round(grey),)) * 3
    return b"P6\n%d %d\n255\n" % (width, height) + bytes(pixels)


class Calibrate(Cli):
    """A camera of 200 px, its centre at (118, 91), and eight pictures that it took of a board."""
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-board-")
        cls.addClassCleanup(folder.cleanup)
        cls.boards = pathlib.Path(folder.name)
        for k in range(8):
            (cls.boards / f"{k}.ppm").write_bytes(board_picture(0.3 + 0.03 * k, 0.8 * k))

    BOARD = ("--pattern", "7x5", "--square-m", "0.03")

    def corners(self, name, count, warp=0.0):
        """A corner list of a 5x4 board through a pinhole of 200 px; `warp` bends the board."""
        rows = ["image,X_m,Y_m,u_px,v_px"]
        for k in range(count):
            rotation = tilted(0.3 + 0.03 * k, 0.8 * k)
            for i in range(20):
                x, y = 0.03 * (i % 5), 0.03 * (i // 5)
                p = [row[0] * (x - 0.06) + row[1] * (y - 0.045) for row in rotation]
                z = 0.3 + p[2] + warp * math.sin(7 * i + k)
                rows.append(f"{k}.png,{x},{y},{160 + 200 * p[0] / z:.4f},{120 + 200 * p[1] / z:.4f}")
        return self.file(name, "\n".join(rows) + "\n")

    def test_pictures_become_a_camera_that_detect_takes(self):
        result = self.run_it("calibrate", self.boards, *self.BOARD, "--model", "pinhole", "--out", "camera.toml", "--report", "r.png")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        self.assertTrue((self.folder / "r.png").read_bytes().startswith(b"\x89PNG"))
        with open(self.folder / "camera.toml", "rb") as file:
            camera = tomllib.load(file)["camera"]
        self.assertEqual((camera["model"], camera["size_px"], camera["stored_rotation_deg"]), ("pinhole", [240, 180], 0))
        for got, wanted in zip(camera["focal_px"] + camera["center_px"], (200, 200, 118, 91)):
            self.assertAlmostEqual(got, wanted, delta=1.0)
        (self.folder / "a.ppm").write_bytes(picture())
        found = self.run_it("detect", "a.ppm", "--config", "camera.toml")  # no --rotate: the camera says 0
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertEqual(len(found.stdout.splitlines()), 2)
        flown = self.run_it("fly", "oval", "--vision", "ideal", "--json", "--config", "camera.toml", "--set", "sim.timeout_s=2")
        self.assertEqual(flown.returncode, 1, flown.stderr)  # two seconds are no race
        self.assertEqual(json.loads(flown.stdout)["config"]["camera"]["model"], "pinhole")

    def test_json_holds_every_model_and_picture(self):
        answer = json.loads(self.run_it("calibrate", self.corners("c.csv", 9), "--size", "320x240", "--json").stdout)
        self.assertEqual([each["model"] for each in answer["models"]], ["pinhole", "dhane", "kannala-brandt", "brown-conrady"])
        self.assertEqual(len(answer["pictures"]), 9)
        self.assertAlmostEqual(answer["models"][0]["parameters"]["fx"]["value"], 200, delta=0.1)

    def test_says_when_it_cannot_know_how_pictures_are_stored(self):
        corners = self.corners("c.csv", 9)
        run = lambda *more: self.run_it("calibrate", corners, *more, "--out", "c.toml")
        listed = run("--size", "320x240")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.assertIn("--rotate 90", listed.stdout.splitlines()[-1])
        self.assertIn("stored_rotation_deg", (self.folder / "c.toml").read_text().split("[camera]")[0])  # the file says so, too
        self.assertIn("stand on end", run("--size", "320x330").stdout.splitlines()[-1])
        told = run("--size", "320x240", "--rotate", "0")  # that is an answer
        self.assertNotIn("--rotate", told.stdout)
        self.assertNotIn("guess", (self.folder / "c.toml").read_text())
        pictures = self.run_it("calibrate", self.boards, *self.BOARD, "--out", "p.toml")  # these are as they are stored
        self.assertNotIn("--rotate", pictures.stdout)

    def test_a_flight_tells_how_its_pictures_are_stored(self):
        data = pathlib.Path(os.environ.get("GATEFLY_DATA", ROOT / "../shared/data"))
        flight = data / "tudelft_bebop_flights" / "flight_11"
        if not flight.is_dir():
            self.skipTest(f"no real data in {data}")
        corners = data / "fisheye_calibration" / "bebop_front_camera" / "calib_rot_3_corners.csv"
        result = self.run_it("calibrate", corners, "--size", "315x160", "--tilt-from", flight, "--out", "c.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("guess", result.stdout)
        with open(self.folder / "c.toml", "rb") as file:
            self.assertEqual(tomllib.load(file)["camera"]["stored_rotation_deg"], 90)

    def test_kalibr_and_ros_and_back(self):
        self.run_it("calibrate", self.corners("c.csv", 9), "--size", "320x240", "--model", "kannala-brandt", "--out", "a.toml")
        for form in ("kalibr", "ros"):
            self.assertEqual(self.run_it("calibrate", "--from", "a.toml", "--to", form, "--out", form + ".yaml").returncode, 0)
            self.assertEqual(self.run_it("calibrate", "--from", form + ".yaml", "--out", form + ".toml").returncode, 0)
            first, back = ([line for line in (self.folder / name).read_text().splitlines() if not line.startswith("#")]
                           for name in ("a.toml", form + ".toml"))
            self.assertEqual(first, back)
        refusal = self.refused("calibrate", "--from", ROOT / "cameras" / "bebop.toml", "--to", "ros", "--out", "b.yaml")
        self.assertIn("Dhane", refusal)

    def test_what_gives_no_camera_is_refused_with_the_reason(self):
        self.assertIn("7x5", self.refused("calibrate", self.boards, "--pattern", "9x6", "--square-m", "0.03", "--out", "c.toml"))
        grey = [self.file(f"grey{k}.ppm", "P6\n160 120\n255\n" + 57600 * "p") for k in range(5)]
        self.assertIn("shows nothing", self.refused("calibrate", *grey, *self.BOARD, "--out", "c.toml"))
        self.assertIn("at least 5", self.refused("calibrate", self.boards / "1.ppm", *self.BOARD, "--out", "c.toml"))
        size = ("--size", "320x240", "--out", "c.toml")
        self.assertIn("at least 5", self.refused("calibrate", self.corners("four.csv", 4), *size))
        self.assertIn("0.3 %", self.refused("calibrate", self.corners("bent.csv", 9, warp=0.05), *size))
        rows = self.corners("c.csv", 1).read_text().splitlines()
        same = [rows[0], *(row.replace("0.png", f"{k}.png") for k in range(9) for row in rows[1:])]
        self.assertIn("alike", self.refused("calibrate", self.file("same.csv", "\n".join(same) + "\n"), *size))

    def test_wrong_use_is_one_line(self):
        corners = self.corners("c.csv", 9)
        self.assertIn("--from", self.refused("calibrate"))
        self.assertIn("--pattern", self.refused("calibrate", self.boards))
        self.assertIn("--square-m", self.refused("calibrate", self.boards, "--pattern", "7x5"))
        self.assertIn("nine", self.refused("calibrate", self.boards, "--pattern", "nine", "--square-m", "0.03"))
        self.assertIn("--size", self.refused("calibrate", corners))
        self.assertIn("outside", self.refused("calibrate", corners, "--size", "100x100"))
        self.assertIn("--pattern 9x6 has 54", self.refused("calibrate", corners, "--size", "320x240", "--pattern", "9x6"))
        self.assertIn("--model", self.refused("calibrate", corners, "--size", "320x240", "--model", "omni"))
        self.assertIn("--out", self.refused("calibrate", corners, "--size", "320x240", "--out", "nowhere/c.toml"))
        self.assertIn("no-such", self.refused("calibrate", "no-such.csv", "--size", "320x240"))
        self.assertIn("u_px", self.refused("calibrate", self.file("x.csv", "image,X_m,Y_m\na,0,0\n"), "--size", "320x240"))
        self.assertIn("neither", self.refused("calibrate", "--from", self.file("x.yaml", "a: 1\n"), "--out", "c.toml"))
        self.assertIn("--out", self.refused("calibrate", "--from", "x.yaml"))
        self.assertIn("--from", self.refused("calibrate", "--from", "x.yaml", "--out", "c.toml", "--model", "pinhole"))
        self.assertIn("--tilt-from", self.refused("calibrate", corners, "--size", "320x240", "--gate-height-m", "1"))

    def test_the_tilt_comes_from_gates_that_a_level_drone_saw(self):
        """A pinhole of 200 px, 15 degrees down; a 1 m gate ahead, 1.5 m and more away."""
        self.file("cam.toml", '[camera]\nmodel = "pinhole"\nsize_px = [320, 240]\nfocal_px = [200, 200]\n'
                              'center_px = [160, 120]\ndistortion = []\n')
        rows = ["image,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v"]
        c, s = math.cos(math.radians(15)), math.sin(math.radians(15))
        for k in range(4):
            pixels = []
            for right, down in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
                ahead = 1.5 + 0.1 * k
                z = c * ahead + s * down
                pixels += [160 + 200 * right / z, 120 + 200 * (c * down - s * ahead) / z]
            rows.append(f"{k}.png," + ",".join(f"{p:.3f}" for p in pixels))
        labels = self.file("labels.csv", "\n".join(rows) + "\n")
        result = self.run_it("calibrate", "--from", "cam.toml", "--tilt-from", labels, "--out", "tilted.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.folder / "tilted.toml", "rb") as file:
            self.assertAlmostEqual(tomllib.load(file)["camera"]["tilt_deg"], 15, delta=0.05)
        self.file("two.csv", "\n".join(rows[:3]) + "\n")
        self.assertIn("at least 3", self.refused("calibrate", "--from", "cam.toml", "--tilt-from", "two.csv", "--out", "x.toml"))
        self.assertIn("no-such", self.refused("calibrate", "--from", "cam.toml", "--tilt-from", "no-such.csv", "--out", "x.toml"))

    def test_a_picture_that_cannot_be_read_is_named_and_the_rest_is_done(self):
        broken = self.file("broken.ppm", "P6\n")
        result = self.run_it("calibrate", "-q", self.boards, broken, *self.BOARD, "--out", "c.toml")
        self.assertEqual(result.returncode, 2)
        self.assertIn("broken.ppm", result.stderr)
        self.assertTrue((self.folder / "c.toml").exists())


class Pictures(Cli):
    CONTRACT = "image,gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v,fitness,method"  # what other programs write, too
    HEADER = CONTRACT + ",tl_fitness,tr_fitness,br_fitness,bl_fitness"

    def picture(self, name, **what):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(picture(**what))
        return path

    def corners(self, row):
        return [float(x) for x in row.split(",")[2:10]]

    def test_a_gate_is_one_row_with_its_outer_corners(self):
        result = self.run_it("detect", "--rotate", "0", self.picture("a.ppm"))
        self.assertEqual(result.returncode, 0, result.stderr)
        header, row = result.stdout.splitlines()
        self.assertEqual(header, self.HEADER)
        self.assertTrue(row.startswith("a.ppm,0,") and row.split(",")[11] == "snake", row)
        for got, wanted in zip(self.corners(row), (39.5, 19.5, 120.5, 19.5, 120.5, 100.5, 39.5, 100.5)):
            self.assertAlmostEqual(got, wanted, delta=2.0)

    def test_a_gate_that_the_border_cuts_is_a_row_of_bars_which_score_leaves_out(self):
        cut = self.picture("cut.ppm", up=50)
        result = self.run_it("detect", "--rotate", "0", cut, "--csv", "-", "--annotate", "drawn")
        self.assertEqual(result.returncode, 0, result.stderr)
        (row,) = result.stdout.splitlines()[1:]
        self.assertEqual(row.split(",")[11], "bars")
        for got, wanted in zip(self.corners(row)[4:], (120.5, 50.5, 39.5, 50.5)):
            self.assertAlmostEqual(got, wanted, delta=2.0)
        upper, lower = [float(x) for x in row.split(",")[12:14]], [float(x) for x in row.split(",")[14:16]]
        self.assertEqual(upper, [0, 0])
        self.assertGreater(min(lower), 0.5)
        self.assertTrue((self.folder / "drawn" / "cut.ppm.png").exists())
        answer = json.loads(self.run_it("detect", "--rotate", "0", "--json", cut).stdout)
        self.assertEqual((answer["with_gate"], answer["with_part"]), (0, 1))
        labels = self.file("labels.csv", "image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\ncut.ppm,0,,,,,,,,\n")
        found = self.file("found.csv", result.stdout)
        self.assertIn("1 rows of bars", self.run_it("score", "--detections", found, "--labels", labels).stdout)

    def test_rotate_turns_the_stored_picture_counter_clockwise(self):
        path = self.picture("a.ppm")
        (row,) = self.run_it("detect", "--rotate", "90", path).stdout.splitlines()[1:]
        self.assertLess(max(self.corners(row)[0::2]), 120)  # the upright picture is 120 wide and 160 high
        self.assertEqual(self.run_it("detect", "--set", "camera.stored_rotation_deg=90", path).stdout.splitlines()[1], row)
        self.assertIn("--rotate", self.refused("detect", "--rotate", "45", path))

    def test_without_rotate_pictures_are_upright_unless_a_configuration_names_the_camera(self):
        path = self.picture("a.ppm")
        for given, same, said in (((), "0", "1 picture taken as upright; "),
                                  (("--config", "cyberzoo"), "90", "1 picture turned by 90 degrees counter-clockwise (")):
            result = self.run_it("detect", path, *given)
            self.assertEqual(result.stdout.splitlines()[1:], self.run_it("detect", "--rotate", same, path, *given).stdout.splitlines()[1:])
            self.assertIn(said, result.stderr)
        self.assertEqual(self.run_it("detect", path, "--quiet").stderr, "")

    @unittest.skipUnless(shutil.which("ffmpeg"), "there is no ffmpeg")
    def test_exif_turns_a_photo_and_a_mirrored_one_is_refused(self):
        subprocess.run(["ffmpeg", "-v", "error", "-i", self.picture("a.ppm"), "-q:v", "1", "plain.jpg"], cwd=self.folder, check=True)
        jpeg = (self.folder / "plain.jpg").read_bytes()
        for orientation, rotate in ((3, "180"), (6, "270"), (8, "90")):
            exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01" + bytes((0, orientation, 0, 0))
            photo = self.folder / f"photo{orientation}.jpg"
            photo.write_bytes(jpeg[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + jpeg[2:])
            by_exif, told = self.run_it("detect", photo), self.run_it("detect", photo, "--rotate", rotate)
            self.assertEqual(by_exif.stdout, told.stdout)
            self.assertIn(f"turned by {rotate} degrees counter-clockwise (EXIF)", by_exif.stderr)
            self.assertNotEqual(self.run_it("detect", photo, "--rotate", "0").stdout, told.stdout)
        photo.write_bytes(photo.read_bytes().replace(b"\x01\0\x08", b"\x01\0\x02"))
        self.assertIn("EXIF orientation 2 mirrors it", self.refused("detect", photo))

    def test_it_says_what_it_took_for_given_and_who_said_so(self):
        path = self.picture("a.ppm")
        camera = self.file("camera.toml", '[camera]\nmodel = "pinhole"\nsize_px = [160, 120]\nfocal_px = [100, 100]\ncenter_px = [79.5, 59.5]\n'
                           "distortion = []\nstored_rotation_deg = 0\n")
        said = self.run_it("detect", path, "--config", camera, "--config", "cyberzoo", "--rotate", "0", "--set", "color.rgb=[0, 0, 1]").stderr
        for words in (f"lens pinhole, 315x160 px (config {camera})", "rgb 0, 0, 1 (--set)", "min_score 2.5 (config cyberzoo)", "taken as upright"):
            self.assertIn(words, said)
        assumed = json.loads(self.run_it("detect", path, "--rotate", "0", "--json").stdout)["assumed"]
        self.assertEqual(assumed["lens"], {"is": None, "sides": "straight", "by": None})
        self.assertEqual(assumed["threshold"], {"min_score": 2.5, "by": "default"})
        self.assertEqual(assumed["rotation"], "1 picture taken as upright (as told)")
        answer = json.loads(self.run_it("detect", path, "--config", camera, "--set", "camera.size_px=[640, 480]", "--json").stdout)
        self.assertEqual(answer["other_size"], 1)

    def test_debug_draws_why_a_gate_was_found_or_missed(self):
        path, missed = self.picture("a.ppm"), self.picture("none.ppm", gate=False)
        result = self.run_it("detect", "--rotate", "0", path, missed, "--debug", "why")
        self.assertEqual(result.returncode, 0, result.stderr)
        why = self.folder / "why"
        self.assertEqual(sorted(file.name for file in why.iterdir()), ["a.ppm.json", "a.ppm.png", "none.ppm.json", "none.ppm.png"])
        self.assertEqual((why / "a.ppm.png").read_bytes()[:4], b"\x89PNG")
        found, none = (json.loads((why / name).read_text()) for name in ("a.ppm.json", "none.ppm.json"))
        self.assertIn("fast search found one of score", found["in_words"])
        self.assertEqual(found["considered"][0]["fate"], "taken")
        self.assertEqual(none["answered"], [])
        self.assertFalse(any(frame["taken"] for frame in none["considered"]))
        self.run_it("detect", "--rotate", "0", path, "--debug", "why", "--set", "detector.min_score=7")
        strict = json.loads((why / "a.ppm.json").read_text())
        self.assertRegex(strict["considered"][0]["fate"], r"^score [0-9.]+ < min_score 7.00$")
        self.assertIn("another folder", self.refused("detect", path, "--debug", "same", "--annotate", "same"))
        (why / "a.ppm.json").write_text("mine")
        self.assertIn("a.ppm.json", self.refused("detect", "--rotate", "0", path, "--debug", "why"))
        self.assertEqual((why / "a.ppm.json").read_text(), "mine")

    def test_the_answer_of_a_picture_does_not_depend_on_its_neighbours(self):
        paths = [self.picture(name) for name in ("a.ppm", "b.ppm")]
        rows = self.run_it("detect", "--rotate", "0", *paths).stdout.splitlines()[1:]
        self.assertEqual(rows[0].split(",")[1:], rows[1].split(",")[1:])

    def test_nothing_detected_is_exit_1_with_a_header(self):
        for name, size in (("none.ppm", {"gate": False}), ("one.ppm", {"width": 1, "height": 1}), ("line.ppm", {"height": 1})):
            result = self.run_it("detect", self.picture(name, **size))
            self.assertEqual((result.returncode, result.stdout), (1, self.HEADER + "\n"))
            self.assertEqual(result.stderr, "gatefly detect: 1 picture taken as upright; no lens named, sides taken as straight; "
                             "colour as described by rgb 1, 0.4, 0 (default); min_score 2.5 (default)\n"
                             f"gatefly detect: 1 of 1 picture has no colour, by which gates are found: {name}\n")

    def test_json_holds_the_same_rows(self):
        path = self.picture("a.ppm")
        answer = json.loads(self.run_it("detect", "--rotate", "0", "--json", path).stdout)
        row = self.run_it("detect", "--rotate", "0", path).stdout.splitlines()[1]
        (found,) = answer["detections"]
        self.assertEqual((answer["pictures"], answer["with_gate"], answer["unusable"]), (1, 1, 0))
        for got, wanted in zip(sum(found["corners_px"], []), self.corners(row)):
            self.assertAlmostEqual(got, wanted, places=3)

    def test_a_bad_file_in_a_folder_is_named_and_the_rest_is_done(self):
        for name in ("set/a.ppm", "set/c.ppm"):
            self.picture(name)
        (self.folder / "set" / "b.jpg").write_bytes(b"\xff\xd8\xff\xe0 torn")
        (self.folder / "set" / "labels.csv").write_text("not a picture", encoding="utf-8")
        csv = self.folder / "found.csv"
        result = self.run_it("detect", "--rotate", "0", "set", "--csv", csv, "--annotate", "drawn")
        self.assertEqual(result.returncode, 2)
        self.assertIn("set/b.jpg: not a usable JPEG", result.stderr)
        self.assertIn("1 could not be used, 2 pictures were done", result.stderr)
        self.assertEqual([row.split(",")[0] for row in csv.read_text().splitlines()[1:]], ["a.ppm", "c.ppm"])
        self.assertEqual(sorted(path.name for path in (self.folder / "drawn").iterdir()), ["a.ppm.png", "c.ppm.png"])

    def test_unusable_pictures_are_one_line_and_leave_nothing(self):
        jpeg = self.folder / "torn.jpg"
        jpeg.write_bytes(b"\xff\xd8\xff\xe0")
        self.assertIn("torn.jpg", self.refused("detect", jpeg, "--csv", "found.csv", "--annotate", "drawn"))
        for name, content in (("empty.jpg", b""), ("empty.png", b""), ("a.png", b"\x89PNG\r\n"), ("a.ppm", b"P6 9 9 255 x"),
                              ("a.uyvy", b"1234567"), ("notes.txt", b"hello"), ("empty.avi", b"")):
            (self.folder / name).write_bytes(content)
            self.assertIn(name, self.refused("detect", name))
        self.assertIn("even width", self.refused("detect", "a.uyvy", "--rotate", "0", "--set", "camera.size_px=[17, 20]"))
        self.assertIn("no-such", self.refused("detect", "no-such"))
        (self.folder / "bare").mkdir()
        self.assertIn("bare: holds no", self.refused("detect", "bare"))
        self.assertIn("--csv", self.refused("detect", self.picture("b.ppm"), "--csv", "nowhere/found.csv"))
        self.assertIn("ffmpeg", self.refused("detect", "notes.txt", PATH=str(self.folder)))
        self.assertIn("no-such-folder", self.refused("detect", "b.ppm", "--data", "no-such-folder"))

    def test_what_a_folder_does_not_mean_is_said(self):
        self.picture("set/a.ppm")
        for name in ("b.BMP", "c.webp", "d.tiff", "e.heic", "notes.txt"):
            (self.folder / "set" / name).write_bytes(b"x")
        said = "set: left out: b.BMP, c.webp, d.tiff and 1 more (a folder means its .jpg, .jpeg, .png and .ppm)"
        result = self.run_it("detect", "set")
        self.assertEqual((result.returncode, said in result.stderr), (0, True), result.stderr)
        (self.folder / "set" / "a.ppm").unlink()
        self.assertIn(said, self.refused("detect", "set"))
        self.assertIn(said, self.refused("tune", "set", "--out", "mine.toml"))

    def test_pictures_are_found_in_the_data_folder(self):
        self.picture("data/a.ppm")
        for given in (("--data", "data"), ()):
            result = self.run_it("detect", "--rotate", "0", "a.ppm", *given, GATEFLY_DATA=str(self.folder / "data"))
            self.assertEqual(result.returncode, 0, result.stderr)

    @unittest.skipUnless(shutil.which("ffmpeg"), "there is no ffmpeg")
    def test_frames_of_a_video_are_counted_from_0(self):
        for i in range(3):
            self.picture(f"{i}.ppm", gate=i != 1)
        subprocess.run(["ffmpeg", "-v", "error", "-i", "%d.ppm", "-c:v", "mjpeg", "-q:v", "2", "f.avi"], cwd=self.folder, check=True)
        result = self.run_it("detect", "--rotate", "0", "f.avi")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([row.split(",")[0] for row in result.stdout.splitlines()[1:]], ["f.avi#0", "f.avi#2"])
        # A phone's film says how it was held; --rotate is told about what is stored.
        subprocess.run(["ffmpeg", "-v", "error", "-i", "f.avi", "-c:v", "mjpeg", "-q:v", "2", "plain.mov"], cwd=self.folder, check=True)
        subprocess.run(["ffmpeg", "-v", "error", "-i", "plain.mov", "-c", "copy", "-metadata:s:v", "rotate=90", "held.mov"], cwd=self.folder, check=True)
        across = {rotate: max(max(self.corners(row)[0::2]) for row in self.run_it("detect", "held.mov", *rotate).stdout.splitlines()[1:])
                  for rotate in ((), ("--rotate", "0"))}
        self.assertLess(across[()], 102)  # turned: 120 px wide, the gate in the middle
        self.assertGreater(across["--rotate", "0"], 118)


class Tune(Cli):
    """Twelve pictures of a gate, here and there, whose colour is told by labels or described."""

    def album(self, color, count=12):
        folder = self.folder / "album"
        folder.mkdir()
        rows = ["image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v"]
        for i in range(count):
            u0, v0, half = 60 + 4 * i, 50 + 2 * (i % 5), 30 + i % 4

            def pixel(u, v):
                out = max(abs(u - u0), abs(v - v0))
                return color if half - 3 <= out <= half else bytes((100 + (u * 7 + v * 13 + i) % 24,) * 3)
            (folder / f"p{i}.ppm").write_bytes(b"P6\n160 120\n255\n" + b"".join(pixel(u, v) for v in range(120) for u in range(160)))
            left, right, top, bottom = u0 - half, u0 + half, v0 - half, v0 + half
            rows.append(f"p{i}.ppm,1,{left},{top},{right},{top},{right},{bottom},{left},{bottom}")
        return folder, self.file("labels.csv", "\n".join(rows) + "\n")

    def found(self, folder, *arguments):
        result = self.run_it("detect", "--rotate", "0", "--json", folder, *arguments)
        return json.loads(result.stdout)["with_gate"]

    def test_labels_teach_a_colour_that_nobody_described(self):
        folder, labels = self.album(b"\x30\xa0\x40")
        self.assertLess(self.found(folder), 3)
        result = self.run_it("tune", "--labels", labels, "--rotate", "0", folder, "--out", "mine.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("12 labelled gates", result.stdout)
        self.assertRegex(result.stdout, r"two-fold +hit rate [01]\.\d{3}, 0\.0\d\d false per picture \(min_score")
        self.assertLessEqual(len(result.stdout.splitlines()), 24)
        self.assertEqual(sorted(path.name for path in self.folder.glob("mine*")),
                         ["mine.colors.toml", "mine.roc.csv", "mine.roc.png", "mine.toml"])
        self.assertEqual(self.found(folder, "--config", self.folder / "mine.toml"), 12)
        self.assertIn("mine.colors.toml", self.run_it("config", "--show", "--config", self.folder / "mine.toml").stdout)

    def test_a_described_colour_learns_from_its_own_detections(self):
        folder, _ = self.album(b"\x30\xa0\x40")
        result = self.run_it("tune", "--describe", "green", "--rotate", "0", "--json", folder, "--out", "mine.toml")
        answer = json.loads(result.stdout)
        self.assertEqual((result.returncode, answer["learnt"], answer["estimated"], answer["pictures"]), (0, True, True, 12))
        self.assertGreaterEqual(answer["confident_detections"], 10)
        self.assertEqual(self.found(folder, "--config", self.folder / "mine.toml"), 12)

    def test_estimates_are_called_estimates(self):
        folder, _ = self.album(b"\x30\xa0\x40")
        result = self.run_it("tune", "--describe", "green", "--rotate", "0", folder, "--out", "mine.toml")
        self.assertRegex(result.stdout, r"estimated +hit rate [01]\.\d{3}, 0\.0\d\d false per picture")
        self.assertIn("from scores alone", result.stdout)
        self.assertIn("# estimated without labels: hit rate", (self.folder / "mine.toml").read_text())
        self.assertIn(f"gatefly detect {folder} --config mine.toml --annotate out/drawn", result.stdout)

    def test_one_picture_and_pictures_of_several_sizes_are_said(self):
        folder, _ = self.album(b"\x30\xa0\x40", count=1)
        result = self.run_it("tune", "--describe", "green", "--rotate", "0", folder, "--out", "mine.toml")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("too few gates to learn from (1, it takes 6)", result.stdout)
        self.assertIn("--debug out/why", result.stdout)
        (folder / "other.ppm").write_bytes(picture(height=200))
        self.assertIn("pictures of several sizes", self.run_it("tune", "--describe", "green", folder, "--out", "mine.toml").stderr)

    def test_with_too_few_sure_gates_it_starts_again_from_less_sure_ones(self):
        folder, _ = self.album(bytes((115, 135, 118)))  # hardly green, were it not for what is around
        result = self.run_it("tune", "--describe", "green", "--set", "detector.adapts=0", "--rotate", "0", folder, "--out", "mine.toml")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertRegex(result.stdout, "detections of fitness 0.[56] and more")

    def test_a_description_that_finds_nothing_is_kept_and_that_is_said(self):
        folder, _ = self.album(b"\x30\xa0\x40")
        result = self.run_it("tune", "--describe", "magenta", "--rotate", "0", folder, "--out", "mine.toml")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("too few gates", result.stdout)
        self.assertEqual([path.name for path in self.folder.glob("mine*")], ["mine.toml"])
        self.assertEqual(self.run_it("config", "--config", self.folder / "mine.toml").returncode, 0)

    def test_labels_and_pictures_that_do_not_belong_together(self):
        folder, labels = self.album(b"\xe0\x60\x20", count=6)
        other = self.file("other.csv", "image,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\nx.jpg,1,1,9,1,9,9,1,9\n")
        self.assertIn("names none of the 6 pictures", self.refused("tune", "--labels", other, folder, "--out", "mine.toml"))
        (folder / "p5.ppm").unlink()
        (folder / "new.ppm").write_bytes(picture())
        result = self.run_it("tune", "--labels", labels, "--rotate", "0", "--json", folder, "--out", "mine.toml")
        left_out = json.loads(result.stdout)["left_out"]
        self.assertEqual((result.returncode, left_out["without_label"], left_out["labels_without_picture"]), (0, 1, 1))

    def test_a_picture_that_cannot_be_read_is_named_and_identical_ones_count_once(self):
        folder, labels = self.album(b"\xe0\x60\x20", count=6)
        (folder / "p5.ppm").write_bytes(b"P6 nonsense")
        (folder / "p4.ppm").write_bytes((folder / "p3.ppm").read_bytes())
        result = self.run_it("tune", "--labels", labels, "--rotate", "0", "--json", folder, "--out", "mine.toml")
        answer = json.loads(result.stdout)
        self.assertEqual((result.returncode, answer["pictures"], answer["left_out"]["unusable"], answer["left_out"]["duplicates"]), (2, 4, 1, 1))
        self.assertIn("p5.ppm", result.stderr)

    def test_wrong_use_is_one_line_and_leaves_nothing(self):
        folder, labels = self.album(b"\xe0\x60\x20", count=2)
        self.assertIn("IMAGES", self.refused("tune", "--out", "mine.toml"))
        self.assertIn("--out", self.refused("tune", folder))
        self.assertIn("did you mean 'orange'", self.refused("tune", "--describe", "oragne", folder, "--out", "mine.toml"))
        self.assertIn("no hue", self.refused("tune", "--describe", "white", folder, "--out", "mine.toml"))
        self.assertIn("--out", self.refused("tune", folder, "--out", "no/such/mine.toml"))
        self.assertIn("none.csv", self.refused("tune", "--labels", "none.csv", folder, "--out", "mine.toml"))
        self.assertIn("no-such", self.refused("tune", "no-such", "--out", "mine.toml"))
        self.assertIn("--false-per-image", self.refused("tune", folder, "--false-per-image", "2", "--out", "mine.toml"))

    def test_a_broken_table_is_one_line_with_both_files(self):
        self.file("colors.toml", "version = 1\nabsolute = [\n  \"AAA")
        config = self.file("mine.toml", "[color]\ntable = \"colors.toml\"\n")
        for command in (("detect", self.file("a.ppm", "")), ("fly", "oval"), ("config",)):
            error = self.refused(*command, "--config", config)
            self.assertIn("mine.toml:2: color.table: ", error)
            self.assertIn("colors.toml:", error)


class Scores(Cli):
    LABELS = "image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\na.jpg,1,0,0,40,0,40,40,0,40\nb.jpg,0,,,,,,,,\n"
    FOUND = Pictures.CONTRACT + "\na.jpg,0,1,0,41,0,41,40,1,40,0.9,snake\nb.jpg,0,0,0,40,0,40,40,0,40,0.8,snake\n"

    def score(self, found, labels, *more):
        return ("score", "--detections", self.file("found.csv", found), "--labels", self.file("labels.csv", labels), *more)

    def test_json_and_screen_say_the_same(self):
        arguments = self.score(self.FOUND, self.LABELS)
        answer = json.loads(self.run_it(*arguments, "--json").stdout)
        self.assertEqual((answer["pictures"], answer["labelled_gates"], answer["hits"], answer["false_positives"]), (2, 1, 1, 1))
        self.assertEqual((answer["true_positive_rate"], answer["false_positives_per_image"]), (1.0, 0.5))
        self.assertEqual(answer["corner_error_px"]["best_order"], {"median": 1.0, "p90": 1.0})
        screen = self.run_it(*arguments)
        self.assertEqual((screen.returncode, screen.stderr), (0, ""))
        for text in ("1 of 1 (rate 1.000)", "1 (0.500 per image)", "median 1.0 px", "30-45 px 1/1"):
            self.assertIn(text, screen.stdout)

    def test_what_a_spreadsheet_makes_of_the_tables_is_read(self):
        wanted = self.run_it(*self.score(self.FOUND, self.LABELS)).stdout
        for form in (lambda text: "\ufeff" + text, lambda text: text.replace(",", ";").replace("0.9", "0,9"),
                     lambda text: "\ufeff" + text.replace(",", "\t").replace("\n", "\r\n")):
            self.assertEqual(self.run_it(*self.score(form(self.FOUND), form(self.LABELS))).stdout, wanted)

    def test_a_missing_column_is_named_with_those_there_are(self):
        error = self.refused(*self.score(self.FOUND, self.LABELS.replace("tl_v", "tlv")))
        self.assertIn("labels.csv:1: has no column 'tl_v' (there are: image, has_gate, tl_u, tlv, tr_u,", error)

    def test_ignore_forgives(self):
        ignore = self.file("ignore.csv", "image,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\nb.jpg,40,40,0,0,40,0,0,40\n")
        answer = json.loads(self.run_it(*self.score(self.FOUND, self.LABELS, "--ignore", ignore, "--json")).stdout)
        self.assertEqual((answer["false_positives"], answer["neither"]), (0, 1))

    def test_rates_of_nothing_are_null(self):
        answer = json.loads(self.run_it(*self.score(Pictures.HEADER + "\n", self.LABELS.splitlines()[0] + "\n", "--json")).stdout)
        self.assertIsNone(answer["true_positive_rate"])
        self.assertIsNone(answer["false_positives_per_image"])

    def test_a_picture_without_label_is_a_warning(self):
        result = self.run_it(*self.score(self.FOUND + "z.jpg,0,0,0,40,0,40,40,0,40,0.8,snake\n", self.LABELS))
        self.assertEqual(result.returncode, 0)
        self.assertIn("1 detections name pictures that are not in the labels: z.jpg", result.stderr)

    def test_broken_files_are_refused_with_line_and_column(self):
        self.assertIn("found.csv:2:3: tl_u = 'left'", self.refused(*self.score(self.FOUND.replace("0,1,0", "0,left,0", 1), self.LABELS)))
        self.assertIn("labels.csv:2:2: has_gate = '7'", self.refused(*self.score(self.FOUND, self.LABELS.replace("1,0", "7,0", 1))))
        self.assertIn("nowhere.csv", self.refused("score", "--detections", "nowhere.csv", "--labels", "labels.csv"))
        self.assertIn("--rule", self.refused(*self.score(self.FOUND, self.LABELS, "--rule", "iou60")))
        self.assertIn("--labels", self.refused("score", "--detections", "found.csv"))


class NothingIsLost(Cli):
    """What the user has is never replaced unasked, and never half."""
    FLIGHT = ("fly", "oval", "--vision", "ideal", "--laps", "1")
    FOREVER = ("fly", "showroom", "--vision", "ideal", "--laps", "100", "--out", "X")

    def setUp(self):
        super().setUp()
        (self.folder / "a.ppm").write_bytes(picture())

    def detect(self, *arguments, **more):
        return self.run_it("detect", "--rotate", "0", "a.ppm", *arguments, **more)

    def boards(self):
        for k in range(8):
            (self.folder / f"{k}.ppm").write_bytes(board_picture(0.3 + 0.03 * k, 0.8 * k))
        return *(f"{k}.ppm" for k in range(8)), "--pattern", "7x5", "--square-m", "0.03"

    def flight(self):
        return pathlib.Path(shutil.copytree(ROOT / "tests" / "replay" / "oval_flight", self.folder / "F"))

    def kept(self, path, reason, *arguments):
        """Refuses for this reason, before it works, and leaves the file."""
        before, began = path.read_bytes(), time.monotonic()
        self.assertIn(reason, self.refused(*arguments))
        self.assertLess(time.monotonic() - began, 5)
        self.assertEqual(path.read_bytes(), before)

    def interrupted(self, sent, watched, *arguments):
        """What a command says and answers that gets a signal when there is `watched`."""
        process = subprocess.Popen([GATEFLY, *arguments], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 60
        while not any(path.stat().st_size for path in self.folder.glob(watched)) and time.monotonic() < deadline:
            time.sleep(0.01)
        process.send_signal(sent)
        return process.communicate(timeout=60)[1].splitlines()[-1:], process.returncode

    def test_a_device_a_pipe_and_a_link_are_written_through(self):
        rows = self.detect().stdout
        os.mkfifo(self.folder / "pipe")
        with subprocess.Popen(["timeout", "20", "cat", "pipe"], cwd=self.folder, stdout=subprocess.PIPE, text=True) as reader:
            self.assertEqual(self.detect("--csv", "pipe").returncode, 0)
            self.assertEqual(reader.communicate(timeout=60)[0], rows)
        self.assertTrue((self.folder / "pipe").is_fifo())
        for target in ("there.csv", "new.csv"):
            link = self.folder / ("to-" + target)
            link.symlink_to(target)
            if target == "there.csv":
                self.file(target, rows)
            self.assertEqual(self.detect("--csv", link).returncode, 0)
            self.assertTrue(link.is_symlink())
            self.assertEqual((self.folder / target).read_text(), rows)
        for name in ("-", "/proc/self/fd/1"):  # no fault can replace that
            self.assertEqual(self.detect("--csv", name).stdout, rows)

    @unittest.skipUnless(os.geteuid() == 0, "only root makes devices")
    def test_a_device_stays_one_and_a_disk_is_refused(self):
        try:
            os.mknod(self.folder / "null", 0o666 | stat.S_IFCHR, os.makedev(1, 3))
            os.mknod(self.folder / "disk", 0o600 | stat.S_IFBLK, os.makedev(7, 250))
            open(self.folder / "null", "wb").close()
        except PermissionError:
            self.skipTest("no devices may be made here")
        self.assertEqual(self.detect("--csv", "null").returncode, 0)
        self.assertTrue((self.folder / "null").is_char_device())
        self.assertIn("is a disk", self.refused("detect", "a.ppm", "--csv", "disk"))
        self.assertTrue((self.folder / "disk").is_block_device())

    def test_dash_is_standard_output_everywhere(self):
        rows = self.run_it("replay", self.flight(), "--csv", "-").stdout.splitlines()
        self.assertTrue(rows[0].startswith("t_s,x_m") and rows[-1].count(",") == 13, rows[-1])
        for arguments in (("replay", "F", "--csv", "-", "--json"), ("tune", "a.ppm", "--out", "-"), (*self.FLIGHT, "--out", "-"),
                          ("campaign", "oval", "--runs", "1", "--out", "-"), ("detect", "a.ppm", "--annotate", "-"),
                          ("reproduce", "pose-ls-p3p", "--out", "-")):
            self.assertIn(" -", self.refused(*arguments))

    def test_an_output_that_is_an_input_names_both(self):
        album = self.folder / "album"
        album.mkdir()
        shutil.copy(self.folder / "a.ppm", album)
        labels = album / "labels.csv"
        labels.write_text(Scores.LABELS, encoding="utf-8")
        found, camera = self.file("found.csv", Scores.FOUND), self.file("cam.toml", "[camera]\nstored_rotation_deg = 0\n")
        os.link(self.folder / "a.ppm", self.folder / "twin.csv")
        track = self.file("oval.toml", (ROOT / "tracks" / "oval.toml").read_text())
        log = next(self.flight().glob("log_si.csv*"))
        boards = self.boards()
        for path, arguments, named in (
                (self.folder / "a.ppm", ("detect", "a.ppm", "--csv", "a.ppm"), "input a.ppm"),
                (self.folder / "twin.csv", ("detect", "a.ppm", "--csv", "twin.csv"), "input a.ppm"),
                (labels, ("detect", "album", "--csv", "album/labels.csv"), "input album"),
                (camera, ("detect", "a.ppm", "--config", "cam.toml", "--csv", "cam.toml"), "input cam.toml"),
                (log, ("replay", "F", "--csv", f"F/{log.name}"), "input F"),
                (track, ("replay", "F", "--track", "oval.toml", "--csv", "oval.toml"), "input oval.toml"),
                (self.folder / "3.ppm", ("calibrate", *boards, "--out", "3.ppm"), "input 3.ppm"),
                (self.folder / "3.ppm", ("calibrate", *boards, "--report", "3.ppm"), "input 3.ppm"),
                (camera, ("calibrate", "--from", "cam.toml", "--out", "cam.toml"), "input cam.toml"),
                (camera, ("tune", "album", "--config", "cam.toml", "--out", "cam.toml"), "input cam.toml"),
                (labels, ("tune", "album", "--labels", labels, "--out", "album/labels.csv"), "album/labels.csv"),
                (found, ("tune", "album", "--labels", "found.csv", "--out", "found.csv"), "input found.csv")):
            for more in ((), ("--force",)):
                with self.subTest(arguments=arguments, more=more):
                    self.kept(path, "would overwrite", *arguments, *more)
                    self.assertIn(named, self.refused(*arguments, *more))

    def test_a_file_of_another_kind_is_replaced_by_force_only(self):
        self.flight()
        self.file("labels.csv", Scores.LABELS)
        letter, plot = self.file("letter", "Dear Anna"), self.file("mine.roc.csv", "day,rain\n")
        (self.folder / "drawn").mkdir()
        drawing = self.file("drawn/a.ppm.png", "my photo")
        for path, arguments in ((letter, ("detect", "a.ppm", "--csv", "letter")), (letter, ("replay", "F", "--csv", "letter")),
                                (letter, ("calibrate", *self.boards(), "--out", "letter")),
                                (letter, ("calibrate", *self.boards(), "--report", "letter")),
                                (letter, ("tune", "a.ppm", "--out", "letter")), (plot, ("tune", "a.ppm", "--out", "mine.toml")),
                                (drawing, ("detect", "a.ppm", "--annotate", "drawn"))):
            with self.subTest(arguments=arguments):
                self.kept(path, "--force", *arguments)
        for _ in range(2):  # by force, then because it is an earlier one
            self.assertEqual(self.detect("--csv", "letter", "--annotate", "drawn", "--force").returncode, 0)
        self.assertEqual(self.detect("--csv", "letter", "--annotate", "drawn").returncode, 0)
        self.assertEqual(letter.read_text(), self.detect().stdout)
        self.assertTrue(drawing.read_bytes().startswith(b"\x89PNG"))
        results = self.folder / "out" / "reproduce" / "pose-ls-p3p"
        results.mkdir(parents=True)
        (results / "plot.png").write_text("mine", encoding="utf-8")
        self.kept(results / "plot.png", "holds no earlier result", "reproduce", "pose-ls-p3p", "--quick")

    def test_who_may_read_a_table_stays(self):
        table = self.file("found.csv", "")
        table.chmod(0o600)
        neighbour = self.file("found.csv.partial", "mine")
        self.assertEqual(self.detect("--csv", table).returncode, 0)
        self.assertEqual((table.stat().st_mode & 0o777, neighbour.read_text()), (0o600, "mine"))

    def test_a_flight_is_replaced_by_a_whole_one_and_what_is_not_of_it_stays(self):
        self.assertEqual(self.run_it(*self.FLIGHT, "--out", "X").stderr.count("in place of"), 0)
        self.file("X/flight.mp4", "a film")
        notes, replaced = self.file("X/notes.txt", "mine"), self.folder / "X.replaced"
        replaced.mkdir()
        sent = self.interrupted(signal.SIGINT, "X.partial/log_si.csv", *self.FOREVER)
        self.assertEqual(sent, (["gatefly fly: interrupted, nothing kept"], 130))
        self.assertEqual(json.loads((self.folder / "X/summary.json").read_text())["track"], "oval")
        result = self.run_it(*self.FLIGHT, "--seed", "2", "--out", "X")
        self.assertEqual(result.stderr.splitlines()[-1],
                         "gatefly fly: X/: in place of the flight that was there, whose film is now flight-before-1.mp4")
        self.assertEqual(json.loads((self.folder / "X/summary.json").read_text())["seed"], 2)
        self.assertIn('"seed":2,', (self.folder / "X/report.html").read_text(encoding="utf-8"))
        self.assertEqual((notes.read_text(), (self.folder / "X/flight-before-1.mp4").read_text()), ("mine", "a film"))
        self.assertTrue(replaced.is_dir())

    def test_folders_that_are_no_flights_are_left_alone(self):
        for name, content in (("X.partial/thesis.tex", "mine"), ("Y.partial/summary.json", "{}"), ("Z/summary.json", '{"lines": 3}')):
            path = self.folder / name
            path.parent.mkdir()
            path.write_text(content, encoding="utf-8")
            self.kept(path, path.parent.name, *self.FLIGHT, "--out", name[0])
        self.assertIn("a folder of its own", self.refused(*self.FLIGHT, "--out", self.folder))
        self.assertIn("a folder of its own", self.refused(*self.FLIGHT, "--out", self.folder.parent))

    def test_a_link_to_a_folder_of_flights_keeps_pointing(self):
        (self.folder / "disk").mkdir()
        (self.folder / "X").symlink_to("disk")
        for _ in range(2):
            self.assertEqual(self.run_it(*self.FLIGHT, "--out", "X").returncode, 0)
        self.assertTrue((self.folder / "X").is_symlink() and (self.folder / "disk" / "summary.json").exists())

    def test_of_two_flights_into_one_folder_the_second_does_not_begin(self):
        first = subprocess.Popen([GATEFLY, *self.FOREVER], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while not (self.folder / "X.partial" / "settings.txt").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        second = self.run_it(*self.FLIGHT, "--out", "X")
        first.send_signal(signal.SIGTERM)
        first.wait(timeout=60)
        self.assertEqual((second.returncode, second.stderr), (2, "gatefly: X: cannot be written: another gatefly is writing it now\n"))

    def test_of_two_results_into_one_folder_the_second_is_not_begun(self):
        arguments = ("reproduce", "pose-ls-p3p", "--quick")
        with subprocess.Popen([GATEFLY, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as first:
            deadline = time.monotonic() + 60
            while not list(self.folder.glob("out/reproduce/*/.gatefly.partial")) and time.monotonic() < deadline:
                time.sleep(0.01)
            second = self.run_it(*arguments)
            first.send_signal(signal.SIGTERM)
        self.assertEqual(second.returncode, 2)
        self.assertEqual(second.stderr.count("\n"), 1, second.stderr)
        self.assertIn("another gatefly is writing it now", second.stderr)
        self.assertEqual((first.returncode, [path.name for path in self.folder.iterdir()]), (143, ["a.ppm"]))

    def test_a_signal_leaves_nothing_half(self):
        for sent, code in ((signal.SIGTERM, 143), (signal.SIGHUP, 129)):
            answer = self.interrupted(sent, "X.partial/log_si.csv", *self.FOREVER)
            self.assertEqual(answer, (["gatefly fly: interrupted, nothing kept"], code))
        album = self.folder / "album"
        album.mkdir()
        for k in range(1500):
            os.link(self.folder / "a.ppm", album / f"{k}.ppm")
        (self.folder / "old").mkdir()
        for folder in ("new", "old"):
            answer = self.interrupted(signal.SIGINT, f"{folder}/**/*.png", "detect", "--rotate", "0", "album", "--annotate", folder)
            self.assertEqual(answer, (["gatefly detect: interrupted, nothing kept"], 130))
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["a.ppm", "album", "old"])
        self.assertEqual(list((self.folder / "old").iterdir()), [])

    def test_after_a_kill_the_next_flight_clears_up(self):
        self.interrupted(signal.SIGKILL, "X.partial/log_si.csv", *self.FOREVER)
        self.assertTrue((self.folder / "X.partial").is_dir())
        self.assertIn("X.partial", self.refused("replay", "X.partial"))
        self.assertEqual(self.run_it(*self.FLIGHT, "--out", "X").returncode, 0)
        self.assertFalse((self.folder / "X.partial").exists())

    def test_a_standard_output_that_takes_nothing_is_said(self):
        score = ("score", "--detections", self.file("found.csv", Scores.FOUND), "--labels", self.file("labels.csv", Scores.LABELS))
        for arguments in (("detect", "a.ppm"), ("detect", "a.ppm", "--json"), (*self.FLIGHT, "--json", "-q"), (*self.FLIGHT, "-q"),
                          ("config",), ("config", "--json"), score, (*score, "--json"), ("--help",), ("--version",),
                          ("reproduce", "--list"), ("replay", self.flight() if not (self.folder / "F").exists() else "F", "--json")):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            with self.subTest(arguments=arguments), open("/dev/full", "w", encoding="utf-8") as full:
                result = subprocess.run([GATEFLY, *arguments], stdout=full, stderr=subprocess.PIPE, text=True, cwd=self.folder, check=False,
                                        timeout=120)
                self.assertEqual((result.returncode, result.stderr.splitlines()[-1]),
                                 (2, "gatefly: standard output: cannot be written: No space left on device"))
        self.assertTrue((self.folder / "F").is_dir())

    def test_a_reader_that_has_seen_enough_is_no_fault(self):
        read, write = os.pipe()
        os.close(read)
        result = subprocess.run([GATEFLY, "config"], stdout=write, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        os.close(write)
        self.assertEqual((result.returncode, result.stderr), (-signal.SIGPIPE, ""))

    def test_a_closed_standard_output_does_not_lead_into_a_file(self):
        result = subprocess.run(["sh", "-c", '"$0" detect --rotate 0 a.ppm --csv found.csv >&-', GATEFLY], cwd=self.folder,
                                stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        self.assertEqual((result.returncode, result.stderr.splitlines()[-1]),
                         (2, "gatefly: standard output: cannot be written: Bad file descriptor"))
        self.assertEqual((self.folder / "found.csv").read_text(), self.detect().stdout)

    def test_outputs_that_cannot_be_written_are_found_before_the_work(self):
        boards = self.boards()
        self.file("file", "")
        for arguments in (("reproduce", "pose-ls-p3p", "--out", "file/x"), ("reproduce", "pose-ls-p3p", "--out", "/proc/x"),
                          ("calibrate", *boards, "--out", "/proc/c.toml"), ("calibrate", *boards, "--report", "/proc/c.png"),
                          ("calibrate", *boards, "--out", "c", "--report", "c"), ("tune", "a.ppm", "--out", "/proc/c.toml"),
                          ("tune", "a.ppm", "--out", "x" * 250 + ".toml"), (*self.FLIGHT, "--out", "/proc/x"),
                          ("campaign", "oval", "--runs", "9", "--out", "file/c"), ("detect", "a.ppm", "--annotate", "file"),
                          ("detect", "a.ppm", "--csv", "/proc/c.csv"), ("replay", self.folder, "--csv", "/proc/c.csv")):
            with self.subTest(arguments=arguments):
                self.refused(*arguments)

    def test_an_empty_name_is_no_file(self):
        for flag, arguments in (("--out", self.FLIGHT), ("--csv", ("detect", "a.ppm")), ("--annotate", ("detect", "a.ppm")),
                                ("--data", ("detect", "a.ppm")), ("--out", ("campaign", "oval", "--runs", "1")),
                                ("--out", ("calibrate", "a.ppm")), ("--report", ("calibrate", "a.ppm")), ("--out", ("tune", "a.ppm")),
                                ("--out", ("reproduce", "pose-ls-p3p")), ("--csv", ("replay", "F"))):
            self.assertIn(flag + ": must not be empty", self.refused(*arguments, flag, ""))
        for command, name in (("detect", "PATH"), ("replay", "DIR"), ("calibrate", "PATH"), ("identify", "DIR")):
            self.assertIn(name + ": must not be empty", self.refused(command, ""))


    def test_a_disk_that_takes_no_more_leaves_all_as_it_was(self):
        self.flight()
        boards, (album, labels) = self.boards(), Tune.album(self, b"\x30\xa0\x40")
        for number, (tight, arguments) in enumerate((
                (100, ("detect", "--rotate", "0", "a.ppm", "--csv", "found.csv", "--annotate", "drawn")),
                (1000, ("detect", "--rotate", "0", "a.ppm", "--csv", "found.csv", "--annotate", "drawn")),
                (9000, ("replay", "F", "--csv", "estimates.csv")), (9000, self.FLIGHT), (300, ("campaign", "oval", "--runs", "2", *self.FLIGHT[2:])),
                (100, ("calibrate", *boards, "--out", "c.toml", "--report", "c.png")),
                (9000, ("calibrate", *boards, "--out", "c.toml", "--report", "c.png")),
                (9000, ("tune", "--labels", labels, "--rotate", "0", album, "--out", "mine.toml")),
                (9000, ("reproduce", "pose-ls-p3p", "--quick")))):
            def files():
                return {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file() and "cache" not in path.parts}
            for again in (False, True):
                with self.subTest(arguments=arguments, tight=tight, again=again):
                    if again:  # over what is there
                        self.assertIn(self.run_it(*arguments).returncode, (0, 1))
                    before = files()
                    result = self.run_it(*arguments, "-q", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (tight, tight)))
                    self.assertEqual((result.returncode, result.stdout, result.stderr.count("\n")), (2, "", 1), result.stderr)
                    self.assertIn("cannot be written", result.stderr)
                    if arguments[0] == "campaign":  # it goes on where it stopped
                        self.assertEqual(set(files()), set(before))
                    else:
                        self.assertEqual(files(), before)


class RealPictures(Cli):
    GATES = pathlib.Path(os.environ.get("GATEFLY_DATA", "../shared/data")) / "tudelft_bebop_gates"

    def setUp(self):
        super().setUp()
        self.gates = (ROOT / self.GATES).resolve()
        if not self.gates.is_dir():
            self.skipTest(f"no real pictures at {self.gates} (set GATEFLY_DATA)")

    def test_pictures_and_labels_count_as_the_data_says(self):
        nothing = self.file("none.csv", Pictures.HEADER + "\n")
        for name, rule, pictures, gates in (("basement32_hq", "overlap70", 32, 28), ("distance51", "iou50", 51, 51),
                                            ("cyberzoo", "overlap70", 299, 150), ("basement580", "overlap70", 398, 142),
                                            ("basement580", "overlap70-authors", 580, 212)):
            with self.subTest(name=name, rule=rule):
                result = self.run_it("score", "--json", "--detections", nothing, "--rule", rule,
                                     "--labels", self.gates / name / "labels.csv")
                answer = json.loads(result.stdout)
                self.assertEqual((answer["pictures"], answer["labelled_gates"]), (pictures, gates))

    def test_every_real_picture_can_be_read(self):
        result = self.run_it("detect", "--json", "--config", "cyberzoo", *(self.gates / name for name in ("basement32_hq", "distance51")),
                             *sorted((self.gates / "distance51").glob("*.uyvy")))
        answer = json.loads(result.stdout)
        self.assertEqual((result.returncode, answer["pictures"], answer["unusable"]), (0, 32 + 51 + 51, 0))

    def test_raw_pictures_and_their_jpegs_show_the_same_gates(self):
        def corners_in_view(kind, *options):
            pictures = sorted((self.gates / "distance51").glob("*." + kind))
            answer = json.loads(self.run_it("detect", "--json", "--config", "cyberzoo", *options, *pictures).stdout)
            found = {}
            for row in answer["detections"]:
                # one that the border cuts may be a gate in one and a part in the other
                if row["method"] != "bars" and min(row["corner_fitness"]) > 0:
                    found.setdefault(row["image"].split(".")[0], []).append(row["corners_px"])
            return found

        for options in ((), ("--all",)):
            raw, jpeg = corners_in_view("uyvy", *options), corners_in_view("jpg", *options)
            self.assertEqual(sorted(raw), sorted(jpeg))
            self.assertGreaterEqual(len(raw), 45)
            off = []
            for name, gates in raw.items():
                self.assertEqual(len(gates), len(jpeg[name]), name)
                for gate in gates:  # of equally sure gates either may be the first
                    off.append(min(max(map(math.dist, gate, other)) for other in jpeg[name]))
            off.sort()
            self.assertLessEqual(off[-3], 1.0, options)
            self.assertLessEqual(off[-1], 2.0, options)

    @unittest.skipUnless(shutil.which("ffmpeg"), "there is no ffmpeg")
    def test_the_film_of_a_lap_has_all_its_frames(self):
        result = self.run_it("detect", "--json", "--config", "basement", self.gates / "basement_lap_video" / "f7.avi")
        self.assertEqual(json.loads(result.stdout)["pictures"], 540)


    def test_the_papers_detectors_are_modes_of_detect(self):
        for mode in ("paper", "flown"):
            result = self.run_it("detect", "--json", "--all", "--config", "basement", "--set", f"detector.mode={mode}", self.gates / "basement32_hq")
            answer = json.loads(result.stdout)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertGreaterEqual(answer["with_gate"], 10)
            most = max(row["gate"] for row in answer["detections"])
            self.assertTrue(most > 0 if mode == "paper" else most == 0, most)

    def test_reproduce_writes_whole_results(self):
        result = self.run_it("reproduce", "tpr-distance", "approach-sequence", "--quick", "--data", self.gates.parent)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("paper", result.stdout)
        for name, extra in (("tpr-distance", ["examples.png"]), ("approach-sequence", [])):
            folder = self.folder / "out" / "reproduce" / name
            self.assertEqual(sorted(path.name for path in folder.iterdir()), extra + ["plot.png", "result.csv", "result.json"])
            self.assertTrue(json.loads((folder / "result.json").read_text())["quick"])
        again = self.run_it("reproduce", "tpr-distance", "--quick", "--json", "--data", self.gates.parent)
        self.assertEqual(json.loads(again.stdout)["tpr-distance"],
                         json.loads((self.folder / "out/reproduce/tpr-distance/result.json").read_text()))


class Page(html.parser.HTMLParser):
    """What is on a page: elements that are opened and closed in order, sections, addresses, cells."""
    VOID = {"meta", "img", "br", "link", "input"}

    def __init__(self, text):
        super().__init__()
        self.open, self.sections, self.addresses, self.cells, self.broken = [], [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "section":
            self.sections.append(attributes["id"])
        self.addresses += [attributes[name] for name in ("src", "href") if name in attributes]
        if tag == "td":
            self.cells.append("")
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.broken.append(tag)

    def handle_data(self, data):
        if "td" in self.open:
            self.cells[-1] += data


class Reproduce(Cli):
    NAMES = ("roc-length", "roc-fitness", "tpr-distance", "approach-sequence", "own-detector", "detection-failures")

    def test_list_needs_no_data(self):
        result = self.run_it("reproduce", "--list", GATEFLY_DATA="/nowhere")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for name in self.NAMES:
            self.assertIn(name, result.stdout)
        listed = json.loads(self.run_it("reproduce", "--list", "--json").stdout)
        self.assertEqual([entry["name"] for entry in listed][:6], list(self.NAMES))

    def test_all_that_was_run_stands_on_one_page(self):
        done = self.run_it("reproduce", "pose-bars", "feasible-set", "--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        path = self.folder / "out/reproduce/report.html"
        text = path.read_text(encoding="utf-8")
        page = Page(text)
        self.assertEqual((page.broken, page.open), ([], []))
        self.assertEqual(page.sections, ["pose-bars", "feasible-set"])
        self.assertLess(len(text), 5_000_000)
        for address in page.addresses:
            self.assertTrue(address.startswith(("data:image/", "#")), address[:60])
        self.assertIn("gatefly reproduce pose-bars --quick", page.cells)
        for cell in ("as run, 0° x", "as run, 0° y"):
            self.assertIn(cell, page.cells)
        self.assertEqual(text.count(">quick run<"), 2)
        one = self.run_it("reproduce", "pose-bars", "--quick")
        self.assertEqual(one.returncode, 0, one.stderr)
        self.assertEqual(Page(path.read_text(encoding="utf-8")).sections, ["pose-bars"])
        path.write_text("mine", encoding="utf-8")
        self.assertIn("report.html", self.refused("reproduce", "pose-bars", "--quick"))
        self.assertEqual(path.read_text(encoding="utf-8"), "mine")

    def test_unknown_names_and_none_at_all(self):
        self.assertIn("did you mean 'roc-length'", self.refused("reproduce", "roc-lenght"))
        self.assertIn("--all", self.refused("reproduce"))

    def test_without_data_one_line_and_nothing_written(self):
        for name in self.NAMES:
            error = self.refused("reproduce", name, GATEFLY_DATA=str(self.folder / "nowhere"))
            self.assertIn("tudelft_bebop_gates", error)
            self.assertIn("--data", error)
        self.assertIn("no-such", self.refused("reproduce", "--all", "--data", "no-such"))
        (self.folder / "data" / "tudelft_bebop_gates").mkdir(parents=True)
        for name in self.NAMES:
            self.refused("reproduce", name, "--data", "data")


class Configuration(Cli):
    def test_any_detector_flies_and_a_wrong_name_is_refused(self):
        self.assertIn("must be", self.refused("detect", "a.ppm", "--set", "detector.mode=papr"))
        done = self.run_it("fly", "oval", "--laps", "1", "--vision", "ideal", "--set", "detector.mode=fast", "--json", "--out", "flown")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_papers_control_needs_exits(self):
        self.assertIn('gate 1 has no exit: control.mode = "paper" flies by exits',
                      self.refused("fly", "showroom", "--set", "control.mode=paper"))

    def test_a_key_of_the_colour_box_is_said_to_have_no_effect(self):
        result = self.run_it("config", "--show", "--set", "color.y_min=30")
        self.assertEqual(result.returncode, 0)
        self.assertIn("color.y_min has no effect any more", result.stderr)
        self.assertNotIn("y_min", result.stdout)

    def test_the_old_name_of_a_key_still_works_and_is_said_to_be_old(self):
        result = self.run_it("config", "--show", "--set", "sim.ghosts_percent=30")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("--set: sim.ghosts_percent is the old name of sim.outliers_percent", result.stderr)
        self.assertRegex(result.stdout, r"\noutliers_percent += 30 ")
        self.assertNotIn("ghosts", result.stdout)

    def test_show_lists_every_section_with_units_and_sources(self):
        result = self.run_it("config", "--show", "--set", "control.speed_mps=1.25")
        self.assertEqual(result.returncode, 0)
        for section in ("camera", "color", "detector", "gate", "pose", "ahrs", "filter", "control", "vehicle", "sim",
                        "randomize"):
            self.assertIn(f"[{section}]", result.stdout)
        self.assertIn("set by --set", result.stdout)
        self.assertIn("default.toml", result.stdout)

    def test_json_reads_back(self):
        result = self.run_it("config", "--json", "--set", "camera.tilt_deg=12.5")
        self.assertEqual(json.loads(result.stdout)["camera"]["tilt_deg"], 12.5)

    def test_wrong_set_key_suggests_the_nearest(self):
        for command in ("fly", "config"):
            error = self.refused(command, "--set", "camera.tlit_deg=3")
            self.assertIn("--set: camera.tlit_deg", error)
            self.assertIn("'camera.tilt_deg'", error)

    def test_wrong_set_values(self):
        self.assertIn("must be a number in -90..90", self.refused("config", "--set", "camera.tilt_deg=steep"))
        self.assertIn("nan", self.refused("config", "--set", "camera.tilt_deg=nan"))
        self.assertIn("section.key=value", self.refused("config", "--set", "camera.tilt_deg"))

    def test_config_file_errors_name_the_file(self):
        path = self.file("mine.toml", "[control]\nrest_samples = \"many\"\n")
        self.assertIn("mine.toml:2: control.rest_samples = \"many\"", self.refused("config", "--config", path))
        self.assertIn("default", self.refused("config", "--config", "no-such"))

    def config_file(self, content):
        return self.refused("config", "--config", self.file("mine.toml", content))

    def test_a_key_outside_or_in_the_wrong_section_is_told_its_own(self):
        self.assertIn("tilt_deg stands outside every [section], did you mean 'camera.tilt_deg'?",
                      self.config_file("tilt_deg = 3\n"))
        self.assertIn("did you mean 'camera.tilt_deg'?", self.config_file("[detector]\ntilt_deg = 3\n"))
        self.assertIn("did you mean 'camera.tilt_deg'?", self.refused("config", "--set", "tilt_deg=3"))
        self.assertIn("must be a section", self.config_file("camera = 3\n"))

    def test_an_unknown_section_lists_those_there_are(self):
        self.assertIn("[xyz] is not a known section (there are: ahrs, camera,", self.config_file("[xyz]\na = 3\n"))

    def test_a_key_like_no_other_is_told_where_they_are_listed(self):
        self.assertIn("config --show", self.refused("config", "--set", "camera.zzzzzzzzzzzz=3"))

    def test_a_key_given_twice_in_a_file_is_refused_and_the_last_set_wins(self):
        self.assertIn("mine.toml:3:", self.config_file("[camera]\ntilt_deg = 3\ntilt_deg = 4\n"))
        result = self.run_it("config", "--json", "--set", "camera.tilt_deg=3", "--set", "camera.tilt_deg=4")
        self.assertEqual(json.loads(result.stdout)["camera"]["tilt_deg"], 4)

    def test_spaces_around_a_set_key_do_not_matter(self):
        result = self.run_it("config", "--json", "--set", " camera.tilt_deg = 3")
        self.assertEqual(json.loads(result.stdout)["camera"]["tilt_deg"], 3)

    def test_names_of_several_lines_or_any_length_are_shown_on_one(self):
        self.config_file('[camera]\n"ti\\nlt" = 3\n')
        self.config_file('["a\\nb"]\ntilt = 3\n')
        self.refused("config", "--set", "camera.til\nt=a")
        self.refused("fly\nhigh")
        self.assertLess(len(self.config_file("[" + "y" * 100000 + "]\na = 1\n")), 500)
        self.assertLess(len(self.config_file("[camera]\nfocal_px = " + str([0] * 100000) + "\n")), 500)
        self.assertIn("kämera", self.refused("config", "--set", "kämera.tält=3"))

    def test_a_folder_is_not_a_configuration(self):
        (self.folder / "d.toml").mkdir()
        self.assertIn("d.toml: is a folder, not a file", self.refused("config", "--config", "d.toml"))
        self.assertIn("is a folder", self.refused("fly", "."))
        self.assertIn('"": no such file', self.refused("config", "--config", ""))

    def test_a_pipe_can_be_a_configuration(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        program = subprocess.Popen([GATEFLY, "config", "--json", "--config", str(pipe)], stdout=subprocess.PIPE, text=True)
        pipe.write_text("[camera]\ntilt_deg = 7\n", encoding="utf-8")
        self.assertEqual(json.loads(program.communicate(timeout=60)[0])["camera"]["tilt_deg"], 7)

    def test_empty_file_changes_nothing_and_a_binary_one_is_refused(self):
        self.assertEqual(self.run_it("config", "--json", "--config", self.file("empty.toml", "")).stdout,
                         self.run_it("config", "--json").stdout)
        noise = self.folder / "noise.toml"
        noise.write_bytes(bytes(range(256)))
        self.assertIn("noise.toml:", self.refused("config", "--config", noise))

    def test_every_camera_model_wants_its_own_number_of_coefficients(self):
        for model, needs in (("brown-conrady", "5 numbers [k1, k2, p1, p2, k3]"), ("kannala-brandt", "4 numbers")):
            error = self.refused("config", "--set", f"camera.model={model}", "--set", "camera.distortion=[0.1, 0.2]")
            self.assertIn(f"camera.distortion = [0.1, 0.2], must be {needs}", error)
        self.assertIn('"kannala-brandt"', self.refused("config", "--set", "camera.model=fisheye"))

    def test_show_gives_every_key_a_value_and_a_source(self):
        for line in self.run_it("config", "--show").stdout.splitlines():
            if line and not line.startswith("["):
                self.assertRegex(line, r"^(# )?[a-z0-9_]+ += .+  # .*(default: .+|set by .+)$")

    def test_shipped_configurations_load(self):
        for path in (*ROOT.glob("configs/*.toml"), *ROOT.glob("cameras/*.toml"), *ROOT.glob("vehicles/*.toml")):
            with self.subTest(path=path.name):
                self.assertEqual(self.run_it("config", "--config", path).returncode, 0)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    GATEFLY = str(pathlib.Path(sys.argv[1]).resolve())
    ROOT = pathlib.Path(sys.argv[2]).resolve()
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
