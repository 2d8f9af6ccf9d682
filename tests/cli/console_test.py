#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Output for a shell, a terminal and a program that reads JSON: completion, manual page, progress, colour, --json.

usage: console_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import fcntl
import json
import math
import os
import pathlib
import pty
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
import unittest

GATEFLY, ROOT = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
FRAMES = ROOT / "tests" / "replay" / "oval_flight"
COMMANDS = ("fly", "replay", "detect", "score", "calibrate", "tune", "campaign", "reproduce", "identify", "map", "run", "bench-drone", "link-sim", "import", "record", "bench", "new", "track",
            "doctor", "config", "completion", "render", "view")


def corners():
    """Nine views of a 5x4 board through a pinhole of 200 px."""
    rows = ["image,X_m,Y_m,u_px,v_px"]
    for k in range(9):
        tilt, turn = 0.3 + 0.03 * k, 0.8 * k
        for i in range(20):
            x, y = 0.03 * (i % 5) - 0.06, 0.03 * (i // 5) - 0.045
            # turned about the axis (cos, sin, 0) by `tilt`
            along, across = x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn)
            px = along * math.cos(turn) - across * math.cos(tilt) * math.sin(turn)
            py = along * math.sin(turn) + across * math.cos(tilt) * math.cos(turn)
            z = 0.3 + across * math.sin(tilt)
            rows.append(f"{k}.png,{x},{y},{160 + 200 * px / z:.4f},{120 + 200 * py / z:.4f}")
    return "\n".join(rows) + "\n"


class Console(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-console-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_it(self, *arguments, **variables):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"), **variables)
        return subprocess.run([GATEFLY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, env=environment,
                              timeout=120, check=False)

    def on_terminal(self, *arguments, columns=80, streams=("stdout", "stderr"), **variables):
        """Output on a terminal of so many columns."""
        terminal, end = pty.openpty()
        fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        into = {stream: end if stream in streams else subprocess.DEVNULL for stream in ("stdout", "stderr")}
        environment = {name: value for name, value in os.environ.items() if name not in {"NO_COLOR", "COLUMNS"}}
        program = subprocess.Popen([GATEFLY, *map(str, arguments)], cwd=self.folder, env={**environment, "TERM": "xterm", **variables}, **into)
        os.close(end)
        said = b""
        try:
            while piece := os.read(terminal, 65536):
                said += piece
        except OSError:  # the other end is closed
            pass
        program.wait()
        os.close(terminal)
        return said.decode()


class Json(Console):
    """--json: one document on standard output, and nothing else there."""

    def document(self, *arguments, codes=(0,)):
        done = self.run_it(*arguments, "--json")
        self.assertIn(done.returncode, codes, done.stderr)
        document = json.loads(done.stdout)  # refuses a second one, too
        self.assertEqual(done.stdout[-1], "\n")
        return document

    def test_every_command_with_results_has_it(self):
        for command in COMMANDS:
            if command not in {"new", "completion", "view"}:
                self.assertIn("--json", self.run_it(command, "--help").stdout, command)

    def test_flights(self):
        self.assertEqual(self.document("fly", "oval", "--vision", "ideal", "--laps", "1", codes=(0, 1))["seed"], 1)
        self.assertEqual(self.document("campaign", "oval", "--runs", "2", "--vision", "ideal")["result"]["runs"], 2)
        self.assertIsInstance(self.document("replay", FRAMES), dict)
        self.assertEqual(self.document("track", "oval")["can_be_flown"], True)

    def test_pictures(self):
        found = self.document("detect", FRAMES, "--config", "cameras/bebop.toml")
        self.assertEqual(found["pictures"], 39)
        self.run_it("detect", FRAMES, "--config", "cameras/bebop.toml", "--csv", "found.csv")
        (self.folder / "labels.csv").write_text("image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\nimg_00016.jpg,1,1,1,50,1,50,50,1,50\n")
        self.assertEqual(self.document("score", "--detections", "found.csv", "--labels", "labels.csv")["labelled_gates"], 1)
        self.document("tune", "--describe", "orange", FRAMES, "--rotate", "90", "--out", "gates.toml", codes=(0, 1))
        (self.folder / "corners.csv").write_text(corners())
        self.assertEqual(len(self.document("calibrate", "corners.csv", "--size", "320x240")["models"]), 4)
        self.document("bench", "--quick", "--stage", "snakes", "--pictures", "gate")

    def test_the_rest(self):
        self.assertIn("checks", self.document("doctor", codes=(0, 1)))
        self.assertIn("camera", self.document("config"))
        self.assertGreater(len(self.document("reproduce", "--list")), 10)
        self.assertEqual(list(self.document("reproduce", "pose-ls-p3p", "--quick")), ["pose-ls-p3p"])
        log = ["t_s,gyro_p_radps,gyro_q_radps,gyro_r_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2"]
        log += [f"{i / 100},0,0,0,0,0,-9.81" for i in range(300)]
        (self.folder / "log_si.csv").write_text("\n".join(log) + "\n")
        done = self.run_it("identify", self.folder, "--json")
        self.assertEqual((done.returncode, done.stdout), (1, ""))  # nothing identified: nothing to say


class Completion(Console):
    def completed(self, *words):
        """Suggestions of bash for the last word."""
        script = self.folder / "completion.bash"
        if not script.exists():
            script.write_text(self.run_it("completion", "bash").stdout)
        line = " ".join(words)
        asked = f"""source {script}
COMP_WORDS=({' '.join(f"'{word}'" for word in words)}); COMP_CWORD={len(words) - 1}; COMP_LINE='{line}'; COMP_POINT={len(line)}
_gatefly; printf '%s\\n' "${{COMPREPLY[@]}}" """
        done = subprocess.run(["bash", "--norc", "-c", asked], capture_output=True, text=True, cwd=self.folder, check=True)
        self.assertEqual(done.stderr, "")
        return set(done.stdout.split())

    def test_bash_completes_commands_flags_and_values(self):
        self.assertLessEqual(set(COMMANDS), self.completed("gatefly", ""))
        self.assertEqual(self.completed("gatefly", "ca"), {"calibrate", "campaign"})
        self.assertEqual(self.completed("gatefly", "fly", "--vis"), {"--vision"})
        self.assertEqual(self.completed("gatefly", "fly", "--vision", ""), {"rendered", "ideal"})
        self.assertEqual(self.completed("gatefly", "fly", "--vision", "=", "r"), {"rendered"})
        self.assertEqual(self.completed("gatefly", "calibrate", "--to", "k"), {"kalibr"})  # the sibling's
        self.assertEqual(self.completed("gatefly", "new", ""), {"track", "camera", "vehicle", "config"})
        self.assertEqual(self.completed("gatefly", "config", "--set", "control.speed"), {"control.speed_mps"})
        self.assertEqual(self.completed("gatefly", "help", "sc"), {"score"})

    def test_bash_completes_names_and_files(self):
        (self.folder / "mine.toml").write_text("")
        (self.folder / "pictures").mkdir()
        self.assertLessEqual({"oval", "showroom", "mine.toml"}, self.completed("gatefly", "fly", ""))
        self.assertLessEqual({"basement", "mine.toml"}, self.completed("gatefly", "detect", "--config", ""))
        self.assertLessEqual({"wide-usb", "mine.toml"}, self.completed("gatefly", "fly", "--camera", ""))
        self.assertNotIn("racer", self.completed("gatefly", "fly", "--camera", ""))
        self.assertLessEqual({"racer", "bebop"}, self.completed("gatefly", "replay", "--vehicle", ""))
        self.assertIn("racer", self.completed("gatefly", "fly", "--config", "r"))
        self.assertEqual(self.completed("gatefly", "config", "control.speed"), {"control.speed_mps"})
        self.assertEqual(self.completed("gatefly", "fly", "--out", "p"), {"pictures"})
        self.assertEqual(self.completed("gatefly", "fly", "--out", "m"), set())  # a folder is asked for
        self.assertIn("roc-fitness", self.completed("gatefly", "reproduce", "roc-"))

    def test_every_flag_of_help_is_completed(self):
        for command in COMMANDS:
            help_text = self.run_it(command, "--help").stdout
            flags = set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", help_text, re.M))
            self.assertGreater(len(flags), 2, command)
            self.assertLessEqual(flags, self.completed("gatefly", command, "--"), command)

    def test_other_shells_take_theirs(self):
        for shell, check in (("zsh", ("zsh", "-n")), ("fish", ("fish", "--no-execute"))):
            script = self.folder / f"completion.{shell}"
            script.write_text(self.run_it("completion", shell).stdout)
            for command in COMMANDS:
                self.assertIn(command, script.read_text())
            if shutil.which(shell):
                subprocess.run([*check, script], check=True)
        self.assertEqual(self.run_it("completion", "tcsh").returncode, 2)


class Manual(Console):
    def test_it_names_every_command_and_flag(self):
        page = self.run_it("help", "--man").stdout
        plain = page.replace("\\-", "-")
        for command in COMMANDS:
            self.assertIn(f".Ss gatefly {command}\n", plain)
            for flag in re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", self.run_it(command, "--help").stdout, re.M):
                self.assertIn("Fl " + flag[1:], plain)
        self.assertRegex(page, r"\.Dd [A-Z][a-z]+ \d+, \d{4}\n")

    @unittest.skipUnless(shutil.which("mandoc"), "no mandoc")
    def test_mandoc_finds_nothing_wrong(self):
        (self.folder / "gatefly.1").write_text(self.run_it("help", "--man").stdout)
        done = subprocess.run(["mandoc", "-T", "lint", self.folder / "gatefly.1"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (0, ""))


class Progress(Console):
    FLIGHT = ("fly", "oval", "--laps", "100", "--vision", "ideal", "--set", "sim.timeout_s=400")

    def updates(self, columns):
        said = self.on_terminal(*self.FLIGHT[:-1], "sim.timeout_s=200", "--out", columns, columns=columns, streams=("stderr",))
        return said.split("\r\x1b[K")[1:-1]

    def test_it_fits_any_width_and_says_what_is_left(self):
        for columns in (20, 80, 200):
            updates = self.updates(columns)
            self.assertGreater(len(updates), 2)
            self.assertLess(max(map(len, updates)), columns)
            self.assertNotIn("\n", "".join(updates))
            self.assertRegex(updates[-1], r"\d+ (s|min) left")
            self.assertEqual("█" in updates[-1] or "░" in updates[-1], columns >= 80, updates[-1])
            if columns > 20:
                self.assertRegex(updates[-1], r"s flown, \d+ of 200 gates")

    def test_no_terminal_gets_lines_without_control_letters(self):
        done = self.run_it(*self.FLIGHT)
        self.assertNotRegex(done.stderr, "[\r\x1b█]")
        self.assertRegex(done.stderr, r"\d+ s flown, \d+ of 200 gates, .* left\n")
        self.assertEqual(self.run_it(*self.FLIGHT, "--quiet", "--out", "quiet").stderr, "")


class Colour(Console):
    def test_only_on_a_terminal_that_wants_it(self):
        self.assertIn("\x1b[32m", self.on_terminal("track", "oval", streams=("stdout",)))
        self.assertNotIn("\x1b", self.on_terminal("track", "oval", streams=("stdout",), NO_COLOR="1"))
        self.assertIn("\x1b", self.on_terminal("track", "oval", streams=("stdout",), NO_COLOR=""))
        for command in (("track", "oval"), ("doctor",), ("fly", "oval", "--vision", "ideal", "--laps", "1")):
            self.assertNotIn("\x1b", self.run_it(*command).stdout)
        self.assertNotIn("\x1b", self.on_terminal("track", "oval", "--json", streams=("stdout",)))
        self.assertNotIn("\x1b", self.on_terminal("track", "oval", streams=("stdout",), TERM="dumb"))


class Grammar(Console):
    def test_one_of_a_thing_has_no_s(self):
        one = self.run_it("detect", FRAMES / "img_00016.jpg", "--rotate", "90", "--csv", "one.csv")
        self.assertNotRegex(one.stdout + one.stderr, r"\b1 pictures\b")
        (self.folder / "labels.csv").write_text("image,has_gate,tl_u,tl_v,tr_u,tr_v,br_u,br_v,bl_u,bl_v\nimg_00016.jpg,1,1,1,50,1,50,50,1,50\n")
        self.assertIn("1 picture, 1 labelled gate,", self.run_it("score", "--detections", "one.csv", "--labels", "labels.csv").stdout)
        self.assertIn("oval, 1 run, ", self.run_it("campaign", "oval", "--runs", "1", "--vision", "ideal").stdout)

    def test_pictures_of_another_size_than_the_cameras_are_named_once(self):
        said = self.run_it("detect", FRAMES, "--config", "cameras/bebop.toml", "--csv", "a.csv", "--set", "camera.size_px=[640,480]").stderr
        self.assertEqual(said.count("its lens does not fit"), 1)
        self.assertIn("img_00000.jpg has 160x315 px, the camera of --set stores 480x640: its lens does not fit (39 of 39 pictures)", said)
        self.assertNotIn("does not fit", self.run_it("detect", FRAMES, "--config", "cameras/bebop.toml", "--csv", "b.csv").stderr)
        self.assertNotIn("does not fit", self.run_it("detect", FRAMES, "--rotate", "90", "--csv", "c.csv").stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
