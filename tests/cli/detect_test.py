#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly detect and score: drawn pictures, broken ones, real ones.

usage: detect_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import csv
import json
import math
import os
import pathlib
import shutil
import subprocess
import unittest

from material import FOUND, HEADER, LABELS, picture
from program import ROOT, Cli, main


class Pictures(Cli):
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
        self.assertEqual(header, HEADER)
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
        for words in (f"lens pinhole, 315x160 px (config {camera})", "rgb 0, 0, 1 (--set)", "min_score 2.6 (config cyberzoo)", "taken as upright"):
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
            self.assertEqual((result.returncode, result.stdout), (1, HEADER + "\n"))
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


class Scores(Cli):
    def score(self, found, labels, *more):
        return ("score", "--detections", self.file("found.csv", found), "--labels", self.file("labels.csv", labels), *more)

    def test_json_and_screen_say_the_same(self):
        arguments = self.score(FOUND, LABELS)
        answer = json.loads(self.run_it(*arguments, "--json").stdout)
        self.assertEqual((answer["pictures"], answer["labelled_gates"], answer["hits"], answer["false_positives"]), (2, 1, 1, 1))
        self.assertEqual((answer["true_positive_rate"], answer["false_positives_per_image"]), (1.0, 0.5))
        self.assertEqual(answer["corner_error_px"]["best_order"], {"median": 1.0, "p90": 1.0})
        screen = self.run_it(*arguments)
        self.assertEqual((screen.returncode, screen.stderr), (0, ""))
        for text in ("1 of 1 (rate 1.000)", "1 (0.500 per image)", "median 1.0 px", "30-45 px 1/1"):
            self.assertIn(text, screen.stdout)

    def test_what_a_spreadsheet_makes_of_the_tables_is_read(self):
        wanted = self.run_it(*self.score(FOUND, LABELS)).stdout
        for form in (lambda text: "\ufeff" + text, lambda text: text.replace(",", ";").replace("0.9", "0,9"),
                     lambda text: "\ufeff" + text.replace(",", "\t").replace("\n", "\r\n")):
            self.assertEqual(self.run_it(*self.score(form(FOUND), form(LABELS))).stdout, wanted)

    def test_a_missing_column_is_named_with_those_there_are(self):
        error = self.refused(*self.score(FOUND, LABELS.replace("tl_v", "tlv")))
        self.assertIn("labels.csv:1: has no column 'tl_v' (there are: image, has_gate, tl_u, tlv, tr_u,", error)

    def test_ignore_forgives(self):
        ignore = self.file("ignore.csv", "image,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\nb.jpg,40,40,0,0,40,0,0,40\n")
        answer = json.loads(self.run_it(*self.score(FOUND, LABELS, "--ignore", ignore, "--json")).stdout)
        self.assertEqual((answer["false_positives"], answer["neither"]), (0, 1))

    def test_rates_of_nothing_are_null(self):
        answer = json.loads(self.run_it(*self.score(HEADER + "\n", LABELS.splitlines()[0] + "\n", "--json")).stdout)
        self.assertIsNone(answer["true_positive_rate"])
        self.assertIsNone(answer["false_positives_per_image"])

    def test_a_picture_without_label_is_a_warning(self):
        result = self.run_it(*self.score(FOUND + "z.jpg,0,0,0,40,0,40,40,0,40,0.8,snake\n", LABELS))
        self.assertEqual(result.returncode, 0)
        self.assertIn("1 detections name pictures that are not in the labels: z.jpg", result.stderr)

    def test_broken_files_are_refused_with_line_and_column(self):
        self.assertIn("found.csv:2:3: tl_u = 'left'", self.refused(*self.score(FOUND.replace("0,1,0", "0,left,0", 1), LABELS)))
        self.assertIn("labels.csv:2:2: has_gate = '7'", self.refused(*self.score(FOUND, LABELS.replace("1,0", "7,0", 1))))
        self.assertIn("nowhere.csv", self.refused("score", "--detections", "nowhere.csv", "--labels", "labels.csv"))
        self.assertIn("--rule", self.refused(*self.score(FOUND, LABELS, "--rule", "iou60")))
        self.assertIn("--labels", self.refused("score", "--detections", "found.csv"))


class RealPictures(Cli):
    GATES = pathlib.Path(os.environ.get("GATEFLY_DATA", "../shared/data")) / "tudelft_bebop_gates"

    def setUp(self):
        super().setUp()
        self.gates = (ROOT / self.GATES).resolve()
        if not self.gates.is_dir():
            self.skipTest(f"no real pictures at {self.gates} (set GATEFLY_DATA)")

    def test_pictures_and_labels_count_as_the_data_says(self):
        nothing = self.file("none.csv", HEADER + "\n")
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
            found, cut = {}, set()
            for row in answer["detections"]:
                name = row["image"].split(".")[0]
                # one that the border cuts may be a gate in one and a part in the other
                if row["method"] == "bars" or min(row["corner_fitness"]) == 0:
                    cut.add(name)
                else:
                    found.setdefault(name, []).append(row["corners_px"])
            return found, cut

        for options in ((), ("--all",)):
            (raw, cut), (jpeg, cut_too) = corners_in_view("uyvy", *options), corners_in_view("jpg", *options)
            self.assertEqual(sorted(set(raw) - cut_too), sorted(set(jpeg) - cut))
            self.assertGreaterEqual(len(raw), 45)
            off = []
            for name in set(raw) - cut_too:
                gates = raw[name]
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


if __name__ == "__main__":
    main()
