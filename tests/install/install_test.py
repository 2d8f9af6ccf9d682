#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An installed gatefly works: wherever it is put, from any folder, by find_package and by pkg-config.

usage: install_test.py BUILD_DIR SOURCE_DIR CMAKE CXX [unittest arguments]"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
CMAKE, CXX = sys.argv[3:5]
CONFIGURE = (CMAKE, "-G", "Ninja")  # which building gatefly needs; a clean system has no make
VERSION = re.search(r"project\(gatefly VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
# Each of these alone includes all that is meant for others.
DOORS = ("detection/gate_detector.hpp", "pose/gate_fix.hpp", "estimation/navigator.hpp", "race/pilot.hpp",
         "files/image_file.hpp", "config/pilot_files.hpp")
CC = ("gcc", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
INCLUDE = re.compile(r'#include "(gatefly/[^"]+)"')
HELD_ON_THE_FLOOR = ["ground", "take-off", "land", "landed", "the drone did not climb"]


def run(*command, cwd=None, env=None, code=0):
    done = subprocess.run([str(part) for part in command], cwd=cwd, env=env, capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def phases(text):
    return [line.split(": ")[-1] for line in text.splitlines()]


def picture(path):
    """An orange frame of 100 px on grey, as a PPM."""
    line = bytearray(b"\x80\x80\x80" * 320)
    rows = [bytearray(line) for _ in range(240)]
    for v in range(60, 160):
        for u in range(110, 210):
            if not (65 <= v < 155 and 115 <= u < 205):
                rows[v][3 * u:3 * u + 3] = b"\xff\x66\x00"
    path.write_bytes(b"P6 320 240 255\n" + b"".join(rows))


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="gatefly-install-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        put = cls.folder / "put"
        run(CMAKE, "--install", BUILD, "--prefix", put)
        cls.prefix = cls.folder / "moved" / "there"  # nothing in it may remember where it was put
        cls.prefix.parent.mkdir()
        put.rename(cls.prefix)
        cls.env = {**os.environ, "HOME": str(cls.folder), "PKG_CONFIG_PATH": str(next(cls.prefix.rglob("pkgconfig"))),
                   "XDG_DATA_DIRS": str(cls.prefix / "share")}
        cls.picture = cls.folder / "frame.ppm"
        picture(cls.picture)

    def flown_tapes(self, program, env):
        """The recorded race as the pilot in C++ flies it, and as a program in C does; from 0 and from 4 s before 32 bits are full."""
        flight = SOURCE / "tests" / "replay" / "oval_flight"
        setup = (flight / "track.toml", flight / "config-0.toml")
        for start in (0, 2**32 - 4_000_000):
            with self.subTest(start=start):
                tape, wanted, got = (self.folder / name for name in ("flight.tape", "wanted", "got"))
                run(BUILD / "tests" / "pack_flight", flight, tape, wanted, start, *setup)
                said = run(program, tape, got, *setup, env=env)
                self.assertIn("4103 steps, 39 pictures", said)
                self.assertEqual(got.read_bytes(), wanted.read_bytes())
                self.assertEqual(len(wanted.read_bytes()), 4103 * 29 * 8)

    def expect_examples_to_work(self, folder):
        found = run(folder / "find_gates", self.picture, cwd=self.folder)
        corners = [float(number) for number in re.findall(r"-?\d+\.?\d*", found.split(":")[1])]
        self.assertEqual(found.count("fitness"), 1)
        for corner, wanted in zip(corners, (110, 60, 209, 60, 209, 159, 110, 159), strict=True):
            self.assertAlmostEqual(corner, wanted, delta=2)
        for program in ("pilot_loop", "pilot_loop_c"):
            said = run(folder / program, "oval", "cameras/bebop.toml", cwd=self.folder, env=self.env)
            self.assertEqual(phases(said), HELD_ON_THE_FLOOR)

    def test_the_program_works_from_any_folder(self):
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        env = {name: value for name, value in self.env.items() if name != "XDG_DATA_DIRS"}
        program = self.prefix / "bin" / "gatefly"
        self.assertEqual(run(program, "--version").strip(), f"gatefly {VERSION}")
        run(program, "detect", self.picture, "--csv", "found.csv", cwd=elsewhere, env=env)
        self.assertEqual(len((elsewhere / "found.csv").read_text().splitlines()), 2)
        run(program, "config", "--show", "--config", "basement", "--config", "cameras/bebop.toml", cwd=elsewhere, env=env)
        if (self.prefix / "bin" / "gatefly-lab").exists():
            run(program, "fly", "oval", "--vision", "ideal", "--laps", "1", "--quiet", cwd=elsewhere, env=env)
            self.assertTrue((elsewhere / "out" / "oval-1" / "summary.json").exists())
            self.assertTrue((elsewhere / "out" / "oval-1" / "report.html").exists())
            self.assertIn("eyes-real", run(program, "reproduce", "--list", cwd=elsewhere, env=env))

    def test_what_pages_try_things_on_is_there(self):
        elsewhere = self.folder / "samples"
        elsewhere.mkdir()
        program = self.prefix / "bin" / "gatefly"
        run(program, "replay", "tests/replay/oval_flight", "--csv", "estimates.csv", cwd=elsewhere)
        run(program, "detect", "tests/replay/oval_flight", "--config", "cameras/bebop.toml", "--csv", "found.csv", cwd=elsewhere)
        run(program, "track", "tests/courses/spiral.toml", cwd=elsewhere)

    def test_what_man_shells_and_editors_read_is_there(self):
        for path in ("man/man1/gatefly.1", "bash-completion/completions/gatefly", "fish/vendor_completions.d/gatefly.fish",
                     "gatefly/schemas/track.schema.json", "gatefly/schemas/config.schema.json"):
            self.assertGreater(len((self.prefix / "share" / path).read_text()), 1000, path)
        self.assertEqual(len(list((self.prefix / "share" / "zsh").rglob("_gatefly"))), 1)

    def test_without_its_files_the_program_says_where_it_looked(self):
        lone = self.folder / "lone"
        lone.mkdir()
        shutil.copy(self.prefix / "bin" / "gatefly", lone)
        env = {**self.env, "XDG_DATA_DIRS": str(lone)}
        done = subprocess.run([lone / "gatefly", "config", "--show"], cwd=lone, env=env, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no share/gatefly above", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_examples_build_with_find_package(self):
        examples, build = next(self.prefix.rglob("examples")), self.folder / "found"
        for source, most in (("find_gates.cpp", 20), ("pilot_loop.cpp", 40)):
            self.assertLessEqual(len((examples / source).read_text().splitlines()), most)
        run(*CONFIGURE, "-S", examples, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_COMPILER={CXX}",
            "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
        run(CMAKE, "--build", build)
        self.expect_examples_to_work(build)

    def test_examples_build_with_pkg_config(self):
        examples, build = next(self.prefix.rglob("examples")), self.folder / "packaged"
        build.mkdir()
        self.assertEqual(run("pkg-config", "--modversion", "gatefly", "gatefly-files", env=self.env).split(), [VERSION] * 2)
        flags = run("pkg-config", "--cflags", "--libs", "gatefly-files", env=self.env).split()
        for source in examples.glob("*.cpp"):
            run(CXX, "-std=c++20", source, *flags, "-o", build / source.stem)
        flags = run("pkg-config", "--cflags", "--libs", "gatefly-c", env=self.env).split()
        run(*CC, "-std=c99", examples / "pilot_loop.c", *flags, *self.runtime_path(), "-o", build / "pilot_loop_c")
        self.expect_examples_to_work(build)

    def test_names_of_the_release_before_still_compile(self):
        source = self.folder / "old_names.cpp"
        source.write_text("#include <gatefly/config/pilot_files.hpp>\n#include <gatefly/files/image_file.hpp>\n"
                          "int main(int n, char** a) { return gatefly::io::is_picture(a[0]) && n > 9 ? "
                          "int(gatefly::io::read_pilot_config(a[0]).track.gates.size()) : 0; }\n")
        flags = run("pkg-config", "--cflags", "--libs", "gatefly-files", env=self.env).split()
        run(CXX, "-std=c++20", source, *flags, "-o", self.folder / "old_names")

    def runtime_path(self):
        return (f"-Wl,-rpath,{next(self.prefix.rglob('libgatefly_c.so')).parent}",)

    def test_a_program_in_c_flies_the_recorded_race_as_the_pilot_in_cpp_does(self):
        source = SOURCE / "tests" / "c_interface" / "fly_tape.c"
        for standard in ("c99", "c11"):
            flags = run("pkg-config", "--cflags", "--libs", "gatefly-c", env=self.env).split()
            run(*CC, f"-std={standard}", source, *flags, *self.runtime_path(), "-o", self.folder / standard)
        self.flown_tapes(self.folder / "c99", self.env)
        static = run("pkg-config", "--static", "--cflags", "--libs", "gatefly-c", env=self.env).replace("-lgatefly_c ", "-l:libgatefly_c.a ")
        run(*CC, "-std=c99", source, *static.split(), "-o", self.folder / "static")
        self.flown_tapes(self.folder / "static", self.env)
        self.assertNotIn("gatefly", run("ldd", self.folder / "static"))

    def test_a_project_in_c_alone_finds_the_c_interface_and_needs_nothing_else(self):
        project = self.folder / "in_c"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.23)\nproject(p LANGUAGES C)\nfind_package(gatefly REQUIRED COMPONENTS c)\n"
            f"add_executable(fly_tape {SOURCE}/tests/c_interface/fly_tape.c)\ntarget_link_libraries(fly_tape PRIVATE gatefly::c)\n")
        run(*CONFIGURE, "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}", "-DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON")
        run(CMAKE, "--build", project / "build")
        self.flown_tapes(project / "build" / "fly_tape", self.env)

    def test_what_the_documentation_shows_for_autopilots_compiles(self):
        shown = re.findall(r"```c\n(.*?)```", (SOURCE / "docs" / "in_your_autopilot.md").read_text(), re.S)
        self.assertEqual(len(shown), 2)
        stubs = SOURCE / "tests" / "install" / "autopilot_stubs.h"
        for number, code in enumerate(shown):
            source = self.folder / f"shown_{number}.c"
            source.write_text(re.sub(r'#include ".*"\n', "", code))
            flags = run("pkg-config", "--cflags", "gatefly-c", env=self.env).split()
            run("gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-include", stubs, source, *flags)

    def test_the_shared_library_shows_the_functions_of_the_header_and_nothing_else(self):
        header = (self.prefix / "include" / "gatefly.h").read_text()
        declared = set(re.findall(r"^GATEFLY_API .*?(gatefly_\w+)\(", header, re.M))
        shown = run("nm", "-D", "--defined-only", next(self.prefix.rglob("libgatefly_c.so")))
        self.assertEqual({line.split()[-1] for line in shown.splitlines()}, declared)
        self.assertGreater(len(declared), 10)

    def test_the_flight_code_alone_needs_eigen_only(self):
        source = self.folder / "pilot_only.cpp"
        source.write_text('#include <gatefly/race/pilot.hpp>\nint main() {\n  gatefly::PilotConfig config;\n'
                          "  config.track.gates = {{.p_EG = {4.0, 0.0, -1.5}}};\n"
                          "  return gatefly::Pilot{config}.finished();\n}\n")
        flags = run("pkg-config", "--cflags", "--libs", "gatefly", env=self.env).split()
        run(CXX, "-std=c++20", source, *flags, "-o", self.folder / "pilot_only")
        run(self.folder / "pilot_only")
        needs = run("ldd", self.folder / "pilot_only")
        libraries = {line.split()[0].split(".so")[0].split("/")[-1] for line in needs.splitlines()}
        self.assertLessEqual(libraries, {"linux-vdso", "libstdc++", "libm", "libgcc_s", "libc", "ld-linux-x86-64",
                                         "ld-linux-aarch64"})

    def test_the_snippet_of_the_documentation_compiles_and_runs(self):
        readme = (SOURCE / "docs" / "using.md").read_text()
        snippet = re.search(r"## As a library\n.*?```cpp\n(.*?)```", readme, re.S)[1]
        source = self.folder / "readme.cpp"
        source.write_text("#include <vector>\n#include <gatefly/race/pilot.hpp>\nint main() {\n"
                          "const std::chrono::nanoseconds stamp{0};\nconst Eigen::Vector3d gyro{0, 0, 0}, accel{0, 0, -9.81};\n"
                          "const std::vector<std::uint8_t> frame(2 * 160 * 315, 128);\nconst std::uint8_t* bytes = frame.data();\n"
                          + snippet + "return command.motors[0] == 0.0 ? 0 : 1;\n}\n")
        flags = run("pkg-config", "--cflags", "--libs", "gatefly", env=self.env).split()
        run(CXX, "-std=c++20", "-Wall", "-Wextra", "-Werror", source, *flags, "-o", self.folder / "readme")
        run(self.folder / "readme")

    def test_headers_are_the_doors_and_what_they_speak_of(self):
        include = self.prefix / "include"
        installed = {str(path.relative_to(include)) for path in include.rglob("*.hpp")}
        reached, ahead = set(), {f"gatefly/{door}" for door in DOORS}
        while ahead:
            header = ahead.pop()
            reached.add(header)
            self.assertIn(header, installed)
            ahead |= set(INCLUDE.findall((include / header).read_text())) - reached
        self.assertEqual(installed - reached, set())

    def test_another_version_is_refused(self):
        project = self.folder / "other_version"
        project.mkdir()
        (project / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.23)\nproject(p LANGUAGES CXX)\n"
                                                "find_package(gatefly ${WANTED} REQUIRED)\n")
        major, minor, _ = VERSION.split(".")
        for wanted, code in ((f"{major}.{minor}", 0), (f"{major}.{int(minor) + 1}", 1)):
            run(*CONFIGURE, "-S", project, "-B", self.folder / "v", f"-DWANTED={wanted}", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                f"-DCMAKE_CXX_COMPILER={CXX}", code=code)

    def test_as_a_part_of_another_project_it_is_the_flight_code_alone(self):
        project = self.folder / "around"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.22)\nproject(around LANGUAGES CXX)\n"
            f"add_subdirectory({SOURCE} gatefly)\nadd_library(user user.cpp)\n"
            "target_link_libraries(user PRIVATE gatefly::gatefly)\n")
        (project / "user.cpp").write_text("#include <gatefly/race/pilot.hpp>\n")
        run(*CONFIGURE, "-S", project, "-B", project / "build", f"-DCMAKE_CXX_COMPILER={CXX}")
        targets = run(CMAKE, "--build", project / "build", "--target", "help")
        self.assertIn("libgatefly_race.a", targets)
        for other in ("gatefly_sim", "gatefly_config", "_test"):
            self.assertNotIn(other, targets)
        run(CMAKE, "--build", project / "build", "--target", "gatefly/src/flight/gatefly/geometry/all")


class Headers(unittest.TestCase):
    def test_each_public_header_compiles_alone(self):
        run(CMAKE, "--build", BUILD, "--target", "all_verify_interface_header_sets")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[5:], verbosity=2)
