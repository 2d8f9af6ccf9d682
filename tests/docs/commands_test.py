#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every command that README.md and docs/*.md show does what they say: exit 0, page by page, in their order.

usage: commands_test.py GATEFLY REPOSITORY_ROOT [--full] [unittest arguments]

A page's commands run in an empty folder with what a reader would have there (photo.jpg, boards/, ...). Slow ones are run
reduced, as REDUCED says; with --full whole. A command that is neither quick by its kind nor in REDUCED fails here: whoever
documents one decides. What needs the real data is left out, with a line, where it is not.
"""
import importlib.util
import math
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import urllib.request

GATEFLY, ROOT = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
FULL = "--full" in sys.argv
DATA = pathlib.Path(os.environ.get("GATEFLY_DATA") or ROOT.parent / "shared" / "data")

# Quick, whatever they are given.
QUICK = {"new", "config", "doctor", "track", "score", "completion", "detect", "help"}
# As documented -> as run without --full; "" where nothing has to be added.
IDEAL, SHORT = "--vision ideal", "--set sim.timeout_s=2"
REDUCED = {
    "fly": IDEAL,
    "fly --video": f"{IDEAL} --laps 1",
    "fly oval": IDEAL,
    "fly oval --seed 7": SHORT,  # rendered: docs/using.md replays it
    "fly oval --out out/mine": SHORT,
    "fly showroom --laps 1": IDEAL,
    "fly showroom --laps 1 --video": IDEAL,
    "fly oval --vision ideal": "",
    "fly grandprix --camera grandprix": IDEAL,
    "fly grandprix --camera imx477": IDEAL,
    "fly wide --vehicle racer --camera grandprix --speed 5 --set control.max_lateral_mps2=7 --vision ideal": "",
    "fly oval --vehicle racer --vision ideal": "",
    "fly aigp-pq --camera imx477 --vehicle archer-b2 --vision ideal": "--laps 1",
    "fly oval --vehicle racer --speed 1.8 --vision ideal": "",
    "fly --list": "",
    "fly showroom --vision ideal --set sim.autopilot_imu_hz=50": "",
    "fly oval --config betaflight --vision ideal": "--laps 1",
    "fly aigp-pq --camera imx477 --vehicle archer-b2 --config betaflight --vision ideal": "--laps 1",
    "fly mine.toml --vision ideal": "",
    "fly mine.toml": IDEAL,
    'fly oval --vision ideal --set "faults.camera_out_s=[10, 2]"': "",
    "fly oval --speed 1.3 --out out/oval-slower": IDEAL,
    "fly oval --set randomize.level=none --out out/oval-nominal": IDEAL,
    "fly --set control.speed_mps=1.4 --config my.toml": IDEAL,
    "campaign showroom --runs 100 --vision ideal --out out/seeds": ("--runs 100", "--runs 2"),
    "campaign showroom --vision ideal --set faults.missing_gate=1 --first-seed 1101 --runs 40": ("--runs 40", "--runs 4"),
    "campaign oval --runs 40 --vision ideal": ("--runs 40", "--runs 2"),
    "campaign --faults": ("--faults", "--faults --runs 1 --only F1 --laps 1"),
    "campaign showroom --runs 12 --vision ideal --set randomize.jet_mps=0.3 --set randomize.shear_per_s=0.1 --set randomize.wash=1":
        ("--runs 12", "--runs 1"),
    "campaign mine.toml --runs 100 --vision ideal --out out/mine": ("--runs 100", "--runs 2"),
    "fly showroom --frames": "--laps 1 " + SHORT,
    "fly showroom": SHORT,
    "replay out/showroom-1": "",
    "render showroom --frames 200 --out out/pictures": ("--frames 200", "--frames 4"),
    "view out": "",
    "replay out/oval-7": "",
    "replay out/mine": "",
    "replay my_flight --track mine.toml --config camera.toml": "",
    "replay tests/replay/oval_flight --csv estimates.csv": "",
    "replay tests/replay/oval_flight --tum est.txt": "",
    "replay tests/replay/oval_flight --smooth --csv smoothed.csv": "",
    "map tests/replay/oval_flight --out learnt.toml": "",
    "run oval --shadow --laps 1 --camera file:tests/replay/oval_flight --link replay:tests/replay/oval_flight?pace=0": "",
    "replay ../shared/data/tudelft_bebop_flights/flight_11": "",
    "replay tudelft_bebop_flights/flight_11": "",
    "identify my_flights/": "",
    "identify tudelft_bebop_flights/flight_11": "",
    "tune --describe orange my_pictures/ --out gates.toml": "",
    "tune my_pictures/ --labels labels.csv --out gates.toml": "",
    "calibrate boards/ --pattern 9x6 --square-m 0.03 --out camera.toml": "",
    "calibrate pictures/ --pattern 9x6 --square-m 0.03 --out camera.toml": "",
    "calibrate --from camchain.yaml --camera cam0 --out camera.toml": "",
    "calibrate --from camera.toml --to ros --out camera_info.yaml": "",
    "calibrate pictures/ --pattern 9x6 --square-m 0.03 --zero k3 --model brown-conrady --to kalibr --out kalibr.yaml": "",
    "campaign oval --runs 24 --first-seed 1 --slurm 8 --out out/big": ("--runs 24 --first-seed 1 --slurm 8",
                                                                            "--runs 2 --first-seed 1 --slurm 2 --laps 1 " + IDEAL),
    "campaign --resume out/big": "",
    "bench --quick": ("--quick", "--quick --stage snakes --pictures gate"),
}
# Commands of the script ./gatefly alone; CI itself runs the first, tests/install what the second makes.
SCRIPTS_OWN = {"test", "package"}
NEEDS_DATA = re.compile(r"tudelft_bebop|washington|my_flights")
SERVES = {"view"}  # until Ctrl-C
# An ideal flight may crash, a cut one does not finish, its replay may see no gate; all others end with 0.
MAY_END_WITH_1 = {"fly", "replay"}


def fenced(lines):
    """tools/check_docs.py's: (line, is it a block of commands, is it code)."""
    spec = importlib.util.spec_from_file_location("check_docs", ROOT / "tools" / "check_docs.py")
    module = importlib.util.module_from_spec(spec)
    kept, sys.argv = sys.argv, ["check_docs.py", str(ROOT)]
    spec.loader.exec_module(module)
    sys.argv = kept
    return module.fenced(lines)


def commands_of(page):
    """(line number, what comes after "gatefly") of each command on a page."""
    found, continued = [], ""
    for number, (line, is_command, _) in enumerate(fenced(page.read_text(encoding="utf-8").splitlines()), 1):
        if not is_command and not continued:
            continue
        continued = (continued + " " + line.strip()).strip()
        if continued.endswith("\\"):
            continued = continued[:-1].strip()
            continue
        said, continued = re.sub(r"\s+#\s.*$", "", continued), ""
        if match := re.match(r"(?:\./)?gatefly (.*)", said):
            found.append((number, match[1].strip()))
    return found


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def as_run(command):
    """`command` as this test runs it; None when nobody has decided."""
    plain = re.sub(r"\s+>.*$", "", command)
    if plain in REDUCED:
        if FULL:
            return command
        how = REDUCED[plain]
        return command.replace(*how) if isinstance(how, tuple) else f"{command} {how}".strip()
    return command if plain.split()[0] in QUICK else None


# What a reader has ----------------------------------------------------------------------------------------------------


def ppm(width, height, pixel):
    return b"P6\n%d %d\n255\n" % (width, height) + b"".join(pixel(u, v) for v in range(height) for u in range(width))


def album(folder, labels):
    """Twelve pictures of an orange gate, here and there, and their labels."""
    folder.mkdir()
    rows = ["image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v"]
    for i in range(12):
        u0, v0, half = 60 + 4 * i, 50 + 2 * (i % 5), 30 + i % 4

        def pixel(u, v):
            out = max(abs(u - u0), abs(v - v0))
            return b"\xe0\x60\x20" if half - 3 <= out <= half else bytes((100 + (u * 7 + v * 13 + i) % 24,) * 3)
        (folder / f"img_{i}.ppm").write_bytes(ppm(160, 120, pixel))
        left, right, top, bottom = u0 - half, u0 + half, v0 - half, v0 + half
        rows.append(f"img_{i}.ppm,1,{left},{top},{right},{top},{right},{bottom},{left},{bottom}")
    labels.write_text("\n".join(rows) + "\n")


def board(tilt, turn, width=240, height=180, focal=200.0):
    """A board of 9x6 inner corners, 30 mm squares, tilted about the direction `turn`, 0.36 m away."""
    c, s, x, y = math.cos(tilt), math.sin(tilt), math.cos(turn), math.sin(turn)
    rotation = [[c + x * x * (1 - c), x * y * (1 - c), y * s], [x * y * (1 - c), c + y * y * (1 - c), -x * s], [-y * s, x * s, c]]
    normal = [row[2] for row in rotation]
    origin = [row[0] * -0.12 + row[1] * -0.075 + (0, 0, 0.36)[i] for i, row in enumerate(rotation)]
    ahead = sum(n * o for n, o in zip(normal, origin))

    def pixel(u, v):
        ray = ((u - 118) / focal, (v - 91) / focal, 1.0)
        distance = ahead / sum(n * r for n, r in zip(normal, ray))
        p = [distance * r - o for r, o in zip(ray, origin)]
        i, j = (sum(rotation[k][column] * p[k] for k in range(3)) / 0.03 for column in range(2))
        grey = 230.0
        if -1 < i < 9 and -1 < j < 6:
            edge = 0.03 * focal / distance * math.sin(math.pi * i) * math.sin(math.pi * j) / math.pi
            grey = 128 + 100 * max(-1.0, min(1.0, 2 * edge))
        return bytes((round(grey),)) * 3
    return ppm(width, height, pixel)


class Reader:
    """Makes the folders that pages start from; pictures are made once."""

    def __init__(self, top):
        self.top = top
        self.made = top / "made"
        self.made.mkdir()
        album(self.made / "my_pictures", self.made / "labels.csv")
        (self.made / "boards").mkdir()
        for k in range(8):
            (self.made / "boards" / f"{k}.ppm").write_bytes(board(0.3 + 0.03 * k, 0.8 * k))
        shutil.copytree(ROOT / "tests" / "replay" / "oval_flight", self.made / "my_flight")
        self.frame = ROOT / "tests" / "replay" / "oval_flight" / "img_00016.jpg"
        self.has_video = shutil.which("ffmpeg") is not None
        if self.has_video:
            subprocess.run(["ffmpeg", "-loglevel", "error", "-i", self.made / "my_pictures" / "img_%d.ppm", "-pix_fmt", "yuv420p",
                            self.made / "clip.mp4"], check=True)
        (self.made / "camchain.yaml").write_text(
            "cam0:\n  camera_model: pinhole\n  intrinsics: [200.0, 200.0, 118.0, 91.0]\n  distortion_model: equidistant\n"
            "  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  resolution: [240, 180]\n")

    def folder(self, page):
        folder = self.top / page.stem
        shutil.copytree(self.made, folder)
        shutil.copytree(folder / "boards", folder / "pictures")
        shutil.copytree(folder / "my_pictures", folder / "folder")
        (folder / "out").mkdir()
        shutil.copy(self.frame, folder / "photo.jpg")
        (folder / "my.toml").write_text("[camera]\nlatency_ms = 25\n")
        (folder / "gatefly").symlink_to(GATEFLY)
        (folder / "sbatch").symlink_to(ROOT / "tests" / "support" / "sbatch")  # no cluster here
        for name in ("tests", "tracks", "cameras"):
            (folder / name).symlink_to(ROOT / name)
        # what an earlier page has made, where this one does not make it
        written = " ".join(command for _, command in commands_of(page))
        if "new track mine.toml" not in written:
            shutil.copy(ROOT / "tracks" / "oval.toml", folder / "mine.toml")
        if "--out camera.toml" not in written:
            shutil.copy(ROOT / "cameras" / "bebop.toml", folder / "camera.toml")
        if DATA.is_dir():
            (folder / "my_flights").symlink_to(DATA / "tudelft_bebop_flights")
            shared = self.top / "shared"
            shared.mkdir(exist_ok=True)
            if not (shared / "data").exists():
                (shared / "data").symlink_to(DATA)
        return folder


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="gatefly-docs-")
        cls.addClassCleanup(temporary.cleanup)
        cls.reader = Reader(pathlib.Path(temporary.name))

    def check_server(self, words, folder, environment):
        """It says where it is, answers there, and ends with Ctrl-C."""
        with subprocess.Popen([GATEFLY, *words], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True) as server:
            address = re.search(r"http://127\.0\.0\.1:\d+/", server.stdout.readline())
            if address:
                with urllib.request.urlopen(address[0], timeout=20) as answer:
                    self.assertEqual(answer.status, 200)
            server.send_signal(signal.SIGINT)
            server.communicate(timeout=20)
        self.assertTrue(address, "no address on its first line")
        self.assertEqual(server.returncode, 130)

    def run_page(self, page):
        folder = self.reader.folder(page)
        environment = dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}", XDG_CACHE_HOME=str(self.reader.top / "cache"))
        if DATA.is_dir():
            environment["GATEFLY_DATA"] = str(DATA)
        for number, command in commands_of(page):
            name = command.split()[0]
            where = f"{page.relative_to(ROOT)}:{number}: gatefly {command}"
            if name in SCRIPTS_OWN:
                continue
            run = as_run(command)
            with self.subTest(where):
                self.assertIsNotNone(run, "nobody has decided how a test runs this: add it to REDUCED in tests/docs/commands_test.py")
                if NEEDS_DATA.search(command) and not DATA.is_dir():
                    print(f"left out, no real data: {where}")
                    continue
                if not self.reader.has_video and ("clip.mp4" in command or "--video" in command):
                    print(f"left out, no ffmpeg: {where}")
                    continue
                if name in SERVES:
                    self.check_server(shlex.split(run), folder, environment)
                    continue
                done = subprocess.run(["bash", "-c", "gatefly " + run], cwd=folder, env=environment, capture_output=True, text=True,
                                      timeout=3600, check=False)
                allowed = {0, 1} if name in MAY_END_WITH_1 else {0}
                self.assertIn(done.returncode, allowed, f"run as: gatefly {run}\n{done.stdout[-800:]}{done.stderr[-800:]}")
                for flag in ("--out", "--csv", "--tum", "--draw", "--annotate"):
                    words = shlex.split(run.split(" > ")[0])
                    if flag in words:
                        self.assertTrue((folder / words[words.index(flag) + 1]).exists(), f"{flag}: not written")


def add_tests():
    for page in pages():
        if commands_of(page):
            setattr(Commands, f"test_{page.stem.lower()}", lambda self, page=page: self.run_page(page))


def folder_of(command):
    """Folder of a documented flight."""
    words = shlex.split(command)[1:]
    if "--out" in words:
        return words[words.index("--out") + 1]
    track = words[0] if words and not words[0].startswith("-") else "showroom"
    return f"out/{pathlib.Path(track).stem}-{words[words.index('--seed') + 1] if '--seed' in words else 1}"


class Table(unittest.TestCase):
    def test_the_first_race_replaces_none_of_its_flights(self):
        flights = [command for _, command in commands_of(ROOT / "docs" / "first_race.md")
                   if command.startswith("fly ") and "--list" not in command]
        self.assertGreater(len(flights), 3)
        self.assertEqual(len({folder_of(command) for command in flights}), len(flights), flights)

    def test_every_reduced_command_is_still_documented(self):
        said = {re.sub(r"\s+>.*$", "", command) for page in pages() for _, command in commands_of(page)}
        self.assertEqual([command for command in REDUCED if command not in said], [])

    def test_a_command_that_nobody_decided_about_is_noticed(self):
        self.assertIsNone(as_run("campaign oval --runs 1000000"))
        self.assertEqual(as_run("config --show"), "config --show")


if __name__ == "__main__":
    add_tests()
    result = unittest.main(argv=[sys.argv[0], *(each for each in sys.argv[3:] if each != "--full")], exit=False).result
    times = os.times()
    print(f"{times.children_user + times.children_system + times.user + times.system:.0f} s of CPU")
    sys.exit(not result.wasSuccessful())
