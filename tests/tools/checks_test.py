#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The checks refuse what they are there to refuse.

usage: checks_test.py SOURCE_DIR CXX NM"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE, CXX, NM = sys.argv[1:4]
TOOLS = pathlib.Path(SOURCE) / "tools"
sys.path.insert(0, str(TOOLS))
sys.dont_write_bytecode = True
import check_format  # noqa: E402


def run(tool, *arguments):
    done = subprocess.run([sys.executable, TOOLS / tool, *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout


class Libm(unittest.TestCase):
    """A library of one source, and lists that do and do not match it."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def check(self, code, allowed):
        (self.folder / "bearing.cpp").write_text(code)
        (self.folder / "allowed.txt").write_text(allowed)
        library = self.folder / "libgatefly_pose.a"
        subprocess.run([CXX, "-O1", "-c", "bearing.cpp", "-o", "bearing.cpp.o"], cwd=self.folder, check=True)
        subprocess.run(["ar", "rcs", library, self.folder / "bearing.cpp.o"], check=True)
        return run("check_libm.py", NM, self.folder / "allowed.txt", library)

    def test_a_new_call_is_refused(self):
        for call in ("std::sin(x)", "std::exp(x)", "std::log2(static_cast<float>(x))", "std::pow(x, 1.7)"):
            code, said = self.check(f"#include <cmath>\ndouble f(double x) {{ return {call}; }}\n", "")
            self.assertEqual(code, 1, call)
            self.assertIn("pose/bearing.cpp calls", said)

    def test_a_listed_call_passes_in_its_source_only(self):
        code = "#include <cmath>\ndouble f(double x) { return std::exp(x); }\n"
        self.assertEqual(self.check(code, "# why\npose/bearing.cpp  exp\n")[0], 0)
        self.assertEqual(self.check(code, "pose/other.cpp  exp\n")[0], 1)

    def test_a_list_that_is_too_long_is_refused(self):
        code, said = self.check("double f(double x) { return x; }\n", "pose/bearing.cpp  log\n")
        self.assertEqual(code, 1)
        self.assertIn("calls log no more", said)

    def test_what_is_rounded_correctly_is_free(self):
        code = "#include <cmath>\ndouble f(double x) { return std::sqrt(std::floor(x)) + std::fmod(x, 3.0) + std::lround(x); }\n"
        self.assertEqual(self.check(code, "")[0], 0)

    def test_a_function_of_our_own_of_that_name_is_free(self):
        code = "namespace gatefly { double exp(double); double f(double x) { return exp(x); } }\n"
        self.assertEqual(self.check(code, "")[0], 0)


class Format(unittest.TestCase):
    def test_a_file_that_is_not_formatted_is_named(self):
        if not check_format.formatter():
            return
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / ".clang-format").write_text("BasedOnStyle: Google\n")
            (folder / "src").mkdir()
            (folder / "src" / "good.cpp").write_text("int a = 1;\n")
            self.assertEqual(run("check_format.py", folder)[0], 0)
            (folder / "src" / "bad.hpp").write_text("int  a=1;\n")
            code, said = run("check_format.py", folder)
            self.assertEqual(code, 1)
            self.assertIn("src/bad.hpp", said)
            self.assertNotIn("good.cpp", said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
