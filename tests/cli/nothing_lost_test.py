#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The user's files are never replaced unasked, and never half: every command that writes.

usage: nothing_lost_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import json
import os
import pathlib
import resource
import shutil
import signal
import stat
import subprocess
import time
import unittest

from material import FOUND, LABELS, album, board_picture, picture
from program import GATEFLY, ROOT, Cli, main


class NothingIsLost(Cli):
    """The user's files are never replaced unasked, and never half."""
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
        """Last line of stderr and exit code of a command that gets a signal when there is `watched`."""
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
        labels.write_text(LABELS, encoding="utf-8")
        found, camera = self.file("found.csv", FOUND), self.file("cam.toml", "[camera]\nstored_rotation_deg = 0\n")
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
        self.file("labels.csv", LABELS)
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
        score = ("score", "--detections", self.file("found.csv", FOUND), "--labels", self.file("labels.csv", LABELS))
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

    def test_a_folder_that_is_to_be_a_file_too_is_found_before_the_work(self):
        flight = self.flight()
        for arguments in (("replay", flight, "--tum", "X", "--out", "X"), ("replay", flight, "--csv", "X/", "--out", self.folder / "X"),
                          ("replay", flight, "--tum", "X", "--out", "X.truth"), ("detect", "a.ppm", "--csv", "X", "--annotate", "X"),
                          ("detect", "a.ppm", "--csv", "X", "--debug", "./X/")):
            began = time.monotonic()
            self.assertRegex(self.refused(*arguments), "goes, too|cannot be written")
            self.assertLess(time.monotonic() - began, 5)

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
        boards, (pictures, labels) = self.boards(), album(self.folder, b"\x30\xa0\x40")
        for number, (tight, arguments) in enumerate((
                (100, ("detect", "--rotate", "0", "a.ppm", "--csv", "found.csv", "--annotate", "drawn")),
                (1000, ("detect", "--rotate", "0", "a.ppm", "--csv", "found.csv", "--annotate", "drawn")),
                (9000, ("replay", "F", "--csv", "estimates.csv")), (9000, self.FLIGHT), (300, ("campaign", "oval", "--runs", "2", *self.FLIGHT[2:])),
                (100, ("calibrate", *boards, "--out", "c.toml", "--report", "c.png")),
                (9000, ("calibrate", *boards, "--out", "c.toml", "--report", "c.png")),
                (9000, ("tune", "--labels", labels, "--rotate", "0", pictures, "--out", "mine.toml")),
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


if __name__ == "__main__":
    main()
