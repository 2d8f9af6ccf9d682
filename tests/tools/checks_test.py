#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The checks refuse what they are there to refuse.

usage: checks_test.py SOURCE_DIR CXX NM"""
import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, CXX, NM = sys.argv[1:4]
TOOLS = pathlib.Path(SOURCE) / "tools"
sys.path.insert(0, str(TOOLS))
sys.dont_write_bytecode = True
import check_calls  # noqa: E402
import check_format  # noqa: E402
import check_stack  # noqa: E402


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


def library_of(folder, code, *options):
    """A library of one source, which binds its functions at once."""
    (folder / "step.cpp").write_text("#include <cstdlib>\n#include <mutex>\n#include <unistd.h>\n" + code)
    subprocess.run([CXX, "-O2", "-shared", "-fPIC", "-Wl,-z,now", *options, "step.cpp", "-o", "libstep.so"], cwd=folder, check=True)
    return folder / "libstep.so"


SOME_WORK = """
extern volatile int some; volatile int some;
[[gnu::noinline]] static int work(int n) { some = n; return some + 1; }
"""


@unittest.skipUnless(platform.machine() == "x86_64", "reads the instructions of this processor only")
class Calls(unittest.TestCase):
    """Libraries of one source, read from their function `step`."""

    def wrong_in(self, code, *options, expected=()):
        with tempfile.TemporaryDirectory() as name:
            functions = check_stack.read(library_of(pathlib.Path(name), code, *options))
            return check_calls.judged(functions, ["step"], list(expected))[0]

    def test_what_allocates_locks_throws_or_calls_the_system_somewhere_below_is_named(self):
        below = "volatile char* p;\n[[gnu::noinline]] static void below(int n) {{ {} }}\nextern \"C\" void step(int n) {{ below(n); below(n + 1); }}\n"
        wrong = {
            "p = new char[n];": {"operator new[]"},
            "p = static_cast<char*>(std::malloc(n));": {"malloc"},
            "static std::mutex m; m.lock();": {"pthread_mutex_lock", "std::__throw_system_error"},
            "if (n > 3) throw n;": {"__cxa_allocate_exception", "__cxa_throw"},
            "if (write(1, &n, 1) < 0) p = nullptr;": {"write"},
        }
        for body, whom in wrong.items():
            self.assertEqual({line.rpartition(" ")[2] if "operator" not in line else "operator new[]" for line in self.wrong_in(below.format(body))}, whom, body)

    def test_what_is_expected_of_this_caller_passes_and_of_another_does_not(self):
        code = 'volatile char* p;\nextern "C" void step(int n) { p = new char[n]; }\n'
        self.assertEqual(self.wrong_in(code, expected=[("step", r"operator new\[\]", "why")]), [])
        said = self.wrong_in(code, expected=[("other", r"operator new\[\]", "why")])
        self.assertEqual(len(said), 2, said)
        self.assertIn("listed, and called no more: other", said[1])

    def test_a_call_by_pointer_is_named_at_the_end_of_a_function_too(self):
        hidden = ["nobody can tell whom step calls"]
        self.assertEqual(self.wrong_in('extern "C" int step(int (*f)(int)) { return f(3) + 1; }\n'), hidden)
        self.assertEqual(self.wrong_in('struct Base { virtual int turn(int) = 0; };\nextern "C" int step(Base* b) { return b->turn(3); }\n'), hidden)

    def test_a_switch_is_no_call_by_pointer(self):
        cases = "".join(f"case {i}: return work({i * i + 7}) * {i + 2};" for i in range(12))
        self.assertEqual(self.wrong_in(SOME_WORK + 'extern "C" int step(int n) { switch (n) { ' + cases + " } return 0; }\n"), [])

    def test_a_jump_is_that_of_a_switch_only_with_its_table(self):
        loaded, added = "  1:\tmovslq (%rdx,%rax,4),%rax", "  2:\tadd    %rdx,%rax"
        self.assertTrue(check_stack.is_switch([loaded, added], "  3:\tnotrack jmp *%rax"))
        for lines, jump in (([added], "  3:\tjmp    *%rax"), ([loaded, added], "  3:\tjmp    *%rcx"), ([loaded, added], "  3:\tcall   *%rax"), ([loaded, "  2:\tadd    %rsi,%rax"], "  3:\tjmp    *%rax")):
            self.assertFalse(check_stack.is_switch(lines, jump), (lines, jump))

    def test_versions_for_several_processors_are_looked_into(self):
        code = ('volatile char* p;\n[[gnu::target_clones("avx2", "default"), gnu::noinline]] static void below(int n) { p = static_cast<char*>(std::malloc(n)); }\n'
                'extern "C" void step(int n) { below(n); }\n')
        said = self.wrong_in(code)
        self.assertEqual(len(said), 2, said)
        self.assertTrue(all("below" in line and line.endswith("calls malloc") for line in said), said)

    def test_what_is_seldom_done_is_looked_into(self):
        code = SOME_WORK + 'extern "C" int step(int n) { if (__builtin_expect(n > 3, 0)) { work(1); throw n; } return work(n); }\n'
        self.assertTrue(any(line.endswith("calls __cxa_throw") for line in self.wrong_in(code)))

    def test_the_exit_code_says_it_and_late_binding_is_refused(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            code, said = run("check_calls.py", library_of(folder, 'extern "C" int step(int n) { return n + 1; }\n'), "step")
            self.assertEqual(code, 1)
            self.assertTrue(all("called no more" in line for line in said.splitlines() if line.startswith("calls: ") and "functions from" not in line), said)
            self.assertIn("calls: 1 functions from step on, 0 calls of others", said)
            self.assertIn("first called", run("check_calls.py", library_of(folder, 'extern "C" int step(int n) { return n + 1; }\n', "-Wl,-z,lazy"), "step")[1])


@unittest.skipUnless(platform.machine() == "x86_64", "reads the instructions of this processor only")
class Stack(unittest.TestCase):
    def said_of(self, code, most=4096):
        with tempfile.TemporaryDirectory() as name:
            return run("check_stack.py", library_of(pathlib.Path(name), SOME_WORK + code), "step", str(most))

    def test_frames_on_the_deepest_way_are_added_up(self):
        code = ("[[gnu::noinline]] static int below(int n) { volatile char room[1000]; room[n] = 1; return work(room[n]) + 1; }\n"
                'extern "C" int step(int n) { volatile char room[2000]; room[n] = 1; return below(room[n]) + 1; }\n')
        exit_code, said = self.said_of(code)
        self.assertEqual(exit_code, 0, said)
        total = int(said.split()[1])
        self.assertTrue(3000 < total < 3400, said)
        self.assertEqual(self.said_of(code, 3000)[0], 1)

    def test_what_calls_itself_at_once_or_by_way_of_another_is_refused(self):
        for code in ('extern "C" int step(int n) { return n < 1 ? work(n) : step(work(n)) + step(n - 2); }\n',
                     'extern "C" int step(int n);\n[[gnu::noinline]] static int other(int n) { return step(n - 1) + work(n); }\nextern "C" int step(int n) { return n < 1 ? 0 : other(n) + 1; }\n'):
            exit_code, said = self.said_of(code)
            self.assertEqual(exit_code, 1, said)
            self.assertIn("recursion: step", said)

    def test_a_call_by_pointer_is_refused_and_what_matches_a_pattern_is_left_out(self):
        code = '[[gnu::noinline]] static int by_paper(int (*f)(int)) { volatile char room[9000]; room[1] = 1; return f(3) + room[1]; }\nextern "C" int step(int (*f)(int)) { return by_paper(f) + work(2); }\n'
        exit_code, said = self.said_of(code, 20000)
        self.assertEqual(exit_code, 1)
        self.assertIn("by pointer: by_paper", said)
        with tempfile.TemporaryDirectory() as name:
            exit_code, said = run("check_stack.py", library_of(pathlib.Path(name), SOME_WORK + code), "step", "4096", "paper")
        self.assertEqual(exit_code, 0, said)

    def test_a_frame_of_variable_size_is_refused(self):
        exit_code, said = self.said_of('extern "C" int step(int n) { volatile char* room = static_cast<volatile char*>(__builtin_alloca(n)); room[0] = 1; return work(room[n / 2]); }\n')
        self.assertEqual(exit_code, 1)
        self.assertIn("a frame of variable size: step", said)


class Loops(unittest.TestCase):
    def said_of(self, loop):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "src" / "flight").mkdir(parents=True)
            (folder / "src" / "flight" / "loop.cpp").write_text(f"void f(int n) {{\n{loop}\n}}\n")
            return run("check_loops.py", folder)

    def test_a_loop_that_does_not_count_and_does_not_say_how_often_is_named(self):
        for loop in ("  while (n > 0) n /= 2;", "  do {\n    n /= 2;\n  } while (n > 0);", "  for (; n > 0; n /= 2) {}", "  for (;;) {}", "  for (int i = 0; i < n;) i += 2;",
                     "  for (double step = 1.0;; step *= 0.5) {}", "  for (int i = 9 - n; i < n - 1;) i += 2;", "  for (int i = first(n); i < n; i = next(i)) {}",
                     "  for (auto p = list.begin(); p != list.end();\n       p = next(p)) {}", "again:\n  if (n > 0) goto again;", "  for (double x = 0; x < n; x += dx) {}",
                     "  for (Node* p = head; p; ++count, p = p->next) {}", "  for (int i = 0; true; ++i) {}", "  if (n > 9) {\n  }\n  while (n > 0);"):
            code, said = self.said_of(loop)
            self.assertEqual(code, 1, loop)
            self.assertRegex(said, r"src/flight/loop.cpp:[234]:")

    def test_a_loop_that_counts_or_says_how_often_passes(self):
        for loop in ("  for (int i = 0; i < n; ++i) {}", "  for (int i = n; i-- > 0;) {}", "  // At most 31 times.\n  while (n > 0) n /= 2;", "  while (n > 0) n /= 2;  // at most 31 times",
                     "  for (const int each : list) {}", "  for (int i = 0, k = at(n); i < n; ++i, k += step * 2) {}", '  say("while (true) for (;;)");', "  // while (n > 0) do nothing"):
            self.assertEqual(self.said_of(loop)[0], 0, loop)


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


class Layers(unittest.TestCase):
    """The sources with one line more."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        shutil.copytree(pathlib.Path(SOURCE) / "src", cls.root / "src")
        (cls.root / "docs").mkdir()
        shutil.copy(pathlib.Path(SOURCE) / "docs" / "architecture.md", cls.root / "docs")
        for name in ("c", "tests"):
            (cls.root / name).symlink_to((pathlib.Path(SOURCE) / name).resolve())

    def said_with(self, place, line, tool="check_layers.py", *arguments):
        """Exit code and what the tool says when `line` stands at the end of a file."""
        file = self.root / "src" / place
        before = file.read_text()
        try:
            file.write_text(before + line + "\n")
            return run(tool, self.root, *arguments)
        finally:
            file.write_text(before)

    def test_what_a_folder_may_not_do_is_named(self):
        files, geometry = "workshop/gatefly/files", "flight/gatefly/geometry"
        wrong = {
            (f"{files}/text.hpp", '#include "gatefly/sim/body.hpp"'): "files may not include sim",
            (f"{files}/CMakeLists.txt", "target_link_libraries(gatefly_files PUBLIC gatefly::sim)"): "workshop may not depend on sim, of simulator",
            (f"{geometry}/CMakeLists.txt", "target_link_libraries(gatefly_geometry PUBLIC gatefly::sensing)"): "depend on each other in a circle",
            (f"{files}/text.hpp", "namespace gatefly::io {\nint of();\n}  // namespace gatefly::io"): "namespace gatefly::io, not gatefly::files",
            (f"{geometry}/math.hpp", "#include <thread>"): "flight code includes <thread>",
        }
        self.assertEqual(run("check_layers.py", self.root)[0], 0)
        for (place, line), error in wrong.items():
            code, said = self.said_with(place, line)
            self.assertEqual(code, 1, line)
            self.assertIn(error, said)

    def test_an_arrow_that_is_not_drawn_or_points_up_is_refused(self):
        self.assertEqual(run("draw_folders.py", self.root, "--check")[0], 0)
        more = "target_link_libraries(gatefly_world PUBLIC gatefly::pose)"
        code, said = self.said_with("workshop/gatefly/world/CMakeLists.txt", more, "draw_folders.py", "--check")
        self.assertEqual(code, 1)
        self.assertIn("is not that of their CMakeLists.txt", said)
        up = "target_link_libraries(gatefly_world PUBLIC gatefly::sim)"
        self.assertIn("1 up, 2 in circles", self.said_with("workshop/gatefly/world/CMakeLists.txt", up, "draw_folders.py", "--check")[1])


class Docs(unittest.TestCase):
    """The project with one line more, in a page or a source."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        for each in pathlib.Path(SOURCE).iterdir():
            if each.name in ("docs", "apps"):
                shutil.copytree(each, cls.root / each.name)
            elif not each.name.startswith(".") and each.name not in ("build", "out"):
                (cls.root / each.name).symlink_to(each.resolve())

    def errors_of(self, lines, place="docs/paper/results.md"):
        """Complaints on each of the lines, written behind the page's own."""
        file = self.root / place
        before = file.read_text()
        first = before.count("\n") + 2
        try:
            file.write_text(before + "\n" + "\n\n".join(lines) + "\n")
            code, said = run("check_docs.py", self.root)
        finally:
            file.write_text(before)
        found = [[] for _ in lines]
        for line in said.splitlines() if code else []:
            where, number, error = line.split(":", 2)
            self.assertEqual(where, place, line)
            found[(int(number) - first) // 2].append(error.strip())
        return found

    def test_what_is_not_there_is_named(self):
        wrong = {
            "[a page](nowhere.md)": "link nowhere.md leads nowhere",
            "[a place](deviations.md#nowhere)": "has no place #nowhere",
            "[a place here](#nowhere)": "has no place #nowhere",
            "`tools/nothing.py`": "there is no file tools/nothing.py",
            "`race/nothing.cpp`": "there is no file race/nothing.cpp",
            "`nothing.hpp`": "there is no file called nothing.hpp",
            "`no_such_function`": "no_such_function is nowhere",
            "`Pilot::no_such_thing`": "Pilot::no_such_thing is nowhere",
            "`NoSuchClass::step`": "NoSuchClass::step is nowhere",
            "`gatefly flie oval`": "there is no command gatefly flie",
            "    ./gatefly flie oval": "there is no command gatefly flie",
            "    ./gatefly fly oval --sed 7": "gatefly fly has no --sed",
            "    ./gatefly detect photo.jpg --seed 7   # of another command": "gatefly detect has no --seed",
            "`gatefly fly ovl`": "there is no track ovl",
            "    ./gatefly fly --config nothing": "there is no configuration nothing",
            "    ./gatefly campaign tests/courses/nothing.toml --runs 2": "there is no file tests/courses/nothing.toml",
            "`gatefly reproduce nothing`": "there is no experiment nothing",
            "`reproduce roc-length nothing`": "there is no experiment nothing",
            "`camera.tilt_rad`": "there is no key camera.tilt_rad",
            '`detector.mode = "best"`': "detector.mode is never best",
            "`--set sim.nothing=1`": "there is no key sim.nothing",
            "    ./gatefly fly --set randomize.nothing=1": "there is no key randomize.nothing",
            "`sim.ghosts_percent`": "is the old name of sim.outliers_percent",
            "`Pilot.DoesNothing`": "there is no test Pilot.DoesNothing",
        }
        for (line, error), said in zip(wrong.items(), self.errors_of(wrong), strict=True):
            self.assertEqual(len(said), 1, f"{line}: {said}")
            self.assertIn(error, said[0])

    def test_a_test_of_the_command_line_that_is_not_there_is_named(self):
        table = "| use | test |\n| --- | --- |\n| a | a_test_that_nobody_wrote |"
        self.assertEqual(self.errors_of([table, ""])[1], ["there is no test a_test_that_nobody_wrote"])

    def test_a_place_named_in_a_source_that_is_not_there_is_named(self):
        wrong = ["docs/paper/deviations.md#nowhere", "results.md#nowhere", "docs/nothing.md"]
        for line, said in zip(wrong, self.errors_of([f"// as in {each}" for each in wrong], "apps/gatefly/main.cpp"), strict=True):
            self.assertEqual(len(said), 1, line)

    def test_what_is_there_is_not_named(self):
        right = ["[a place](deviations.md#eq-9)", "[lenses](../conventions.md#lenses)", "`Pilot::step`, `map_pose()`",
                 "`gatefly fly oval --seed 7`", "    ./gatefly reproduce --all --quick", "`camera.tilt_deg = 20`",
                 "`race/pilot.cpp`, `tests/courses/*.toml`, `found.csv`, `my.toml`", "```\n[no link](nowhere.md)\n```"]
        self.assertEqual([error for errors in self.errors_of(right) for error in errors], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
