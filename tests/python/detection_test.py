#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Detection and poses from Python: the same rows as the program's, whatever the array, and nothing crashes."""
import csv
import pathlib
import threading
import unittest

import numpy as np

import gatefly
import support
from support import FLIGHT, GATES, ROOT, Case


def rows_of(name, gates):
    return [{"image": name, "gate": rank, "corners_px": gate.corners_px.tolist(), "fitness": gate.fitness, "method": gate.method,
             "corner_fitness": gate.corner_fitness.tolist()} for rank, gate in enumerate(gates)]


def drawn_gate(height=160, width=315):
    """An orange frame on grey, RGB."""
    picture = np.full((height, width, 3), 110, np.uint8)
    picture[40:121, 100:181] = (255, 110, 0)
    picture[44:117, 104:177] = 110
    return picture


class SameRows(Case):
    def expect_same(self, files, *flags, **named):
        detector = gatefly.Detector(**named)
        found = [row for path in files for row in rows_of(path.name, detector(detector.read_image(path)))]
        self.assertEqual(found, self.program_json("detect", *flags, *files)["detections"])
        self.assertGreater(len(found), 10)
        return found

    def test_as_the_program_on_recorded_pictures(self):
        files = sorted(FLIGHT.glob("*.jpg"))
        turned = {"camera.stored_rotation_deg": 90}
        self.expect_same(files, "--rotate", 90, settings=turned)
        self.expect_same(files, "--rotate", 90, "--all", settings=turned, all=True)

    def test_as_the_program_on_32_real_pictures(self):
        files = sorted((GATES / "basement32_hq").glob("*.jpg"))
        if not files:
            self.skipTest(f"no real pictures at {GATES} (set GATEFLY_DATA)")
        self.assertEqual(len(files), 32)
        for name in ("basement", "cyberzoo"):
            found = self.expect_same(files, "--all", "--config", name, config=name, all=True)
            self.program("detect", *files, "--all", "--config", name, "--csv", "found.csv")
            with (self.folder / "found.csv").open(encoding="utf-8") as table:
                for row, line in zip(found, csv.DictReader(table), strict=True):
                    self.assertEqual((row["image"], row["gate"], row["method"]), (line["image"], int(line["gate"]), line["method"]))
                    self.assertEqual(f"{row['corners_px'][2][1]:.7g}", f"{float(line['br_v']):.7g}")

    def test_an_array_is_a_file_of_the_same_bytes(self):
        picture = drawn_gate()
        path = self.folder / "gate.ppm"
        path.write_bytes(b"P6 315 160 255\n" + picture.tobytes())
        rows = self.program_json("detect", path)["detections"]
        self.assertEqual(rows_of("gate.ppm", gatefly.detect(picture)), rows)
        self.assertEqual(rows_of("gate.ppm", gatefly.detect(gatefly.read_image(path))), rows)
        self.assertEqual(rows_of("gate.ppm", gatefly.detect(picture, config=[ROOT / "configs" / "default.toml"], settings=[])), rows)

    def test_raw_frames_are_those_the_camera_stores(self):
        upright = gatefly.read_image(FLIGHT / "img_00016.jpg", rotation=90)
        luma, blue, red = np.rot90(upright.yuv(), -1).transpose(2, 0, 1)  # as stored
        stored = np.stack([blue[:, ::2], luma[:, ::2], red[:, ::2], luma[:, 1::2]], axis=-1)
        path = self.folder / "frame.uyvy"
        path.write_bytes(stored.tobytes())
        rows = self.program_json("detect", path)["detections"]
        self.assertEqual(len(rows), 1)
        frame = gatefly.Image.from_uyvy(stored.tobytes(), 160, 315, rotation=90)
        self.assertEqual((frame.width, frame.height, frame.format), (315, 160, "uyvy"))
        spread = bytearray(2 * stored.size)
        spread[::2] = stored.tobytes()
        for image in (frame, gatefly.Image.from_uyvy(np.ascontiguousarray(stored), 160, 315, 90), gatefly.read_image(path),
                      gatefly.Image.from_uyvy(memoryview(spread)[::2], 160, 315, 90), gatefly.Image.from_uyvy(spread[::2], 160, 315, 90)):
            self.assertEqual(rows_of("frame.uyvy", gatefly.detect(image)), rows)


class Pictures(Case):
    def test_memory_order_makes_no_difference(self):
        picture = drawn_gate()
        detector = gatefly.Detector()
        whole = rows_of("", detector(picture))
        self.assertEqual(len(whole), 1)
        np.testing.assert_allclose(detector(picture)[0].corners_px, [(99.5, 39.5), (180.5, 39.5), (180.5, 120.5), (99.5, 120.5)], atol=1.0)
        large = np.zeros((320, 630, 3), np.uint8)
        large[::2, ::2] = picture
        four = np.dstack([picture, picture[..., :1]])
        read_only = picture.copy()
        read_only.flags.writeable = False
        for same in (np.asfortranarray(picture), large[::2, ::2], four[..., :3], read_only, picture[::-1, ::-1].copy()[::-1, ::-1],
                     np.ascontiguousarray(picture[..., ::-1])[..., ::-1]):
            self.assertEqual(rows_of("", detector(same)), whole)
        for degrees, turns in ((90, 1), (180, 2), (270, 3)):  # turned clockwise as stored
            stored = np.ascontiguousarray(np.rot90(picture, -turns))
            image = gatefly.Image.from_rgb(stored, rotation=degrees)
            self.assertTrue(np.array_equal(image.rgb(), picture))
            self.assertEqual(rows_of("", detector(image)), whole)

    def test_contiguous_arrays_are_looked_at_in_place_and_live_as_long(self):
        picture = drawn_gate()
        image = gatefly.Image.from_rgb(picture)
        picture[:] = 0
        self.assertFalse(image.rgb().any())
        image = gatefly.Image.from_rgb(drawn_gate())  # nobody else has it
        self.assertEqual(len(gatefly.detect(image)), 1)

    def test_a_picture_is_an_array_and_back(self):
        picture = np.random.default_rng(1).integers(0, 256, (7, 9, 3), np.uint8)
        image = gatefly.Image.from_rgb(picture)
        self.assertTrue(np.array_equal(np.asarray(image), picture))
        self.assertEqual(np.asarray(image, dtype=float).dtype, float)
        grey = np.full((2, 3, 3), 128, np.uint8)
        self.assertTrue(np.array_equal(gatefly.Image.from_yuv(grey).rgb(), grey))
        self.assertIn("9 x 7 px, rgb", repr(image))

    def test_what_is_no_picture_is_one_line(self):
        detector = gatefly.Detector()
        picture = drawn_gate(16, 16)
        for wrong, kind, words in (
                (picture[..., 0], gatefly.Error, "(16, 16) has no colour"), (picture[:0], gatefly.Error, "1..16384"),
                (picture[:, :0], gatefly.Error, "1..16384"), (np.zeros((4, 4, 4), np.uint8), gatefly.Error, "must be (height, width, 3)"),
                (np.zeros((), np.uint8), gatefly.Error, "must be (height"), (np.zeros((2, 2, 2, 3), np.uint8), gatefly.Error, "must be (height"),
                (np.zeros((1, 16385, 3), np.uint8), gatefly.Error, "1..16384"), (picture.astype(np.int8), TypeError, "int8, must be uint8"),
                (picture.astype(">u2"), TypeError, "must be uint8"), (picture / 255, TypeError, "float64, must be uint8 (0..255)"),
                (picture > 3, TypeError, "bool, must be uint8"), (picture.tolist(), TypeError, "not list"), (None, TypeError, "not NoneType"),
                ("photo.jpg", TypeError, "gatefly.read_image reads a file"), (pathlib.Path("a.jpg"), TypeError, "read_image")):
            self.assertIn(words, self.refused(kind, detector, wrong))
            self.refused(kind, gatefly.Image.from_yuv, wrong)
        for small in ((1, 1), (1, 2), (2, 1), (3, 3)):
            self.assertEqual(detector(np.zeros((*small, 3), np.uint8)), [])
        self.assertIn("45, must be 0, 90", self.refused(gatefly.Error, gatefly.Image.from_rgb, picture, 45))
        self.assertIn("must be 8: 2 x 2", self.refused(gatefly.Error, gatefly.Image.from_uyvy, b"123", 2, 2))
        self.assertIn("even", self.refused(gatefly.Error, gatefly.Image.from_uyvy, b"123456", 3, 1))
        self.refused(gatefly.Error, gatefly.Image.from_uyvy, b"", -2, -2)
        self.refused(TypeError, gatefly.Image.from_uyvy, "text", 2, 2)
        self.refused(TypeError, gatefly.Image.from_uyvy, np.zeros(8, float), 2, 2)
        self.assertIn("no such file", self.refused(gatefly.Error, gatefly.read_image, self.folder / "no.jpg").lower())
        self.refused(gatefly.Error, gatefly.read_image, self.folder)
        self.refused(TypeError, gatefly.read_image, 3)

    def test_errors_are_value_errors_with_the_programs_words(self):
        self.assertTrue(issubclass(gatefly.Error, ValueError))
        self.assertIn("no such file, nor a name in configs/", self.refused(gatefly.Error, gatefly.Detector, "nowhere"))
        self.assertIn("not a known key", self.refused(gatefly.Error, gatefly.Detector, settings={"detector.nothing": 1}))
        self.assertIn("finite", self.refused(gatefly.Error, gatefly.Detector, settings={"detector.min_score": float("nan")}))
        for config in (3, [3], {"a": 1}, b"a"):
            self.refused(TypeError, gatefly.Detector, config)
        for settings in (3, "a.b=1", {3: 1}, [3], {"control.speed_mps": None}, {"control.speed_mps": object()}):
            self.refused(TypeError, gatefly.Detector, settings=settings)

    def test_settings_are_those_of_the_program(self):
        chosen = {"control.speed_mps": np.float32(1.25), "color.rgb": np.array([0.0, 0.5, 1.0]), "camera.stored_rotation_deg": np.int64(180),
                  "detector.mode": "fast", "camera.tilt_deg": 3, "vehicle.mass_kg": 1e-1 + 1e-9}
        config = gatefly.Detector(settings=chosen).config
        self.assertEqual([config[key.split(".")[0]][key.split(".")[1]] for key in chosen],
                         [1.25, [0.0, 0.5, 1.0], 180, "fast", 3, 1e-1 + 1e-9])
        self.assertEqual(config, self.program_json("config", *(
            word for key, value in chosen.items() for word in ("--set", f"{key}={value.tolist() if hasattr(value, 'tolist') else value}"))))

    def test_several_threads_share_a_detector(self):
        detector, picture = gatefly.Detector(all=True), drawn_gate()
        want, got = rows_of("", detector(picture)), []
        threads = [threading.Thread(target=lambda: got.extend(rows_of("", detector(picture)) for _ in range(40))) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(got, [want] * 160)


class Poses(Case):
    def setUp(self):
        super().setUp()
        self.camera = gatefly.Camera()

    def corners_from(self, p_GB, roll, pitch, yaw):
        """Camera's view of a gate of 1 m, through the lens."""
        (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
        R_GB = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ \
            np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
        corners_G = 0.5 * np.array([(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)])
        eye = p_GB + R_GB @ self.camera.p_BC
        return np.array([self.camera.project((R_GB @ self.camera.R_BC).T @ (corner - eye)) for corner in corners_G])

    def test_the_place_that_draws_the_corners_is_found_from_them(self):
        for place, angles in (((-3.0, 0.2, -0.1), (0.05, -0.1, 0.02)), ((-2.2, -0.4, 0.2), (-0.1, -0.05, 0.1))):
            corners = self.corners_from(np.array(place), *angles)
            for fix in (self.camera.fix_from_corners(corners, *angles), self.camera.map_fix_from_corners(corners.tolist(), *angles, side=1)):
                np.testing.assert_allclose(fix.p_GB, place, atol=0.02)
                self.assertEqual(fix.covariance.shape, (3, 3))
                self.assertTrue((np.linalg.eigvalsh(fix.covariance) > 0).all())
                self.assertAlmostEqual(fix.yaw_error, 0.0, delta=0.02)
            twice = self.camera.fix_from_corners(corners, *angles, side=2.0).p_GB
            np.testing.assert_allclose(twice, 2 * np.array(place), atol=0.2)

    def test_a_pixel_and_its_ray_are_one(self):
        ray = self.camera.bearing((200, 90))
        np.testing.assert_allclose(self.camera.project(5 * ray), (200, 90), atol=1e-6)
        self.assertIsNone(self.camera.project((0, 0, -1)))
        self.assertEqual((self.camera.width, self.camera.height), (315, 160))
        self.assertEqual(gatefly.Camera(settings={"camera.size_px": [640, 480]}).width, 640)

    def test_impossible_corners_are_none_and_wrong_ones_an_error(self):
        self.assertIsNone(self.camera.map_fix_from_corners([(150, 80)] * 4, 0, 0, 0))
        good = self.corners_from(np.array([-3.0, 0, 0]), 0, 0, 0)
        fix = self.camera.fix_from_corners
        for wrong, kind in ((good[:3], gatefly.Error), (good.ravel(), gatefly.Error), (good * np.nan, gatefly.Error), ("corners", TypeError),
                            (None, TypeError), (good * 1j, TypeError), ([], gatefly.Error), (good * np.inf, gatefly.Error)):
            self.refused(kind, fix, wrong, 0, 0, 0)
        for side in (0, -1, float("nan"), float("inf")):
            self.refused(gatefly.Error, fix, good, 0, 0, 0, side=side)
        self.refused(gatefly.Error, fix, good, float("nan"), 0, 0)
        self.refused(gatefly.Error, self.camera.project, (1, 2))
        self.refused(gatefly.Error, self.camera.bearing, (1, float("nan")))
        self.refused(TypeError, fix, good, "level", 0, 0)


if __name__ == "__main__":
    support.main()
