#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rows F21-F24 and F27 of the fault table: link, process, computer, disk and strangers in trouble, while `gatefly run` flies a drone that behaves like one
(tests/support/fake_betaflight.hpp, fake_arducopter.hpp) and a camera that shows grey. In real time; leave both cores to it. Prints a table.

usage: link_faults.py GATEFLY REPOSITORY_ROOT [--rows F21,F22,F23,F24,F27] [--runs 3] [--seconds 25] [--minutes 1]
    --seconds   of a measurement of F23
    --minutes   of hostile bytes in F27
GATEFLY_FAKE_BETAFLIGHT and GATEFLY_FAKE_ARDUCOPTER name the fakes of the build. Exit code 0: every rule is kept.
"""
import argparse
import contextlib
import json
import os
import pathlib
import random
import resource
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

from drone import DRONE, FAR_GATE, GREY_STREAM, PERIOD, Fake, end_of, goes_first, signed
from program import GATEFLY, ROOT

sys.path.insert(0, str(ROOT / "tools"))
from ts002_conformance import MESSAGES, frame_of  # noqa: E402

FAKE = {"msp": os.environ["GATEFLY_FAKE_BETAFLIGHT"], "mavlink": os.environ["GATEFLY_FAKE_ARDUCOPTER"]}
FILE = {"msp": DRONE, "mavlink": ROOT / "tests" / "live" / "fake_arducopter.toml"}
CONFIG = {"msp": "betaflight", "mavlink": "arducopter"}
BROUGHT_DOWN = "ending: braking, then down"
FAKE_TICK = 0.004  # s, by which the fakes' own clock is coarse


class SerialLine(threading.Thread):
    """A line between the program and a controller on TCP: carries, loses, adds bytes of its own."""

    def __init__(self, controller):
        super().__init__(daemon=True)
        self.controller, self.out, self.noise, self.over = controller, False, None, False
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.start()

    def run(self):
        goes_first()
        program, _ = self.listener.accept()
        controller = socket.create_connection(("127.0.0.1", self.controller))
        for each in (program, controller):
            each.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        with contextlib.suppress(OSError):
            while not self.over:
                ready, _, _ = select.select([program, controller], [], [], 0.002)
                for each in ready:
                    data = each.recv(4096)
                    if not data:
                        return
                    if not self.out:
                        (controller if each is program else program).sendall(data)
                if self.noise:
                    program.sendall(self.noise())
        for each in (program, controller):
            each.close()


class Network(threading.Thread):
    """The same of datagrams: loses, doubles and swaps a part of them, adds some with the controller's own address."""

    def __init__(self):
        super().__init__(daemon=True)
        self.sides = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]  # the controller's, the program's
        for each in self.sides:
            each.bind(("127.0.0.1", 0))
        self.calls, self.port = (each.getsockname()[1] for each in self.sides)
        self.peers, self.out, self.over, self.noise, self.troubles = [None, None], False, False, None, (0.0, 0.0, 0.0)
        self.random, self.held, self.recorded, self.added = random.Random(1), [None, None], [], 0
        self.start()

    def pass_on(self, side, data):
        loss, double, swap = self.troubles
        if self.peers[side] is None or self.random.random() < loss:
            return
        if self.held[side] is None and self.random.random() < swap:
            self.held[side] = data
            return
        sent = [data] * (2 if self.random.random() < double else 1) + ([self.held[side]] if self.held[side] else [])
        self.held[side] = None
        for each in sent:
            self.sides[side].sendto(each, self.peers[side])

    def run(self):
        goes_first()
        with contextlib.suppress(OSError):
            while not self.over:
                ready, _, _ = select.select(self.sides, [], [], 0.001)
                for each in ready:
                    side = self.sides.index(each)
                    data, self.peers[side] = each.recvfrom(2048)
                    if side == 0 and len(self.recorded) < 5000:
                        self.recorded.append(data)
                    if not self.out:
                        self.pass_on(1 - side, data)
                if self.noise and self.peers[1]:
                    for data in self.noise():
                        self.sides[1].sendto(data, self.peers[1])
                        self.added += 1


class Flight:
    """A fake drone, the program that flies it, and what is between them."""

    def __init__(self, kind="msp", between=False, words=(), wrap=(), preexec_fn=None):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gatefly-faults-"))
        self.between = None
        if kind == "mavlink":
            self.between = Network()
            self.fake = Fake(self.folder, "--calls", str(self.between.calls), program=FAKE[kind])
            link = f"mavlink:udp:127.0.0.1:{self.between.port}"
        else:
            self.fake = Fake(self.folder, program=FAKE[kind])
            if between:
                self.between = SerialLine(self.fake.port)
            link = f"msp:tcp:127.0.0.1:{self.between.port if between else self.fake.port}"
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "gst-launch-1.0").write_text(GREY_STREAM, encoding="utf-8")
        (programs / "gst-launch-1.0").chmod(0o700)
        self.told, self.said = self.folder / "told.json", self.folder / "said.txt"
        command = [*wrap, GATEFLY, "run", FAR_GATE, "--config", CONFIG[kind], "--camera", "gst:videotestsrc", "--link", link, "--drone", self.signed(kind), "--json", *words]
        with self.told.open("w", encoding="utf-8") as told, self.said.open("w", encoding="utf-8") as said:
            self.process = subprocess.Popen([str(word) for word in command], cwd=self.folder, stdout=told, stderr=said, preexec_fn=preexec_fn,
                                            env=dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"), PATH=f"{programs}:{os.environ['PATH']}"))

    def file(self, name, content):
        path = self.folder / name
        path.write_text(content, encoding="utf-8")
        return path

    def signed(self, kind):
        return signed(self, FILE[kind].read_text(encoding="utf-8"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        end_of(self.process)
        for child in self.keepers:
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
        if self.between:
            self.between.over = True
        self.fake.end()
        shutil.rmtree(self.folder, ignore_errors=True)

    keepers = ()

    def heard(self):
        return self.said.read_text(encoding="utf-8")

    def until(self, what, seconds=15.0):
        end = time.monotonic() + seconds
        while not what():
            if time.monotonic() > end or (self.process.poll() is not None and not what()):
                raise RuntimeError(f"it takes too long; the program said: {self.heard()}")
            time.sleep(0.01)

    def streams(self):
        self.until(lambda: len(self.fake.rows("frame")) > 65)
        self.keepers = [int(each) for each in subprocess.run(["pgrep", "-P", str(self.process.pid)], capture_output=True, text=True, check=False).stdout.split()]
        return self

    def flies(self, seconds=2.6):
        self.streams()
        self.fake("arm")
        time.sleep(0.3)
        self.fake("override on")
        time.sleep(seconds)
        if self.height(self.fake.rows("state")[-1]) < 0.5:
            raise RuntimeError(f"it has not taken off: {self.heard()}")
        return self

    @staticmethod
    def height(row):
        return -float(row["z_m"])

    def since_mark(self):
        rows = self.fake.rows()
        first = max(i for i, row in enumerate(rows) if row["what"] == "mark")
        return rows[first:]

    def gap(self, begin=0.0, end=1e9):
        """The longest time between two set points at the controller [s]."""
        times = [float(row["t_s"]) for row in self.fake.rows("frame")]
        times = [each for each in times if begin <= each <= end]
        return max((later - earlier for earlier, later in zip(times, times[1:])), default=float("nan"))

    def now(self):
        return float(self.fake.rows("state")[-1]["t_s"])

    def came_down(self, seconds=6.0):
        """Whether it touches the floor after the mark; seconds, metres, and how far it rose."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not any(row["what"] == "touch" for row in self.since_mark()):
            time.sleep(0.05)
        rows = self.since_mark()
        touch = next((i for i, row in enumerate(rows) if row["what"] == "touch"), None)
        if touch is None:
            return None
        begin, way = rows[0], rows[:touch + 1]
        return {"s": float(way[-1]["t_s"]) - float(begin["t_s"]), "m": sum((float(way[-1][axis]) - float(begin[axis])) ** 2 for axis in ("x_m", "y_m")) ** 0.5,
                "rise": max(map(self.height, way)) - self.height(begin), "v": max(float(row["vz_mps"]) for row in way)}

    def over(self):
        """Lets it end; its summary."""
        if self.process.poll() is None:
            self.process.terminate()
        time.sleep(0.1)
        self.fake("disarm")
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(timeout=15)
        text = self.told.read_text(encoding="utf-8")
        return json.loads(text) if text else {}

    def processor_time(self):
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Table:
    def __init__(self):
        self.bad = 0
        print("| # | injected | what happened | rule | kept |\n| --- | --- | --- | --- | --- |", flush=True)

    def row(self, number, injected, happened, rule, kept):
        self.bad += kept is False
        print(f"| {number} | {injected} | {happened} | {rule} | {'yes' if kept else 'measured' if kept is None else 'NO'} |", flush=True)


def down_text(falls):
    return (f"on the floor after {max(f['s'] for f in falls):.1f} s, {max(f['m'] for f in falls):.1f} m further, at {max(f['v'] for f in falls):.1f} m/s"
            if falls and all(falls) else f"on the floor in {sum(map(bool, falls))} of {len(falls)}")


def well_down(falls):
    return all(fall and fall["s"] < 3.0 and fall["m"] < 2.0 and fall["rise"] < 0.1 for fall in falls)


def late_text(sticks):
    late = sticks["late"]
    return f"{sticks['frames']} set points at 40 Hz late by {late['p50_ms']:.1f} ms (median), {late['p999_ms']:.1f} (p99.9), {late['max_ms']:.1f} (most)"


# ---- F21 ----

def link_out(kind, seconds, runs):
    """@return the time from the line's coming back to the next set point, whether it flew on, and the falls of those that did not."""
    resumed, flew_on, falls = [], 0, []
    for _ in range(runs):
        with Flight(kind, between=True) as flight:
            flight.flies()
            flight.between.out = True
            time.sleep(seconds)
            flight.fake("mark")
            flight.between.out = False
            time.sleep(0.6)
            rows = flight.since_mark()
            resumed.append(next((float(row["t_s"]) for row in rows if row["what"] == "frame"), 1e9) - float(rows[0]["t_s"]))
            if BROUGHT_DOWN in flight.heard():
                falls.append(flight.came_down())
            else:
                flew_on += 1
            flight.over()
    return resumed, flew_on, falls


def f21(table, options):
    for kind, line in (("msp", "MSP, serial line"), ("mavlink", "MAVLink, UDP")):
        for seconds in (0.1, 0.5):
            resumed, flew_on, falls = link_out(kind, seconds, options.runs)
            text = f"next set point {1e3 * max(resumed):.0f} ms after it is back; {flew_on} of {options.runs} fly on" + (f", others {down_text(falls)}" if falls else "")
            kept = max(resumed) < 2 * PERIOD + FAKE_TICK and (flew_on == options.runs if seconds < 0.2 else well_down(falls))
            table.row("F21", f"{line}: nothing comes through for {seconds} s, {options.runs} runs", text,
                      "set points again within 2 periods; flies on" if seconds < 0.2 else "set points again within 2 periods; no attitude for 0.15 s: brought down", kept)
    for kind, line in (("msp", "MSP, serial line"), ("mavlink", "MAVLink, UDP")):
        with Flight(kind, between=True) as flight:
            flight.flies()
            flight.fake("mark")
            flight.between.out = True
            time.sleep(1.5)
            noticed = BROUGHT_DOWN in flight.heard()
            fall = flight.came_down(3.0)
            table.row("F21", f"{line}: cut for ever", ("noticed; " if noticed else "not noticed; ") + ("down " if fall else "the controller holds on: ") +
                      ("" if fall else f"{flight.height(flight.since_mark()[-1]):.1f} m high 4.5 s later"), "noticed; the controller's own failsafe: docs/safety.md", noticed)
            flight.process.kill()
    gaps, ends = [], 0
    for _ in range(options.runs):
        with Flight("mavlink") as flight:
            flight.between.troubles = (0.02, 0.1, 0.1)
            flight.flies(4.0)
            gaps.append(flight.gap(flight.now() - 3.0))
            ends += BROUGHT_DOWN in flight.heard()
            flight.over()
    table.row("F21", f"MAVLink, UDP: 2 % lost, 10 % doubled, 10 % behind the next one, both ways, {options.runs} runs", f"{options.runs - ends} of {options.runs} fly on; at most {1e3 * max(gaps):.0f} ms from one set point to the next",
              "flies on; three lost in a row are one in 125,000", ends == 0 and max(gaps) < 4 * PERIOD)


# ---- F22 ----

def stopped(kind, seconds, runs):
    gaps, flew_on, falls = [], 0, []
    for _ in range(runs):
        with Flight(kind) as flight:
            flight.flies()
            flight.fake("mark")
            begin = flight.now()
            if seconds is None:
                flight.process.kill()
            else:
                flight.process.send_signal(signal.SIGSTOP)
                time.sleep(seconds)
                flight.process.send_signal(signal.SIGCONT)
            time.sleep(0.6)
            gaps.append(flight.gap(begin - 0.03, begin + 2.0))
            # After a second process has taken over the first says so, and ends.
            if seconds is not None and flight.process.poll() is None and BROUGHT_DOWN not in flight.heard():
                flew_on += 1
            else:
                falls.append(flight.came_down())
            flight.over()
    return gaps, flew_on, falls


def f22(table, options):
    for kind, line in (("msp", "MSP"), ("mavlink", "MAVLink")):
        for seconds in (0.05, 0.2, 1.0, None):
            gaps, flew_on, falls = stopped(kind, seconds, options.runs)
            most = 0.05 + 2 * PERIOD if seconds == 0.05 else 0.1 + PERIOD
            parts = [f"at most {1e3 * max(gaps):.0f} ms without a set point"] + ([f"{flew_on} of {options.runs} fly on"] if flew_on else []) + ([down_text(falls)] if falls else [])
            table.row("F22", f"{line}: " + ("killed (-9)" if seconds is None else f"stopped for {1e3 * seconds:.0f} ms") + f", {options.runs} runs", "; ".join(parts),
                      f"a set point within {1e3 * most:.0f} ms, whoever sends; flies on, or down within 3 s and 2 m", max(gaps) < most + FAKE_TICK and well_down(falls))


# ---- F23 ----

@contextlib.contextmanager
def busy(programs):
    all_of_them = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(programs)]
    try:
        yield
    finally:
        for each in all_of_them:
            each.kill()
            each.wait()


def without_priority():
    """Words that start a program which may not go first; None where they are not to be had."""
    if os.geteuid() != 0:
        return []  # RLIMIT_RTPRIO is 0 as a rule
    return ["setpriv", "--bounding-set=-sys_nice", "--inh-caps=-sys_nice"] if shutil.which("setpriv") else None


def timed(seconds, hz, wrap, programs):
    with busy(programs), Flight(words=["--set", f"vehicle.imu_hz={hz}"], wrap=wrap) as flight:
        flight.streams()
        flight.fake("arm")
        time.sleep(0.5)
        flight.fake("override on")
        time.sleep(seconds)
        return flight.over()


def f23(table, options):
    cores = os.cpu_count() or 1
    cases = [("nobody else", [], 0, True)]
    cases += [(f"{2 * cores} programs that never sleep on {cores} cores", [], 2 * cores, True)]
    if without_priority():
        cases += [(f"the same, and it may not go first (no CAP_SYS_NICE)", without_priority(), 2 * cores, False)]
    for name, wrap, programs, first in cases:
        for hz in (512, 250):
            told = timed(options.seconds, hz, wrap, programs)
            sticks, loop, granted = told["sticks"], told["pilot_loop"], told["system"]["goes_first"]
            missed = loop["missed"] / max(1, loop["missed"] + told["commands"])
            late = sticks["late"]
            happened = (f"{late_text(sticks)}; "
                        f"{told['commands']} ticks at {hz} Hz by {loop['late']['p50_ms']:.1f}, {loop['late']['p999_ms']:.1f}, {loop['late']['max_ms']:.1f} ms, {loop['missed']} missed ({missed:.0e})")
            kept = late["max_ms"] < 1e3 * PERIOD and missed < 1e-4 if granted or not programs else None
            table.row("F23", f"{name}; goes first: {'yes' if granted else 'no'}", happened, "no set point late by a period, fewer than 1 in 10⁴ ticks missed", kept)
            if first and not granted:
                print("F23: the system does not let it go first: RLIMIT_RTPRIO or CAP_SYS_NICE", file=sys.stderr)


# ---- F24 ----

def full_disk(words, wrap, preexec_fn, folder):
    with Flight(words=["--out", f"{folder}/flight", *words], wrap=wrap, preexec_fn=preexec_fn) as flight:
        flight.flies(9.0)
        ended_before = BROUGHT_DOWN in flight.heard() and "no gate" not in flight.heard()
        told = flight.over()
        lines = [line for line in flight.heard().splitlines() if "not recorded to the end" in line]
        return told, lines, ended_before, flight.process.returncode


def small_files():
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))


def f24(table, _):
    cases = []
    with tempfile.TemporaryDirectory(prefix="gatefly-full-") as folder:
        script = f"mount -t tmpfs -o size=256k none {folder} && exec \"$@\""
        mounted = ["unshare", "-m", "sh", "-c", script, "sh"]
        if subprocess.run([*mounted, "true"], capture_output=True, check=False).returncode == 0:
            cases.append(("the disk of --out is full after 256 KiB (tmpfs)", mounted, None))
        cases.append(("no file may be longer than 100 kB (RLIMIT_FSIZE)", [], small_files))
        for name, wrap, preexec_fn in cases:
            told, lines, ended, code = full_disk([], wrap, preexec_fn, folder)
            late, loop = told["sticks"]["late"], told["pilot_loop"]
            happened = (f"flight {'ended' if ended else 'unaffected'}; set points late by {late['max_ms']:.1f} ms at most, {loop['missed']} of {told['commands']} ticks missed; "
                        f"{loop['unwritten']} ticks not written, {len(lines)} line{'s' if len(lines) != 1 else ''} about it, exit code {code}")
            table.row("F24", name, happened, "flight unaffected, what is missing counted and said in a line",
                      not ended and len(lines) == 1 and loop["unwritten"] > 0 and late["max_ms"] < 1e3 * PERIOD)
            if lines:
                print(f"F24: {lines[0]}".replace(folder, "out"), file=sys.stderr)


# ---- F27 ----

def strangers(rng):
    """A valid frame of any message with a payload of chance, from somebody else than the drone's autopilot; none says that it is a computer aboard."""
    message = rng.choice(list(MESSAGES))
    payload = bytearray(rng.randbytes(rng.randrange(1, 256)))
    if message == 0 and len(payload) > 4:
        payload[4] = 2
    system, component = rng.choice([(s, c) for s in (0, 1, 2, 7, 255) for c in (0, 1, 2, 100, 190, 255) if (s, c) != (1, 1)])
    return frame_of(message, bytes(payload), system, component, rng.randrange(256))


def spoofed(rng):
    """Armed, and in GUIDED_NOGPS, says somebody with another id."""
    beat = struct.pack("<IBBBBB", 20, 2, 3, 129, 4, 3)
    return frame_of(0, beat, *rng.choice([(2, 1), (1, 2), (255, 190), (1, 0)]), rng.randrange(256))


FLOOD = """
import os, signal, socket, sys, time
signal.signal(signal.SIGTERM, signal.default_int_handler)
to, rate, data = ("127.0.0.1", int(sys.argv[1])), float(sys.argv[2]), bytes.fromhex(sys.argv[3])
line, sent, begin, parent = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), 0, time.monotonic(), os.getppid()
try:
    while os.getppid() == parent:
        while sent < rate * (time.monotonic() - begin):
            line.sendto(data, to)
            sent += 1
        time.sleep(0.0005)
except KeyboardInterrupt:
    print(sent / (time.monotonic() - begin))
"""


def flooded(port, data, seconds):
    """@return datagrams a second that were sent there by a stranger."""
    with subprocess.Popen([sys.executable, "-c", FLOOD, str(port), "100000", data.hex()], stdout=subprocess.PIPE, text=True) as flood:
        time.sleep(seconds)
        flood.terminate()
        return float(flood.communicate(timeout=5)[0])


def f27(table, options):
    rng = random.Random(1)
    share = 60.0 * options.minutes / 7
    with Flight("mavlink") as flight:
        flight.streams()
        time.sleep(1.0)
        network = flight.between
        stamped = [data for data in network.recorded if len(data) > 10 and data[7] in (30, 105, 83)][:2000]

        def attacked(name, noise=None, flood=None):
            used, begin = flight.processor_time(), flight.now()
            wall, added = time.monotonic(), network.added
            if flood:
                rate = flooded(network.peers[1][1], flood, share)
            else:
                network.noise = noise
                time.sleep(share)
                network.noise = None
                rate = (network.added - added) / (time.monotonic() - wall)
            load = (flight.processor_time() - used) / (time.monotonic() - wall)
            gap = flight.gap(begin, flight.now())
            streams = flight.process.poll() is None and BROUGHT_DOWN not in flight.heard() and flight.heard().count("gatefly run: flying") == 0
            return load, gap, streams, f"{name}, {rate:,.0f} datagrams a second"

        base, _, _, _ = attacked("nothing")
        per_turn = 4
        attacks = [("random bytes from the controller's own address", lambda: [rng.randbytes(rng.randrange(0, 280)) for _ in range(per_turn)], None),
                   ("valid frames of chance of other systems and components, same address", lambda: [strangers(rng) for _ in range(per_turn)], None),
                   ("\"armed, and in GUIDED_NOGPS\", say other systems and components, same address", lambda: [spoofed(rng) for _ in range(per_turn)], None),
                   ("attitude, IMU and targets of before, again, same address", lambda: rng.choices(stamped, k=per_turn), None),
                   ("the same word from another port", None, spoofed(rng))]
        for name, noise, flood in attacks:
            load, gap, streams, name = attacked(name, noise, flood)
            table.row("F27", f"MAVLink, UDP, {share:.0f} s: {name}", f"{'streams on, nothing believed' if streams else 'ENDED'}; at most {1e3 * gap:.0f} ms from one set point to the next; "
                      f"{100 * (load - base):.1f} % of a core more", "no crash, no state changed, no set point late by a period, less than 10 % of a core", streams and gap < 2 * PERIOD + FAKE_TICK and load - base < 0.1)
        flight.flies()
        alive = "gatefly run: flying" in flight.heard()
        told = flight.over()
        sticks = told.get("sticks", {})
        kept = sticks.get("frames", 0) > 0 and sticks["late"]["max_ms"] < 1e3 * PERIOD and sticks["longest_gap_ms"] < 2e3 * PERIOD
        table.row("F27", "MAVLink, UDP: the whole run, by the program's own clock", f"{late_text(sticks)}; at most {sticks['longest_gap_ms']:.0f} ms from one to the next" if sticks else "it told nothing",
                  "no set point late by a period, nor two apart by two", kept)
        table.row("F27", "and then it is armed and handed over", "it flies" if alive else "IT DOES NOT FLY", "it flies", alive)
    with Flight(between=True) as flight:
        flight.streams()
        begin, used, wall = flight.now(), flight.processor_time(), time.monotonic()
        flight.between.noise = lambda: rng.randbytes(rng.randrange(0, 16))
        time.sleep(share)
        flight.between.noise = None
        load = (flight.processor_time() - used) / (time.monotonic() - wall)
        gap, streams = flight.gap(begin, flight.now()), flight.process.poll() is None
        time.sleep(0.5)
        flight.fake("arm")
        time.sleep(0.3)
        flight.fake("override on")
        time.sleep(2.6)
        flew = "gatefly run: flying" in flight.heard()
        said = flight.heard().strip().splitlines()
        flight.over()
        table.row("F27", f"MSP, {share:.0f} s: up to 16 random bytes among the answers, 500 times a second", f"{'streams on' if streams else 'ended: ' + said[-1]}, {'flies then' if flew else 'does not fly then'}; "
                  f"at most {1e3 * gap:.0f} ms from one set point to the next; {100 * load:.1f} % of a core", "no crash, no set point late by a period, less than 10 % of a core", gap < 2 * PERIOD + FAKE_TICK and load < 0.1 and streams and flew)
    with Flight(between=True) as flight:
        flight.flies()
        flight.fake("mark")
        begin = flight.now()

        def forged():
            code, payload = rng.choice([101, 102, 105, 108, 130]), rng.randbytes(rng.randrange(0, 64))
            body = bytes([len(payload), code]) + payload
            check = 0
            for byte in body:
                check ^= byte
            return b"$M>" + body + bytes([check])

        flight.between.noise = forged
        fall = flight.came_down()
        flight.between.noise = None
        gap, said = flight.gap(begin, flight.now()), flight.heard()
        told = flight.over()
        table.row("F27", "MSP, in flight: valid answers of chance that nobody asked for, 500 a second", f"{told.get('stop_reason', said)}: {down_text([fall])}; at most {1e3 * gap:.0f} ms from one set point to the next",
                  "no crash; another client: brought down, no set point late by a period", well_down([fall]) and gap < 2 * PERIOD + FAKE_TICK)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gatefly")
    parser.add_argument("root")
    rows = {"F21": f21, "F22": f22, "F23": f23, "F24": f24, "F27": f27}
    parser.add_argument("--rows", default=",".join(rows))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=25.0)
    parser.add_argument("--minutes", type=float, default=1.0)
    options = parser.parse_args()
    table = Table()
    for row in options.rows.split(","):
        rows[row](table, options)
    return int(table.bad > 0)


if __name__ == "__main__":
    sys.exit(main())
