#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The flight code on an ARM processor, run here by qemu: its unit tests, gates in raw pictures, a whole recorded race.

usage: check_arm.py armv7|aarch64 [--replay]      --replay: without the unit tests, which take most of the building

Builds preset armv7 or aarch64; the race comes from build/release, which must be built. Exit 0: all as here; 1: not; 77: compilers or qemu
are missing, the last line says which.

Sums are rounded in another order there (armv7 has no vectors of two doubles; why aarch64 is not equal is not known yet): outputs may
differ by LIMITS."""
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
NEEDS = {"armv7": {"arm-linux-gnueabihf-g++": "g++-arm-linux-gnueabihf", "qemu-arm": "qemu-user"},
         "aarch64": {"aarch64-linux-gnu-g++": "g++-aarch64-linux-gnu", "qemu-aarch64": "qemu-user"}}
RUN = {"armv7": ("qemu-arm", "-L", "/usr/arm-linux-gnueabihf"), "aarch64": ("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu")}
FLIGHTS = {"tests/replay/oval_flight": ("tests/replay/oval_flight/track.toml", "tests/replay/oval_flight/config-0.toml")}
OUTPUTS = 29  # numbers of a step, see tests/c_interface/fly_tape.c
# From where in a step's numbers, how many, and by how much they may differ on armv7.
LIMITS = {"attitude command [rad]": (0, 4, 1e-5), "rotors [rad/s]": (5, 4, 0.1), "position [m]": (12, 3, 1e-5), "velocity [m/s]": (15, 3, 1e-5),
          "attitude [rad]": (18, 3, 1e-6), "phase, gates passed": (27, 2, 0.0)}


def quietly(*command):
    done = subprocess.run([str(part) for part in command], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(str(part) for part in command)}:\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


def differences(wanted, got):
    """{what: the largest difference} of two files of outputs."""
    numbers = [struct.unpack(f"<{len(each) // 8}d", each) for each in (wanted, got)]
    assert len(numbers[0]) == len(numbers[1])
    return {what: max(abs(a[step + i] - b[step + i]) for a, b in [numbers] for step in range(0, len(a), OUTPUTS) for i in range(first, first + count))
            for what, (first, count, _) in LIMITS.items()}


def same_gates(wanted, got):
    """Whether two outputs of detect_tape name the same gates, to a thousandth of a pixel."""
    lines = [[row.split() for row in text.splitlines()] for text in (wanted, got)]
    return len(lines[0]) == len(lines[1]) and all(
        a[0] == b[0] and all(abs(float(a[i]) - float(b[i])) <= 1e-3 for i in range(2, len(a), 2)) for a, b in zip(*lines))


def check_flight(preset, flight, setup, folder):
    native, built = ROOT / "build/release/tests", ROOT / "build" / preset / "tests"
    tape, wanted, got = (folder / name for name in ("tape", "wanted", "got"))
    quietly(native / "pack_flight", flight, tape, wanted, 0, *setup)
    said = quietly(*RUN[preset], built / "fly_tape", tape, got, *setup)
    equal = wanted.read_bytes() == got.read_bytes()
    print(f"{preset}: {flight}: {said.strip()}; {'equal to x86-64, to the bit' if equal else 'differs'}")
    well = True
    if not equal:
        for what, worst in differences(wanted.read_bytes(), got.read_bytes()).items():
            print(f"  {what}: {worst:.2e} at most")
            well = well and worst <= LIMITS[what][2]
    gates = quietly(native / "detect_tape", tape), quietly(*RUN[preset], built / "detect_tape", tape)
    found = same_gates(*gates)
    print(f"{preset}: {len(gates[0].splitlines())} gates in its pictures: {'the same' if found else 'others'}")
    return well and found


def main(arguments):
    if not arguments or arguments[0] not in NEEDS or set(arguments[1:]) - {"--replay"}:
        sys.exit(__doc__)
    preset = arguments[0]
    missing = sorted({package for program, package in NEEDS[preset].items() if shutil.which(program) is None})
    if not pathlib.Path("/usr/src/googletest").exists():
        missing.append("libgtest-dev")
    if missing:
        print(f"{preset}: skipped, not installed: {' '.join(missing)}")
        return 77
    quietly("cmake", "--preset", preset)
    targets = ("fly_tape", "detect_tape") if "--replay" in arguments else ("flight_tests", "fly_tape", "detect_tape")
    quietly("cmake", "--build", f"build/{preset}", "--target", *targets)
    if "--replay" not in arguments:
        print(quietly("ctest", "--preset", preset).splitlines()[-1])
    with tempfile.TemporaryDirectory() as folder:
        return 0 if all([check_flight(preset, flight, setup, pathlib.Path(folder)) for flight, setup in FLIGHTS.items()]) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
