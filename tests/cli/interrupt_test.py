#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C, SIGTERM and SIGHUP at any moment: answered at once, with the right exit code, and nothing is left.

Most moments are within the bake of a large hall's light, which takes minutes. A busy machine gives us little of its time: what
is measured is the processor time that the program takes after the signal.

usage: interrupt_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from material import GATE
from program import GATEFLY, Cli, main

SIZE = "size_m = [120.0, 120.0, 6.0]"
HALL = f"{GATE}[room]\n{SIZE}\n"
EXIT_CODE = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}
MOST_CPU = 2.0  # s after the signal, all threads together; measured: less than 0.3
BEFORE_MAIN = 0.1  # s while the program is still being loaded: then it just dies of the signal


class Interrupt(Cli):
    def setUp(self):
        super().setUp()
        self.file("hall.toml", HALL)

    def flight_in_the_hall(self):
        """A recorded second of flight, as if it had been in the hall: its pictures are not kept, but rendered again."""
        small = self.file("small.toml", HALL.replace(SIZE, "size_m = [9.0, 9.0, 3.0]"))
        self.assertEqual(self.run_it("fly", small, "--out", "F", "-q", "--set", "sim.timeout_s=1").returncode, 1)
        track = self.folder / "F" / "track.toml"
        track.write_text(track.read_text(encoding="utf-8").replace("size_m = [9.0, 9.0, 3.0]", SIZE), encoding="utf-8")
        shutil.rmtree(self.cache)

    def cpu_seconds(self, process):
        fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def left(self, kept):
        paths = [path.relative_to(self.folder) for path in self.folder.rglob("*")]
        return sorted(str(path) for path in paths if path.parts[0] not in (self.cache.name, *kept))

    def interrupted(self, after, sent, *arguments, kept=()):
        before, said = self.left(kept), f"{arguments[0]}, {sent.name} after {after} s"
        with subprocess.Popen([GATEFLY, *arguments], cwd=self.folder, env=dict(os.environ, XDG_CACHE_HOME=str(self.cache)), stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True) as process:
            time.sleep(after)
            self.assertIsNone(process.poll(), said + ": it has ended by itself")
            spent = self.cpu_seconds(process)
            process.send_signal(sent)
            stderr = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertLess(usage.ru_utime + usage.ru_stime - spent, MOST_CPU, said)
        self.assertIn(process.returncode, (EXIT_CODE[sent],) + ((-sent,) if after < BEFORE_MAIN else ()), said + stderr)
        self.assertEqual(self.left(kept), before, said)
        self.assertEqual([path for path in self.cache.rglob("*") if path.is_file()], [], said)
        if process.returncode > 0:
            self.assertIn("interrupted", stderr.splitlines()[-1], said)

    def test_a_flight(self):
        moments = ((0.0, signal.SIGINT), (0.05, signal.SIGTERM), (0.1, signal.SIGINT), (0.2, signal.SIGHUP), (0.4, signal.SIGINT), (1.0, signal.SIGTERM))
        for after, sent in moments:
            self.interrupted(after, sent, "fly", "hall.toml", "--out", "X/Y", "-q")

    def test_a_room_too_large_is_refused_before_anything_is_written(self):
        self.file("plain.toml", HALL.replace("120.0, 120.0", "1000.0, 1000.0"))
        for command in (("fly", "plain.toml"), ("render", "plain.toml", "--frames", "1"), ("campaign", "plain.toml", "--runs", "1")):
            words = self.refused(*command)
            for word in ("plain.toml: room.size_m = [1000, 1000, 6]", "100 x 100 m", "--vision ideal"):
                self.assertIn(word, words)

    def test_pictures_are_all_there_or_none(self):
        """A signal while a seed's last pictures are rendered must not end in a folder that lacks the other seeds."""
        render = ("render", "oval", "--frames", "120", "--jobs", "1", "-q", "--out")
        self.assertEqual(self.run_it(*render, "whole").returncode, 0)
        wanted = {path.name for path in (self.folder / "whole").iterdir()}
        for tenth in range(1, 20, 2):
            with subprocess.Popen([GATEFLY, *render, "X"], cwd=self.folder, env=dict(os.environ, XDG_CACHE_HOME=str(self.cache)),
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
                time.sleep(0.1 * tenth)
                process.send_signal(signal.SIGTERM)
                said = process.communicate(timeout=60)[1]
            if process.returncode == 0:
                self.assertEqual({path.name for path in (self.folder / "X").iterdir()}, wanted)
                shutil.rmtree(self.folder / "X")
            else:
                self.assertEqual(process.returncode, 143, said)
                self.assertEqual([path.name for path in self.folder.glob("X*")], [])

    def test_a_merge_and_a_comparison_are_all_there_or_not_at_all(self):
        for name, arguments in (("half1", ("--shard", "1/2")), ("half2", ("--shard", "2/2")), ("other", ("--speed", "1.5"))):
            self.assertEqual(self.run_it("campaign", "oval", "--runs", "4", "--vision", "ideal", "--laps", "1", "-q", "--out", name, *arguments).returncode, 0)
        for arguments in (("--merge", "half1", "half2"), ("--compare", "half1", "other")):
            command = ("campaign", *arguments, "--out", "X")
            shutil.rmtree(self.folder / "X", ignore_errors=True)
            began = time.monotonic()
            self.assertEqual(self.run_it(*command).returncode, 0)
            seconds = time.monotonic() - began
            wanted = {path.name for path in (self.folder / "X").iterdir()}
            for part in range(25):
                shutil.rmtree(self.folder / "X", ignore_errors=True)
                with subprocess.Popen([GATEFLY, *command], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
                    time.sleep(seconds * part / 25)
                    process.send_signal(signal.SIGTERM)
                    said = process.communicate(timeout=60)[1]
                there = {path.name for path in self.folder.glob("X*/*")} | {path.name for path in self.folder.glob(".gatefly*")}
                self.assertIn(process.returncode, (0, 143, -signal.SIGTERM), said)
                self.assertEqual(there, wanted if process.returncode == 0 else set(), said)
                self.assertEqual((self.folder / "X").exists(), process.returncode == 0)

    def test_pictures_a_replay_and_a_campaign(self):
        self.flight_in_the_hall()
        for after, sent in ((0.15, signal.SIGTERM), (0.8, signal.SIGINT)):
            self.interrupted(after, sent, "render", "hall.toml", "--frames", "4", "--out", "X/Y", "-q")
            self.interrupted(after, sent, "replay", "F", "--out", "X/Y", "-q")
            self.interrupted(after, sent, "campaign", "hall.toml", "--runs", "2", "--out", "C", "-q", kept=("C",))  # of which the rest can be flown


if __name__ == "__main__":
    main()
