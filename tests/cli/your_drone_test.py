#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docs/your_drone.md, followed as somebody new would: its commands in their order, each prints what the page says, but for the numbers. The drone is a fake that behaves
like Betaflight 4.4.3; with GATEFLY_BETAFLIGHT_4_5, the path of its simulator target, it is Betaflight itself. In real time.

usage: your_drone_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
    GATEFLY_PRINTED=FILE  gets what was printed, for the page
"""
import os
import re
import signal
import subprocess
import time

from drone import FAKE
from program import GATEFLY, ROOT, Cli, main
from simulated import ended

BETAFLIGHT = os.environ.get("GATEFLY_BETAFLIGHT_4_5", "")
PAGE = ROOT / "docs" / "your_drone.md"


def steps():
    """(command, lines that it is said to print) of the page."""
    found, inside = [], False
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if line.startswith("```"):
            inside = line == "```text"
        elif inside and line.startswith("$ "):
            found.append((line[2:], []))
        elif inside and line.strip() and line.strip() != "…":
            found[-1][1].append(line)
    return found


def without_numbers(line):
    return re.sub(r"[-+]?\d+(\.\d+)?", "#", re.sub(r"board \w{4}", "board", line)).strip()


class Followed(Cli):
    def setUp(self):
        super().setUp()
        self.background, self.printed = {}, []
        self.addCleanup(lambda: [ended(process) for process in self.background.values()])
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        (bin_folder / "gatefly").symlink_to(GATEFLY)
        (self.folder / "tests").symlink_to(ROOT / "tests")
        self.environment = dict(os.environ, PATH=f"{bin_folder}:{os.environ['PATH']}", XDG_CACHE_HOME=str(self.cache), GATEFLY_SOURCE_DIR=str(ROOT))

    def stop(self, name):
        process = self.background.pop(name, None)
        if process:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                pass  # a controller need not listen to it
            ended(process)

    def start(self, name, words, ready):
        """In a window of its own; until it has said that it is ready."""
        self.stop(name)
        path = self.folder / f"{name}.txt"
        with path.open("w", encoding="utf-8") as says:
            self.background[name] = subprocess.Popen(words, cwd=self.folder, env=self.environment, stdin=subprocess.PIPE, stdout=says, stderr=says, text=True)
        end = time.monotonic() + 60
        while ready not in path.read_text(encoding="utf-8"):
            self.assertIsNone(self.background[name].poll(), path.read_text(encoding="utf-8"))
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)
        return path.read_text(encoding="utf-8")

    def controller(self):
        time.sleep(0.5)
        words = [BETAFLIGHT] if BETAFLIGHT else [FAKE + "_sitl", "--msp", "5761"]
        said = self.start("controller", words, "" if BETAFLIGHT else "port")
        time.sleep(1.5)
        return "" if BETAFLIGHT else said

    def out_of(self, command):
        if not BETAFLIGHT:  # whose motors are others
            command = command.replace("--hover-stick-us 1257 --exponent 1.66", "--hover-stick-us 1273 --exponent 1.73")
        if command == "betaflight_SITL.elf":
            self.stop("world")
            self.controller()
            return ""
        if command.startswith("tests/live/betaflight_cli.sh") and not BETAFLIGHT:
            return "saved"  # the fake is as it is
        if command.startswith("gatefly link-sim"):
            return self.start("world", ["bash", "-c", "exec " + command], "ready")
        if command.startswith("gatefly view"):
            with subprocess.Popen(["bash", "-c", "exec " + command], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, text=True) as server:
                line = server.stdout.readline()
                server.send_signal(signal.SIGINT)
                server.communicate(timeout=20)
            return line
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=200, check=False)
        return done.stdout

    def test_the_page(self):
        for command, expected in steps():
            out = self.out_of(command)
            for _ in range(3):  # as the page says of a busy machine
                if BETAFLIGHT and "calibrate it" in out:
                    self.out_of("echo calibrate >> asks.txt; sleep 3")
                    out = self.out_of(command)
            self.printed.append(f"$ {command}\n{out}")
            if os.environ.get("GATEFLY_PRINTED"):
                with open(os.environ["GATEFLY_PRINTED"], "w", encoding="utf-8") as file:
                    file.write("\n".join(self.printed))
            lines = iter(without_numbers(line) for line in out.splitlines())
            for line in expected:
                self.assertIn(without_numbers(line), lines, f"'{line}' is not printed, or not in this place, by:\n{command}\n{out}")
        if "world" in self.background:
            self.background["world"].wait(timeout=100)


if __name__ == "__main__":
    main()
