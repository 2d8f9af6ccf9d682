#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly import: logs of other programs, made from the shipped flight, come out as that flight; what cannot be so is refused.

usage: import_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import csv
import json
import math
import shutil
import struct
import unittest

from program import ROOT, Cli, main

FLIGHT = ROOT / "tests" / "replay" / "oval_flight"
GYRO, ACCEL = ("gyro_p_radps", "gyro_q_radps", "gyro_r_radps"), ("acc_x_mps2", "acc_y_mps2", "acc_z_mps2")
SIGNS = (1, -1, -1)  # front, left, up
BOOT_US = 73_000_000  # a log's clock begins somewhere


def rows():
    with open(FLIGHT / "log_si.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def pictures():
    with open(FLIGHT / "images.csv", encoding="utf-8") as file:
        return [(row["image"], int(row["t_ns"])) for row in csv.DictReader(file)]


def negated(text):
    return text[1:] if text.startswith("-") else "-" + text


def blackbox(gyro=1.0, accel=2048.0, signs=SIGNS, time="time (us)"):
    """As blackbox_decode writes: names and numbers behind a comma and a blank, whole numbers."""
    names = ["loopIteration", time, *(f"gyroADC[{i}]" for i in range(3)), *(f"accSmooth[{i}]" for i in range(3)),
             *(f"rcCommand[{i}]" for i in range(4)), "baroAlt (cm)", "surfaceRaw (cm)"]
    baro = sonar = 0
    lines = [", ".join(names)]
    for i, row in enumerate(rows()):
        t = int(row["t_ns"]) // 1000
        rates = [round(s * gyro * math.degrees(float(row[name]))) for s, name in zip(signs, GYRO)]
        forces = [round(s * accel * float(row[name]) / 9.81) for s, name in zip(signs, ACCEL)]
        baro = round(100 * float(row["baro_m"])) if row["baro_m"] else baro
        sonar = round(100 * float(row["sonar_m"])) if row["sonar_m"] else sonar
        throttle = 1000 if t < 1_600_000 else 1400
        lines.append(", ".join(map(str, [i, BOOT_US + t, *rates, *forces, 0, 0, 0, throttle, baro, sonar])))
    return "\n".join(lines) + "\n"


class Ulog:
    """Writes what PX4 writes: formats, topics, data."""
    def __init__(self):
        self.data = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", BOOT_US) + self.message("B", bytes(40))
        self.topics = {}

    @staticmethod
    def message(kind, payload):
        return struct.pack("<Hc", len(payload), kind.encode()) + payload

    def topic(self, name, fields, layout):
        self.data += self.message("F", f"{name}:{fields}".encode())
        self.topics[name] = len(self.topics), layout
        self.data += self.message("A", struct.pack("<BH", 0, len(self.topics) - 1) + name.encode())

    def add(self, name, *values):
        number, layout = self.topics[name]
        self.data += self.message("D", struct.pack("<H" + layout, number, *values))


def ulog():
    log = Ulog()
    log.topic("sensor_combined", "uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;"
              "float[3] accelerometer_m_s2;uint8_t clip;uint8_t[3] _padding0;", "Q3fIi3fB")
    log.topic("distance_sensor", "uint64_t timestamp;uint32_t device_id;float min_distance;float max_distance;float current_distance;", "QIfff")
    log.topic("vehicle_air_data", "uint64_t timestamp;float baro_alt_meter;", "Qf")
    first = None
    for row in rows():
        t = BOOT_US + round(int(row["t_ns"]) / 1000)
        # Lines just before a sample are heard with it.
        if row["sonar_m"]:
            log.add("distance_sensor", t - 1, 7, 0.1, 10.0, float(row["sonar_m"]))
        if row["baro_m"]:
            first = float(row["baro_m"]) if first is None else first
            log.add("vehicle_air_data", t - 1, 488.0 + float(row["baro_m"]))
        log.add("sensor_combined", t, *(float(row[name]) for name in GYRO), 1900, 0, *(float(row[name]) for name in ACCEL), 0)
    return log.data, first


class Import(Cli):
    def estimates(self, folder, *arguments):
        """Time and position, row by row, as the pilot believes them."""
        result = self.run_it("replay", folder, "--csv", "-", *arguments)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        return [[float(row[name]) for name in ("t_s", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "roll_rad", "pitch_rad", "yaw_rad")]
                for row in csv.DictReader(result.stdout.splitlines())]

    def imported(self, log, *arguments):
        result = self.run_it("import", log, "--track", FLIGHT / "track.toml", "--laps", "1", "--set", "vehicle.imu_hz=512",
                             "--out", self.folder / "flight", "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.told = json.loads(result.stdout)
        return self.folder / "flight"

    def stamped(self, name, unit, offset=0):
        """The flight's pictures, their stamps in their names."""
        folder = self.folder / name
        folder.mkdir(parents=True)
        for image, t in pictures():
            shutil.copy(FLIGHT / image, folder / f"cam0_{offset + t // unit}.jpg")
        return folder

    def same(self, folder, position, speed=None, angle=None, of=slice(None)):
        """Beliefs of a replay beside those of the flight's own: by how much they may differ, in metres, m/s, radians."""
        ours, theirs = self.estimates(FLIGHT)[of], self.estimates(folder)[of]
        self.assertEqual(len(ours), len(theirs))
        start = ours[0][0] - theirs[0][0]
        for a, b in zip(ours, theirs):
            self.assertAlmostEqual(a[0] - b[0], start, delta=2e-6)
            for i, most in ((slice(1, 4), position), (slice(4, 7), speed or position), (slice(7, 10), angle or position)):
                for x, y in zip(a[i], b[i]):
                    off = abs(x - y) if i.start < 7 else abs(math.remainder(x - y, math.tau))
                    self.assertLessEqual(off, most, (a, b))

    def ros(self, offset=1_700_000_000_000_000_000):
        """imu.csv as exported from ROS 2, axes front, left, up, beside it range and height in tables of their own."""
        bag = self.folder / "bag"
        bag.mkdir()
        names = ["header.stamp.sec", "header.stamp.nanosec", *(f"angular_velocity.{a}" for a in "xyz"), *(f"linear_acceleration.{a}" for a in "xyz")]
        imu, heights, ranges = [",".join(names)], ["timestamp_ns,height"], ["timestamp_ns,range"]
        for row in rows():
            t = offset + int(row["t_ns"])
            cells = [row[name] if s > 0 else negated(row[name]) for s, name in zip(2 * SIGNS, GYRO + ACCEL)]
            imu.append(",".join([str(t // 10**9), str(t % 10**9), *cells]))
            if row["baro_m"]:
                heights.append(f"{t},{row['baro_m']}")
            if row["sonar_m"]:
                ranges.append(f"{t},{row['sonar_m']}")
        for name, lines in (("imu.csv", imu), ("height.csv", heights), ("range.csv", ranges)):
            (bag / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
        self.stamped("bag/images", 1, offset)
        return bag

    def test_a_ros_folder_is_the_flight_but_for_rounding(self):
        folder = self.imported(self.ros())
        self.same(folder, 1e-9)  # time begins with the log: rounding differs
        self.assertEqual(self.told["detection"]["frames"], len(pictures()))
        self.assertEqual((self.told["pictures_outside"], self.told["rows"]), (0, len(rows())))
        self.assertTrue(any("upwards" in text for text in self.told["checked"]), self.told["checked"])

    def test_what_an_imported_flight_teaches_of_its_camera_is_told_and_what_it_cannot(self):
        self.imported(self.ros())
        result = self.run_it("identify", "flight", "--json")
        self.assertEqual(result.returncode, 1, result.stderr)  # it has no rotor speeds, and no sticks
        flight, = json.loads(result.stdout)["flights"]
        self.assertEqual((flight["hover"], flight["exponent"], flight["drag"]), (None, None, None))
        self.assertGreaterEqual(flight["fixes"], 10)
        tilt = flight["camera_tilt_deg"]
        self.assertLess(abs(tilt["value"] - 20.0), 3 * tilt["sigma"] + 2.0)  # of level race, by a degree or so

    def test_a_ulog_is_the_flight_within_its_floats(self):
        data, first = ulog()
        log = self.folder / "flight.ulg"
        log.write_bytes(data)
        offset = BOOT_US * 1000
        images = self.folder / "cam0"
        images.mkdir()
        for image, t in pictures():  # rounded as the log's stamps are
            shutil.copy(FLIGHT / image, images / f"{round(t / 1000)}.jpg")
        self.imported(log, "--pictures", images, "--clock-offset-s", str(offset / 1e9))
        # An altitude is a height above where it began: the flight's own began there, too.
        shifted = self.folder / "shifted"
        shutil.copytree(FLIGHT, shifted)
        table = rows()
        with open(shifted / "log_si.csv", "w", encoding="utf-8") as file:
            writer = csv.DictWriter(file, table[0].keys())
            writer.writeheader()
            for row in table:
                row["baro_m"] = row["baro_m"] and repr(float(row["baro_m"]) - first)
                writer.writerow(row)
        ours, theirs = self.estimates(shifted), self.estimates(self.folder / "flight")
        self.assertEqual(len(ours), len(theirs))
        for a, b in zip(ours, theirs):
            for x, y in zip(a[1:7], b[1:7]):
                self.assertAlmostEqual(x, y, delta=2e-3)

    def test_a_blackbox_is_the_flight_within_its_whole_degrees(self):
        log = self.file("LOG00001.01.csv", blackbox())
        images = self.stamped("cam0", 1000)
        folder = self.imported(log, "--pictures", images, "--clock-offset-s", str(BOOT_US / 1e6))
        self.same(folder, 0.15, speed=0.3, angle=0.05)
        self.assertEqual(self.told["detection"]["frames"], len(pictures()))

    def test_the_folder_says_when_it_took_off_by_the_throttle(self):
        folder = self.imported(self.file("a.csv", blackbox()))
        with open(folder / "log_si.csv", encoding="utf-8") as file:
            lifted = [(int(row["t_ns"]), row["lifted"]) for row in csv.DictReader(file)]
        off = [t for t, up in lifted if up == "1"]
        self.assertAlmostEqual(off[0] / 1e9, 1.6, delta=0.01)
        self.assertEqual([up for _, up in lifted], sorted(up for _, up in lifted))  # once and for all

    def refused_import(self, log, *arguments):
        error = self.refused("import", log, "--out", "flight", *arguments)
        self.assertTrue(error.startswith("gatefly"), error)
        return error

    def test_wrong_units_and_axes_are_refused_by_what_an_imu_must_read(self):
        def wrong(**kwargs):
            return self.refused_import(self.file("a.csv", blackbox(**kwargs)))
        counts = wrong(accel=512.0)
        self.assertRegex(counts, r"a\.csv: at rest, .* must be 9\.81 \+- 0\.6 in all; its scale is 4\.\d+ times that")
        self.assertIn("betaflight-blackbox.toml says units, axes and signs", counts)
        self.assertIn("up is along +z: sign = -1", wrong(signs=(1, 1, 1)))
        raw = wrong(gyro=16.384)  # counts taken for degrees
        self.assertIn("gyro_* lose gravity", raw)

    def test_axes_that_are_swapped_are_refused(self):
        mapping = (ROOT / "configs" / "import" / "betaflight-blackbox.toml").read_text(encoding="utf-8")
        swapped = mapping.replace("accSmooth[0]", "accSmooth[X]").replace("accSmooth[2]", "accSmooth[0]").replace("accSmooth[X]", "accSmooth[2]")
        error = self.refused_import(self.file("a.csv", blackbox()), "--mapping", self.file("mine.toml", swapped))
        self.assertIn("up is along +x: axes are swapped, or the drone lay on its side", error)

    def test_a_gyro_that_turns_otherwise_than_the_logs_attitude_is_refused(self):
        """A drone that rolls to and fro after a second of rest, with the attitude that goes with it."""
        def log(sign):
            lines = ["t,p,q,r,x,y,z,roll,pitch,yaw"]
            for i in range(1000):
                t = 0.01 * i
                roll = 0.3 * math.sin(3 * (t - 2)) if t > 2 else 0.0
                rate = 0.9 * math.cos(3 * (t - 2)) if t > 2 else 0.0
                lines.append(f"{t:.2f},{sign * rate:.5f},0,0,0,0,-9.81,{roll:.5f},0,0")
            return self.file("a.csv", "\n".join(lines) + "\n")
        mapping = self.file("mine.toml", '[log]\nkind = "csv"\ntime = { column = "t", unit = "s" }\n[columns]\n' + "".join(
            f'{name} = {{ column = "{column}", unit = "{unit}" }}\n' for name, column, unit in (
                ("gyro_p_radps", "p", "rad/s"), ("gyro_q_radps", "q", "rad/s"), ("gyro_r_radps", "r", "rad/s"),
                ("acc_x_mps2", "x", "m/s^2"), ("acc_y_mps2", "y", "m/s^2"), ("acc_z_mps2", "z", "m/s^2"),
                ("ahrs_phi_rad", "roll", "rad"), ("ahrs_theta_rad", "pitch", "rad"), ("ahrs_psi_rad", "yaw", "rad"))))
        self.assertIn("gyro_p_radps is -1.00 times the rate by which the log's attitude turns, must be 1: wrong sign",
                      self.refused_import(log(-1), "--mapping", mapping))
        self.assertIn("gyro_p_radps is 0.02 times", self.refused_import(log(0.0175), "--mapping", mapping))
        self.assertIn("lose gravity", self.refused_import(log(20), "--mapping", mapping))
        well = self.run_it("import", log(1), "--mapping", mapping, "--out", "well")
        self.assertEqual(well.returncode, 0, well.stderr)
        self.assertIn("gyro_p_radps 1.00", well.stdout)
        self.assertIn("gyro_q_radps, gyro_r_radps: it hardly turned about that axis", well.stdout)

    def test_a_log_that_cannot_be_read_names_file_and_line(self):
        good = blackbox().splitlines()
        for line, text, why in ((1, good[0].replace("gyroADC[1]", "gyro"), "has no column 'gyroADC[1]'"),
                                (1, good[0].replace("time (us)", "t"), "has no column 'time (us)' for the time"),
                                (7, good[6].replace(",", ", x", 1), "a.csv:7: time (us) = ' x"),
                                (9, good[8] + ", 1", "a.csv:9: has 15 cells"),
                                (30, good[3], "a.csv:30: time runs backwards")):
            lines = list(good)
            lines[line - 1] = text
            self.assertIn(why, self.refused_import(self.file("a.csv", "\n".join(lines) + "\n")))
        bad = list(good)
        bad[50] = bad[50].replace(bad[50].split(", ")[5], "1e", 1)
        self.assertRegex(self.refused_import(self.file("a.csv", "\n".join(bad) + "\n")), r"a\.csv:51")
        self.assertIn("a.csv: has no rows", self.refused_import(self.file("a.csv", good[0] + "\n")))

    def test_a_ulog_that_is_damaged_names_the_byte(self):
        data, _ = ulog()
        log = self.folder / "a.ulg"
        log.write_bytes(data[:100])
        self.assertIn("a.ulg: has no topic sensor_combined", self.refused_import(log))
        log.write_bytes(b"ULoG" + data[4:])
        self.assertIn("a.ulg: byte 0: is no ULog", self.refused_import(log))
        log.write_bytes(data[:2000] + bytes(50) + data[2050:])
        self.assertRegex(self.refused_import(log), r"a\.ulg: byte \d+: a message of type")
        log.write_bytes(data[:-7])
        result = self.run_it("import", log, "--out", "flight")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("ends within a message (power off?)", result.stderr)

    def test_a_mapping_that_is_wrong_names_its_line(self):
        log = self.file("a.csv", blackbox())
        mapping = (ROOT / "configs" / "import" / "betaflight-blackbox.toml").read_text(encoding="utf-8")
        for old, new, why in (('unit = "deg/s" }', 'unit = "deg" }', 'unit = "deg", must be one of rad/s, deg/s, rpm'),
                              ("[lifted]", "[lift]", "lift is not a known key"), ('kind = "csv"', 'kind = "bag"', 'log.kind = "bag", must be one of csv, ulog, folder'),
                              ("gyro_p_radps", "gyro_radps", "columns.gyro_p_radps is missing"), ("sign = -1", "sign = -2", "must be in -1..1"),
                              ('"us" }', '"min" }', "must be one of s, ms, us, ns")):
            error = self.refused_import(log, "--mapping", self.file("mine.toml", mapping.replace(old, new, 1)))
            self.assertIn(why, error)
            self.assertIn("mine.toml", error)

    def test_pictures_of_another_clock_are_noticed(self):
        log, images = self.file("a.csv", blackbox()), self.stamped("cam0", 1000)
        error = self.refused_import(log, "--pictures", images)
        self.assertIn("no picture is within the log's time", error)
        self.assertIn("--clock-offset-s", error)
        (images / "first.jpg").write_bytes((FLIGHT / "img_00000.jpg").read_bytes())
        self.assertIn("first.jpg: has no stamp in its name", self.refused_import(log, "--pictures", images))

    def test_a_picture_that_cannot_be_read_is_left_out_and_said(self):
        bag = self.ros()
        broken = sorted((bag / "images").iterdir())[3]
        broken.write_bytes(broken.read_bytes()[:20])
        result = self.run_it("import", bag, "--out", "flight")
        self.assertEqual(result.returncode, 2)
        self.assertIn(f"left out: {bag / 'images' / broken.name}", result.stderr)
        told = json.loads((self.folder / "flight" / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual((told["detection"]["frames"], told["pictures_unreadable"]), (len(pictures()) - 1, 1))

    def test_a_later_arrival_is_told_by_the_delay(self):
        self.imported(self.ros(), "--delay-ms", "40")
        with open(self.folder / "flight" / "images.csv", encoding="utf-8") as file:
            late = [int(row["t_ns"]) for row in csv.DictReader(file)]
        first = int(rows()[0]["t_ns"])
        for (_, t), arrived in zip(pictures(), late):
            self.assertTrue(40e6 <= arrived + first - t <= 46e6, (t, arrived))

    def test_what_is_no_import_is_not_replaced(self):
        log = self.file("a.csv", blackbox())
        mine = self.folder / "mine"
        mine.mkdir()
        (mine / "summary.json").write_text("{}", encoding="utf-8")
        error = self.refused("import", log, "--out", "mine")
        self.assertIn("choose another --out", error)
        self.assertEqual(self.run_it("import", log, "--out", "flight").returncode, 0)
        self.assertEqual(self.run_it("import", log, "--out", "flight").returncode, 0)  # its own is

    def test_logs_that_are_not_what_import_takes_say_what_to_do(self):
        for name, why in (("a.bbl", "blackbox_decode"), ("a.bag", "extract it"), ("a.log", "--mapping")):
            self.assertIn(why, self.refused_import(self.file(name, "x")))
        self.assertIn("nothing.csv: is not there", self.refused_import("nothing.csv"))


if __name__ == "__main__":
    main()
