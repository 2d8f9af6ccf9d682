#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks an end of the AI Grand Prix's virtual qualifier (TS-002), whoever has written it: MAVLink 2 over UDP beside pictures in slices of JPEG. Python alone, nothing of
gatefly; a line for each rule.

usage: ts002_conformance.py simulator [--port 14550] [--pictures 5600] [--bind 127.0.0.1] [--seconds 10]
           plays the pilot: listens at both ports, sends heartbeats and set points at rest, and looks at what the simulator sends
       ts002_conformance.py pilot [--port 14550] [--host 127.0.0.1] [--seconds 10]
           plays a simulator whose drone stands on the floor: calls the pilot, and looks at what it sends
Exit code 0: every rule is kept; 1: one is not; 2: nobody is there.
"""
import argparse
import math
import socket
import struct
import sys
import time

# Fields as they lie on the wire, and CRC_EXTRA, the byte that stands for the definition.
MESSAGES = {0: ("<IBBBBB", 50), 1: ("<IIIHHhHHHHHHb", 124), 22: ("<fHH16sB", 220), 27: ("<Q9h", 144), 30: ("<I6f", 39), 76: ("<7fHBBB", 152), 77: ("<HB", 143),
            82: ("<I4f3ffBBB", 49), 83: ("<I4f3ffB", 22), 84: ("<I11fHBBB", 143), 105: ("<Q13fH", 93), 111: ("<qq", 34), 148: ("<QQIIIIHH8s8s8s", 178), 253: ("<B50s", 83)}
HEARTBEAT, ATTITUDE, TARGET, POSITION_TARGET, IMU, CLOCK = 0, 30, 82, 84, 105, 111
SLICE = struct.Struct("<IHHIIQ")


def crc_of(data, crc=0xFFFF):
    for byte in data:
        part = (byte ^ crc) & 0xFF
        part = (part ^ (part << 4)) & 0xFF
        crc = (crc >> 8) ^ (part << 8) ^ (part << 3) ^ (part >> 4)
    return crc


def frame_of(message, payload, system=1, component=1, sequence=0):
    payload = payload.rstrip(b"\0") or b"\0"
    body = struct.pack("<BBBBBB", len(payload), 0, 0, sequence & 255, system, component) + message.to_bytes(3, "little") + payload
    return b"\xfd" + body + struct.pack("<H", crc_of(body + bytes([MESSAGES[message][1]])))


def frames_in(data):
    """(message, fields, system, component) of every frame of a datagram; message None: not whole, or its checksum is wrong."""
    while data:
        if data[0] != 0xFD or len(data) < 12:
            yield None, (), 0, 0
            return
        size = 12 + data[1] + (13 if data[2] & 1 else 0)
        message = int.from_bytes(data[7:10], "little")
        if len(data) < size:
            yield None, (), 0, 0
            return
        if message in MESSAGES:
            form, extra = MESSAGES[message]
            right = crc_of(data[1:10 + data[1]] + bytes([extra])) == int.from_bytes(data[10 + data[1]:12 + data[1]], "little")
            payload = data[10:10 + data[1]].ljust(struct.calcsize(form), b"\0")[:struct.calcsize(form)]
            yield (message, struct.unpack(form, payload), data[5], data[6]) if right else (None, (), 0, 0)
        data = data[size:]


class Protocol:
    def __init__(self):
        self.bad = 0

    def rule(self, kept, text, seen=""):
        self.bad += not kept
        print(("well   " if kept else "WRONG  ") + text + (f" ({seen})" if seen else ""), flush=True)


class End:
    """A socket, and everything that has come to it: [(time, message, fields, system, component)]."""

    def __init__(self, bind=None):
        self.line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        if bind:
            self.line.bind(bind)
        self.line.setblocking(False)
        self.peer, self.heard, self.sequence, self.slices = None, [], 0, []

    def say(self, message, *values):
        self.sequence += 1
        if self.peer:
            self.line.sendto(frame_of(message, struct.pack(MESSAGES[message][0], *values), *self.us, self.sequence), self.peer)

    us = (255, 190)

    def receive(self):
        while True:
            try:
                data, sender = self.line.recvfrom(65536)
            except (BlockingIOError, ConnectionError):
                return
            self.peer = self.peer or sender
            if sender == self.peer:
                self.heard += [(time.monotonic(), *frame) for frame in frames_in(data)]

    def of(self, message):
        return [(at, fields) for at, what, fields, _, _ in self.heard if what == message]

    def rate(self, message):
        times = [at for at, _ in self.of(message)]
        return (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 and times[-1] > times[0] else 0.0


def grows(values):
    return all(later > earlier for earlier, later in zip(values, values[1:]))


def pictures_of(slices, protocol):
    """Rules of the slices: a header of 24 bytes, then a part of a JPEG."""
    pictures, wrong = {}, 0
    for data in slices:
        if len(data) < SLICE.size:
            wrong += 1
            continue
        frame, chunk, total, size, part, stamp = SLICE.unpack(data[:SLICE.size])
        wrong += part != len(data) - SLICE.size or chunk >= total or part > size
        pictures.setdefault(frame, {"total": total, "size": size, "stamp": stamp, "parts": {}})["parts"][chunk] = data[SLICE.size:]
    protocol.rule(bool(slices) and not wrong, "pictures: each datagram has a header of 24 bytes and as many bytes as it says", f"{len(slices)} slices, {wrong} wrong")
    whole = {number: b"".join(picture["parts"][i] for i in range(picture["total"])) for number, picture in pictures.items() if len(picture["parts"]) == picture["total"]}
    jpeg = sum(len(data) == pictures[number]["size"] and data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9" for number, data in whole.items())
    protocol.rule(len(whole) > 0 and jpeg == len(whole), "pictures: whole ones are a JPEG of the size that they say", f"{jpeg} of {len(whole)}")
    protocol.rule(bool(whole) and len(whole) >= 0.9 * len(pictures), "pictures: nine in ten come whole", f"{len(whole)} of {len(pictures)}")
    stamps = [pictures[number]["stamp"] for number in sorted(pictures)]
    protocol.rule(len(stamps) > 1 and grows(stamps), "pictures: the simulator's time grows with their numbers")
    seconds = 1e-9 * (stamps[-1] - stamps[0]) if len(stamps) > 1 else 0.0
    protocol.rule(seconds > 0 and 10 <= (len(stamps) - 1) / seconds <= 62, "pictures: 10 to 60 a second", f"{(len(stamps) - 1) / seconds:.1f}" if seconds else "")


def check_simulator(options):
    end, eye = End((options.bind, options.port)), End((options.bind, options.pictures))
    wait = time.monotonic() + 10
    while not end.peer and time.monotonic() < wait:
        end.receive()
        time.sleep(0.01)
    if not end.peer:
        print(f"nobody calls at udp {options.bind}:{options.port}", file=sys.stderr)
        return 2
    begin, asked, beats = time.monotonic(), 0, 0
    while time.monotonic() < begin + options.seconds:
        now = time.monotonic()
        if now - begin >= 0.5 * beats:
            beats += 1
            end.say(HEARTBEAT, 0, 18, 8, 0, 4, 3)
        if now - begin >= 0.025 * asked:
            asked += 1
            end.say(TARGET, int(1e3 * (now - begin)), 1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 128)
            end.say(CLOCK, 0, int(1e9 * now))
        end.receive()
        while True:
            try:
                eye.slices.append(eye.line.recv(65536))
            except BlockingIOError:
                break
        time.sleep(0.001)
    protocol = Protocol()
    broken = sum(message is None for _, message, _, _, _ in end.heard)
    protocol.rule(not broken, "MAVLink 2: whole frames, right checksums", f"{len(end.heard)} frames, {broken} wrong")
    for message, name, least in ((HEARTBEAT, "HEARTBEAT", 0.9), (ATTITUDE, "ATTITUDE", 20), (IMU, "HIGHRES_IMU", 50)):
        protocol.rule(end.rate(message) >= least, f"{name}: at least {max(1, round(least))} a second", f"{end.rate(message):.0f}")
    protocol.rule(grows([fields[0] for _, fields in end.of(ATTITUDE)]) and grows([fields[0] for _, fields in end.of(IMU)]), "ATTITUDE, HIGHRES_IMU: stamps grow")
    first = [fields for _, fields in end.of(IMU)][:50]
    if first:
        mean = [sum(fields[i] for fields in first) / len(first) for i in range(1, 7)]
        protocol.rule(math.dist(mean[:3], (0, 0, -9.81)) < 1.0, "HIGHRES_IMU: on the floor, (0, 0, -9.8) m/s² to front, right, down, within 1", ", ".join(f"{value:.2f}" for value in mean[:3]))
        protocol.rule(math.dist(mean[3:], (0, 0, 0)) < 0.1, "HIGHRES_IMU: and no turn, rad/s")
    level = [fields for _, fields in end.of(ATTITUDE)][:20]
    protocol.rule(bool(level) and all(abs(fields[1]) < 0.1 and abs(fields[2]) < 0.1 for fields in level), "ATTITUDE: level there, rad")
    answers = [(at, fields) for at, fields in end.of(CLOCK) if fields[0] != 0]
    trips = sorted(1e3 * at - 1e-6 * fields[1] for at, fields in answers)
    protocol.rule(len(answers) > 0.5 * asked and trips[0] >= 0, "TIMESYNC: questions are answered with their own time", f"{len(answers)} of {asked}" + (f", median {trips[len(trips) // 2]:.1f} ms" if trips else ""))
    pictures_of(eye.slices, protocol)
    return int(protocol.bad > 0)


def check_pilot(options):
    end = End()
    end.peer, end.us = (options.host, options.port), (1, 1)
    begin, ticks, asked = time.monotonic(), 0, 0
    first = None
    while time.monotonic() < (first or begin + 10) + options.seconds:
        now = time.monotonic()
        while now - begin >= ticks / 120:
            ticks += 1
            stamp = int(1e6 * ticks / 120)
            noise = 0.01 * math.sin(ticks)  # an IMU that repeats itself is stuck
            end.say(IMU, stamp, noise, 0, -9.80665 + noise, noise / 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x3F)
            if ticks % 2 == 0:
                end.say(ATTITUDE, stamp // 1000, 0, 0, 0, 0, 0, 0)
            if ticks % 60 == 0:
                end.say(HEARTBEAT, 0, 2, 0, 0, 3, 3)
        end.receive()
        for _, fields in end.of(CLOCK)[asked:]:
            asked += 1
            if fields[0] == 0:
                end.say(CLOCK, int(1e9 * (time.monotonic() - begin)), fields[1])
        if end.heard and not first:
            first = now
        time.sleep(0.001)
    if not end.heard:
        print(f"nobody answers at udp {options.host}:{options.port}", file=sys.stderr)
        return 2
    protocol = Protocol()
    broken = sum(message is None for _, message, _, _, _ in end.heard)
    protocol.rule(not broken, "MAVLink 2: whole frames, right checksums", f"{len(end.heard)} frames, {broken} wrong")
    protocol.rule(end.rate(HEARTBEAT) >= 1.9, "HEARTBEAT: at least 2 a second", f"{end.rate(HEARTBEAT):.1f}")
    targets = end.of(TARGET)
    rate = max(end.rate(TARGET), end.rate(POSITION_TARGET))
    protocol.rule(2 <= rate < 100, "SET_ATTITUDE_TARGET or SET_POSITION_TARGET_LOCAL_NED: 2 to 100 a second", f"{rate:.1f}")
    if targets:
        fields = [each for _, each in targets]
        protocol.rule(all(math.isfinite(value) for each in fields for value in each), "SET_ATTITUDE_TARGET: numbers are finite")
        protocol.rule(all(0 <= each[8] <= 1 for each in fields), "SET_ATTITUDE_TARGET: thrust within 0 … 1", f"{min(each[8] for each in fields):.2f} … {max(each[8] for each in fields):.2f}")
        protocol.rule(all(each[11] & 64 == 0 and (each[11] & 128 == 0 or each[11] & 7 == 0) for each in fields), "SET_ATTITUDE_TARGET: thrust and an attitude, or rates", f"masks {sorted({each[11] for each in fields})}")
        protocol.rule(all(each[11] & 128 or abs(math.hypot(*each[1:5]) - 1) < 0.01 for each in fields), "SET_ATTITUDE_TARGET: quaternions have length 1")
        stamps = [each[0] for each in fields]
        protocol.rule(all(later >= earlier for earlier, later in zip(stamps, stamps[1:])), "SET_ATTITUDE_TARGET: stamps do not run backwards")
        protocol.rule(all(each[8] == 0 for each in fields), "SET_ATTITUDE_TARGET: no thrust as long as the drone is not armed")
    return int(protocol.bad > 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("end", choices=["simulator", "pilot"])
    parser.add_argument("--port", type=int, default=14550)
    parser.add_argument("--pictures", type=int, default=5600)
    parser.add_argument("--bind", default="127.0.0.1")
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--seconds", type=float, default=10.0)
    options = parser.parse_args()
    return check_simulator(options) if options.end == "simulator" else check_pilot(options)


if __name__ == "__main__":
    sys.exit(main())
