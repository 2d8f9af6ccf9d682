#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command line itself: help, words, wrong flags, configurations, the doctor.

usage: command_line_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import re
import shutil
import subprocess
import tomllib

from program import GATEFLY, ROOT, Cli, main


class Help(Cli):
    def test_help_of_the_program_and_every_command_has_an_example(self):
        listing = self.run_it("--help")
        self.assertEqual(listing.returncode, 0)
        for command in ("fly", "config", "detect", "score", "campaign", "bench", "calibrate", "identify", "tune", "reproduce",
                        "map", "track", "doctor", "new", "run", "bench-drone", "link-sim", "import", "record"):
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
        self.assertEqual(self.run_it("-V").stdout, result.stdout)


class Words(Cli):
    """The program's words on itself and on its work."""
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


class CommandLine(Cli):
    def test_no_command_is_help(self):
        bare = self.run_it()
        self.assertEqual((bare.returncode, bare.stdout, bare.stderr), (0, self.run_it("--help").stdout, ""))
        self.assertIn("--help", self.refused("--quiet"))

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

    def test_a_key_of_another_section_is_suggested_by_its_last_part(self):
        error = self.refused("config", "--set", "sim.wind_mps=0.1")
        self.assertIn("did you mean 'randomize.wind_mps' or 'faults.wind_mps'?", error)
        self.assertIn("did you mean 'control.speed_mps'?", self.refused("config", "--set", "vehicle.speed=1"))
        self.assertIn("did you mean 'camera.tilt_deg'?", self.refused("config", "camera.tlit_deg"))

    def test_one_key_is_told_with_unit_bounds_and_source(self):
        said = self.run_it("config", "control.speed_mps").stdout
        self.assertRegex(said, r"^control.speed_mps = \d[\d.]*\n  unit     m/s\n  what     .*\n  allowed  a number in 0\.2\.\.10\n  source   default: ")
        told = json.loads(self.run_it("config", "control.speed_mps", "--json", "--set", "control.speed_mps=1.25").stdout)
        self.assertEqual((told["key"], told["value"], told["unit"], told["source"]), ("control.speed_mps", 1.25, "m/s", "set by --set"))
        self.assertIn("= the track's\n", self.run_it("config", "randomize.wind_mps").stdout)
        self.assertEqual(self.run_it("config", "control.speed_mps", "--quiet").stdout.count("\n"), 1)
        self.assertIn("config camera: is not a known key", self.refused("config", "camera"))

    def test_filter_shows_what_is_about_a_word_and_is_a_configuration(self):
        wind = self.run_it("config", "--filter", "WIND")
        self.assertIn("wind_mps", wind.stdout)
        keys = [line for line in wind.stdout.splitlines() if line and not line.startswith("[")]
        self.assertTrue(keys and all("wind" in line.lower() for line in keys), wind.stdout)
        tilt = tomllib.loads(self.run_it("config", "--filter", "camera.tilt").stdout)
        self.assertEqual(list(tilt["camera"]), ["tilt_deg"])
        none = self.run_it("config", "--filter", "xyzzy")
        self.assertEqual((none.returncode, none.stdout, none.stderr), (1, "", "gatefly config: no key is about 'xyzzy'\n"))
        self.assertEqual(json.loads(self.run_it("config", "--filter", "camera.tilt", "--json").stdout)[0]["key"], "camera.tilt_deg")

    def test_cameras_and_vehicles_are_configurations_too(self):
        for name, key, value in (("racer", "mass_kg", 0.87), ("vehicles/racer.toml", "mass_kg", 0.87)):
            self.assertEqual(json.loads(self.run_it("config", "--json", "--config", name).stdout)["vehicle"][key], value)
        self.assertEqual(json.loads(self.run_it("config", "--json", "--config", "grandprix").stdout)["camera"]["tilt_deg"], -20)
        self.assertIn("bebop: is a camera and a vehicle; say cameras/bebop.toml or vehicles/bebop.toml", self.refused("config", "--config", "bebop"))
        error = self.refused("config", "--config", "racre")
        self.assertIn("nor a name in configs/, cameras/, vehicles/ (there are: arducopter, basement,", error)
        self.assertIn("did you mean 'racer'?", error)

    def test_camera_vehicle_and_speed_are_short_for_config_and_set(self):
        cut = ("--vision", "ideal", "--set", "sim.timeout_s=1", "--json")
        short = json.loads(self.run_it("fly", "oval", "--camera", "wide-usb", "--vehicle", "racer", "--speed", "1.25", *cut).stdout)
        whole = json.loads(self.run_it("fly", "oval", "--config", "cameras/wide-usb.toml", "--config", "vehicles/racer.toml",
                                       "--set", "control.speed_mps=1.25", *cut).stdout)
        self.assertEqual(short["config"], whole["config"])
        self.assertEqual((short["config"]["camera"]["size_px"], short["config"]["vehicle"]["mass_kg"], short["config"]["control"]["speed_mps"]),
                         ([640, 480], 0.87, 1.25))
        mine = self.file("mine.toml", "[camera]\ntilt_deg = 3\n")
        for command in (("fly", "oval"), ("campaign", "oval", "--runs", "1"), ("render", "oval", "--frames", "1")):
            self.assertIn("--speed", self.refused(*command, "--speed", "100"))
            self.assertIn("no such file, nor a name in cameras/", self.refused(*command, "--camera", "racer"))
            self.assertIn("--vehicle cameras/bebop.toml: has no [vehicle]", self.refused(*command, "--vehicle", "cameras/bebop.toml"))
            self.assertIn("give one of them", self.refused(*command, "--speed", "1", "--set", "control.speed_mps=1.5"))
        tilted = json.loads(self.run_it("fly", "oval", "--config", "cameras/grandprix.toml", "--camera", mine, *cut).stdout)
        self.assertEqual(tilted["config"]["camera"]["tilt_deg"], 3)  # goes over --config

    def test_a_campaign_says_how_to_fly_one_of_them_again(self):
        self.run_it("campaign", "oval", "--runs", "1", "--vision", "ideal", "--vehicle", "racer", "--speed", "1.25", "--set", "sim.timeout_s=1")
        replay = json.loads((self.folder / "out" / "campaign-oval-ideal" / "campaign.json").read_text())["replay"]
        self.assertIn("--config vehicles/racer.toml --set sim.timeout_s=1 --set control.speed_mps=1.25", replay)

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
        self.assertIn('--config: must not be empty', self.refused("config", "--config", ""))

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
        # An optional key is a comment "# key = value  # what"; box_m and pole_m exclude each other.
        lines = self.new("track", "-").splitlines()
        full = [re.sub(r"^# (?=\w+ = |\[gates\.exit\])", "", line) for line in lines]
        for without in ("box_m", "pole_m"):
            track = self.file("full.toml", "\n".join(line for line in full if not line.startswith(without)))
            self.assertEqual(self.run_it("track", track).returncode, 0, self.run_it("track", track).stderr)
        keys = tomllib.loads("\n".join(full))
        self.assertEqual(set(keys), {"name", "laps", "start", "gates", "obstacles", "room", "randomize", "faults"})
        self.assertEqual(set(keys["gates"][0]), {"position_m", "heading_deg", "side_m", "bar_m", "depth_m", "color", "exit",
                                                "position_sigma_m", "heading_sigma_deg", "side_sigma_m"})
        self.assertIn("gate_position_m", keys["randomize"])
        self.assertIn("camera_out_s", keys["faults"])
        for line in lines:
            if re.match(r"(# )?\w+ = ", line):
                self.assertRegex(line, r"  # \w|^(position_m|heading_deg) =")

    def test_a_new_camera_and_configuration_change_nothing(self):
        defaults = self.run_it("config", "--json").stdout
        for kind in ("camera", "vehicle", "config"):
            self.new(kind)
            self.assertEqual(self.run_it("config", "--json", "--config", kind + ".toml").stdout, defaults)
        self.assertEqual(list(tomllib.loads(self.new("camera", "-"))), ["camera"])
        vehicle = tomllib.loads(self.new("vehicle", "-"))
        racer = tomllib.loads((ROOT / "vehicles" / "racer.toml").read_text(encoding="utf-8"))
        for section, keys in racer.items():  # all that describes a drone
            self.assertLessEqual(set(keys), set(vehicle[section]), section)
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
        self.assertIn("{track,camera,vehicle,config}", self.refused("new", "drone"))
        self.assertIn("KIND", self.refused("new"))


if __name__ == "__main__":
    main()
