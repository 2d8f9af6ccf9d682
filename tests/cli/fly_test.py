#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly fly: what it refuses before take-off, what it writes, short flights.

Nothing here renders but the few seconds of Video.

usage: fly_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import re
import shutil
import signal
import subprocess
import time
import unittest

from material import GATE
from program import GATEFLY, ROOT, Cli, main


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

    def test_what_it_cost_is_told_by_processor_by_clock_and_in_memory(self):
        screen = self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1").stdout
        cost = re.search(r"\n  cost +(\S+) s of CPU a second of flight; in all (\S+) s of CPU, (\S+) s by the clock; (\d+) MB of memory at most\n", screen)
        self.assertTrue(cost, screen)
        self.assertGreater(float(cost[1]), 0)  # of two digits, however small
        whole = json.loads((self.folder / "out" / "oval-1" / "summary.json").read_text())["timings"]["whole_flight"]
        self.assertAlmostEqual(float(cost[1]), whole["cpu_s_per_flight_s"], delta=0.06 * whole["cpu_s_per_flight_s"])
        self.assertEqual((cost[2], cost[3]), (f"{whole['cpu_s']:.1f}", f"{whole['wall_s']:.1f}"))
        self.assertAlmostEqual(float(cost[4]), whole["peak_memory_mb"], delta=0.51)
        self.assertTrue(5 < whole["peak_memory_mb"] < 200, whole)

    def test_tracks_are_listed(self):
        lines = self.run_it("fly", "--list").stdout.splitlines()
        self.assertEqual(len(lines), 1 + len(list(ROOT.glob("tracks/*.toml"))))
        self.assertRegex("\n".join(lines), r"\noval +2 +3  14 x 10 x 4 +bebop\n")
        self.assertRegex("\n".join(lines), r"\ngrandprix .* bebop; made for --camera grandprix\n")
        (self.folder / "tracks").mkdir()
        self.file("tracks/mine.toml", "laps = 3\n")
        listed = {track["name"]: track for track in json.loads(self.run_it("fly", "--list", "--json").stdout)}
        self.assertEqual((listed["showroom"]["gates"], listed["showroom"]["laps"]), (5, 3))
        self.assertIn("mine.toml", listed["mine"]["error"])

    def test_a_flight_without_pictures_is_not_replayed(self):
        self.assertEqual(self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1", "--out", "blind").returncode, 0)
        self.assertIn("--vision ideal", self.refused("replay", "blind"))

    def colored(self, first, second):
        oval = (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8")
        parts = oval.split('"orange"')
        return self.file("colored.toml", f'{parts[0]}"{first}"{parts[1]}"{second}"{parts[2]}')

    def test_the_tracks_colour_is_looked_for_and_another_is_not_seen(self):
        # Seed 1's pictures show blue things enough beside the gates to lead the filter astray.
        fly = ("fly", self.colored("blue", "blue"), "--laps", "1", "--seed", "2", "--vision")
        for vision in ("ideal", "rendered"):
            result = self.run_it(*fly, vision)
            self.assertEqual((result.returncode, "not of the colour" in result.stderr), (0, False), vision + result.stderr)
        self.assertIn("to the bit", self.run_it("replay", "out/colored-2").stdout)
        red = self.run_it(*fly, "ideal", "--set", "color.rgb=[0.9, 0.1, 0.1]")
        self.assertEqual(red.returncode, 1)
        self.assertIn("oval: gate 1, 2 not of the colour that the pilot looks for (color.rgb", red.stderr)
        mixed = self.run_it("fly", self.colored("orange", "white"), "--laps", "1", "--vision", "ideal")
        self.assertIn(mixed.returncode, (0, 1), "it may pass the second where it should be")
        self.assertIn("gate 2 not of the colour", mixed.stderr)

    def test_another_detector_flies_another_flight(self):
        shares = []
        for detector in ("ours", "paper"):
            result = self.run_it("fly", "oval", "--vision", "ideal", "--laps", "1", "--json", "--out", detector,
                                 "--set", f"sim.ideal_detector={detector}")
            found = json.loads(result.stdout)["detection"]
            shares.append(found["true_positives"] / found["with_gate_visible"])
        self.assertGreater(shares[0], shares[1])
        self.assertIn("ours", self.refused("fly", "oval", "--set", "sim.ideal_detector=theirs"))


class WhyLost(Cli):
    def test_a_lost_race_says_why_and_a_finished_one_nothing(self):
        fly = ("fly", "oval", "--vision", "ideal", "--laps", "1", "--out")
        result = self.run_it(*fly, "lost", "--set", "faults.camera_out_s=[0, 300]", "--set", "randomize.wind_mps=1.0")
        self.assertEqual(result.returncode, 1, result.stderr)
        summary = json.loads((self.folder / "lost" / "summary.json").read_text())
        why = summary["why_lost"]
        self.assertIn(why["line"], result.stdout)
        self.assertRegex(why["line"], r"^Lost (at|before) gate 1 of 2: .* the estimate \(no fix at all, .*wind \d\.\d m/s from ")
        parts = why["parts"]
        self.assertEqual([part["cause"] for part in parts], ["estimate", "guidance", "map", "detection"])
        for axis in ("lateral_cm", "vertical_cm"):
            self.assertAlmostEqual(sum(part[axis] for part in parts), why["miss"][axis], delta=0.3)
        self.assertEqual(summary["max_speed_mps"], None)
        self.assertIn("– m/s mean, – m/s max", result.stdout)
        self.assertIn("rmse x –, y –, z – m", result.stdout)
        page = (self.folder / "lost" / "report.html").read_text(encoding="utf-8")
        self.assertIn('"why":{"line":"' + why["line"], page)
        self.assertEqual(self.run_it(*fly, "done").returncode, 0)
        self.assertIsNone(json.loads((self.folder / "done" / "summary.json").read_text())["why_lost"])
        self.assertIn('"why":null', (self.folder / "done" / "report.html").read_text(encoding="utf-8"))


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


class Tracks(Cli):
    def test_unknown_track_lists_the_available_ones(self):
        error = self.refused("fly", "showrom")
        self.assertIn("aigp-pq, darkhall, exhibition, figure8, flights, grandprix, lanes, oval", error)
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
            "gate_in_floor": "the lower bar is not below the floor",
            "gate_outside_room": "must be inside the room",
            "gate_too_small": "gate 2 is too small to fly through",
            "no_room_to_turn": "the widest gap, between gate 1 and gate 2, is 0.90 m, 0.20 m too narrow",
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
        equipment = {"aigp-pq": ("--camera", "imx477", "--vehicle", "archer-b2")}  # gates of 2.7 m, wide lens
        for course in sorted([*(ROOT / "tests" / "courses").glob("*.toml"), *(ROOT / "tracks").glob("*.toml")]):
            result = self.run_it("fly", course, *equipment.get(course.stem, ()), "--vision", "ideal", "--laps", "1", "--json", "--out", "flown-" + course.stem)
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
                             ("wall_between_gates",
                              "no way from gate 1 to gate 2: obstacle 1 is in the way; what stands between them leaves no gap")):
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


if __name__ == "__main__":
    main()
