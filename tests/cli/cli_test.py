#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The program from outside: exit codes, one line on stderr, and that it says what is allowed.

usage: cli_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
Nothing here renders or flies but the few seconds of Video: every other case is refused before take-off, or
only prints.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

GATEFLY = ""
ROOT = pathlib.Path()

GATE = "[[gates]]\nposition_m = [3.0, 0.0, -1.5]\n"


class Cli(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_it(self, *arguments, **variables):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"), **variables)
        return subprocess.run([GATEFLY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder,
                              env=environment, timeout=120, check=False)

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
        for command in ("fly", "config"):
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
        self.assertIn("--vision", self.refused("fly", "--vision", "real"))

    def test_ideal_vision_is_not_available_yet(self):
        self.assertIn("not available yet", self.refused("fly", "--vision", "ideal"))


class Tracks(Cli):
    def test_unknown_track_lists_the_available_ones(self):
        error = self.refused("fly", "showrom")
        self.assertIn("oval, showroom", error)
        self.assertIn("did you mean 'showroom'", error)

    def test_broken_toml_names_the_line(self):
        self.assertIn("mine.toml:2:", self.fly_track("laps = 1\nstart = = 3\n" + GATE))

    def test_unknown_key_suggests_the_nearest(self):
        error = self.fly_track(GATE + "hedding_deg = 3\n")
        self.assertIn("gates[0].hedding_deg", error)
        self.assertIn("'heading_deg'", error)

    def test_not_a_number_is_refused(self):
        self.assertIn("gates[0].position_m = [nan, 0, -1.5]",
                      self.fly_track("[[gates]]\nposition_m = [nan, 0.0, -1.5]\n"))

    def test_negative_side_names_file_key_value_and_range(self):
        self.assertIn("mine.toml: gates[0].side_m = -1, must be in 0.3..5", self.fly_track(GATE + "side_m = -1\n"))

    def test_gate_too_low_is_refused_before_take_off(self):
        error = self.fly_track("[[gates]]\nposition_m = [3.0, 0.0, -0.3]\n")
        self.assertIn("mine.toml", error)
        self.assertIn("gates[0].position_m", error)

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
        self.assertEqual((stream["width"], stream["height"]), (1280, 720))
        seconds = float(answer["format"]["duration"])
        self.assertGreaterEqual(seconds, flown)
        self.assertLessEqual(seconds, flown + 2.5)  # the last frame is held for a while
        self.assertAlmostEqual(int(stream["nb_read_frames"]), 20 * seconds, delta=1)


class Configuration(Cli):
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
        path = self.file("mine.toml", "[detector]\nsamples = \"many\"\n")
        self.assertIn("mine.toml: detector.samples = \"many\"", self.refused("config", "--config", path))
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
                self.assertRegex(line, r"^[a-z0-9_]+ += .+  # .*(default: .+|set by .+)$")

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
