#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The work of gatefly-lab: calibrate, tune, bench, reproduce.

usage: laboratory_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import html.parser
import json
import math
import os
import pathlib
import tempfile
import tomllib

from material import album, bent_album, board_picture, picture, tilted
from program import ROOT, Cli, main


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


class Tune(Cli):
    """Twelve pictures of a gate, here and there, whose colour is told by labels or described."""

    def album(self, color, count=12):
        return album(self.folder, color, count)

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

    def test_a_lens_that_nobody_named_is_found_on_the_gates_and_written(self):
        folder = bent_album(self.folder, b"\x30\xa0\x40", 140)
        tune = ("tune", "--describe", "green", "--rotate", "0", folder, "--out", "mine.toml", "--force")
        result = self.run_it(*tune, "--json")
        lens = json.loads(result.stdout)["lens"]
        self.assertEqual((result.returncode, lens["says"]), (0, "bent"), result.stdout + result.stderr)
        self.assertLess(abs(lens["angle_deg"] - 140), max(6, 3 * lens["angle_sigma_deg"]))
        self.assertRegex((self.folder / "mine.toml").read_text(), r"lens_deg = 1[34]\d\.?\d*  # bends bars")
        self.assertRegex(self.run_it(*tune).stdout, r"lens +bends bars as an equidistant one of 1[34]\d\.\d ± \d")
        result = self.run_it("detect", "--rotate", "0", folder, "--config", self.folder / "mine.toml", "--csv", "found.csv")
        self.assertRegex(result.stderr, r"lens of 1[34]\d[.\d]* degrees across \(config .*mine.toml\), sides taken as the lens bends them")
        self.assertIn("10 of 10 pictures show a gate", result.stdout)

    def test_no_bend_is_claimed_of_a_straight_lens_or_of_one_that_is_named(self):
        folder, _ = self.album(b"\x30\xa0\x40")
        tune = ("tune", "--describe", "green", "--rotate", "0", "--json", folder, "--out", "mine.toml", "--force")
        self.assertIn(json.loads(self.run_it(*tune).stdout)["lens"]["says"], ("straight", "unknown"))
        self.assertNotRegex((self.folder / "mine.toml").read_text(), "lens_deg = [1-9]")
        named = json.loads(self.run_it(*tune, "--config", "wide-usb").stdout)
        self.assertEqual(named["lens"], {"says": "named"})
        self.assertNotIn("lens_deg", (self.folder / "mine.toml").read_text())

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


class Page(html.parser.HTMLParser):
    """Contents of a page: elements that are opened and closed in order, sections, addresses, cells."""
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

    def test_a_first_seed_is_heeded_or_refused(self):
        run = lambda seed: self.run_it("reproduce", "other-camera", "--quick", "--json", "--first-seed", seed, "--force")
        done = run("1201")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["other-camera"]["first_seed"], 1201)
        self.assertIn(",1201,", (self.folder / "out/reproduce/other-camera/result.csv").read_text())
        self.assertIn("--first-seed 1201", (self.folder / "out/reproduce/report.html").read_text())
        error = self.refused("reproduce", "other-camera", "pose-bars", "--first-seed", "1201")
        self.assertIn("--first-seed 1201: pose-bars takes none, only ", error)
        self.assertIn("other-camera", error)
        self.refused("reproduce", "other-camera", "--first-seed", "-1")

    def test_without_data_one_line_and_nothing_written(self):
        for name in self.NAMES:
            error = self.refused("reproduce", name, GATEFLY_DATA=str(self.folder / "nowhere"))
            self.assertIn("tudelft_bebop_gates", error)
            self.assertIn("--data", error)
        self.assertIn("no-such", self.refused("reproduce", "--all", "--data", "no-such"))
        (self.folder / "data" / "tudelft_bebop_gates").mkdir(parents=True)
        for name in self.NAMES:
            self.refused("reproduce", name, "--data", "data")


if __name__ == "__main__":
    main()
