#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The package as its user meets it: everything has its words and its types, the examples and the page run."""
import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys

import gatefly
import support
from support import FLIGHT, ROOT, Case

PACKAGE = pathlib.Path(gatefly.__file__).resolve().parent
SPECIAL = {"__call__", "__iter__", "__next__", "__array__"}


def stub():
    """{name: {member: parameters or None}} of the stub's classes, {name: parameters} of its functions."""
    def parameters(function):
        decorators = [ast.unparse(each) for each in function.decorator_list]
        if "property" in decorators:
            return None
        names = [each.arg for each in function.args.args]
        return names if "staticmethod" in decorators or names[:1] != ["self"] else names[1:]

    classes, functions = {}, {}
    for node in ast.parse((PACKAGE / "_gatefly.pyi").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            classes[node.name] = {each.name: parameters(each) for each in node.body if isinstance(each, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            functions[node.name] = parameters(node)
    return classes, functions


def members(kind):
    return {name: each for name, each in vars(kind).items() if not name.startswith("_") or name in SPECIAL}


def named_in(text):
    """Names of the parameters in a signature as pybind11 writes it on the first line."""
    inside = re.match(r"\w+\((.*)\) -> ", text.splitlines()[0])[1]
    return [each for each in re.findall(r"(?:^|, )(\w+): ", inside) if each != "self"]


class Package(Case):
    def test_everything_public_is_in_the_stub_and_the_other_way_round(self):
        classes, functions = stub()
        self.assertEqual({name for name in gatefly.__all__ if inspect.isclass(getattr(gatefly, name))}, set(classes))
        self.assertEqual({name for name in gatefly.__all__ if not inspect.isclass(getattr(gatefly, name))}, set(functions))
        self.assertEqual({name for name in dir(gatefly._gatefly) if not name.startswith("_")}, set(gatefly.__all__))
        self.assertTrue((PACKAGE / "py.typed").exists())
        for name, listed in classes.items():
            if name in ("Race", "Pictures") and not support.has_simulator():
                continue
            self.assertEqual(set(members(getattr(gatefly, name))), set(listed) - {"__init__"}, name)

    def test_the_stub_has_the_names_of_all_arguments(self):
        classes, functions = stub()
        for name, listed in functions.items():
            self.assertEqual(named_in(getattr(gatefly, name).__doc__), listed, name)
        for name, listed in classes.items():
            if name in ("Race", "Pictures") and not support.has_simulator():
                continue
            for member, parameters in listed.items():
                what = inspect.getattr_static(getattr(gatefly, name), member)
                if parameters is None:
                    self.assertIsInstance(what, property, f"{name}.{member}")
                elif member not in ("__iter__", "__next__"):
                    self.assertEqual(named_in(getattr(getattr(gatefly, name), member).__doc__), parameters, f"{name}.{member}")

    def test_everything_public_says_what_it_is(self):
        for name in gatefly.__all__:
            public = getattr(gatefly, name)
            self.assertGreater(len(public.__doc__.strip()), 20, name)
            if inspect.isroutine(public):
                self.assertGreater(len(public.__doc__.splitlines()), 2, name)
            for member, what in members(public).items() if inspect.isclass(public) else ():
                words = what.__doc__ if isinstance(what, property) else getattr(public, member).__doc__
                if isinstance(what, property) or member not in SPECIAL:
                    self.assertRegex(words or "", r"(?s)\w|\[", f"{name}.{member}")
        self.assertRegex(gatefly.__doc__, "docs/python.md")

    def test_the_version_is_the_programs(self):
        self.assertEqual(self.program("--version"), f"gatefly {gatefly.__version__}\n")


class Examples(Case):
    def run_python(self, *arguments):
        run = subprocess.run([sys.executable, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=120, check=False,
                             env=dict(os.environ, PYTHONWARNINGS="error", PYTHONPATH=str(PACKAGE.parent)))
        self.assertEqual((run.returncode, run.stderr), (0, ""), run.stdout)
        return run.stdout

    def example(self, name, *arguments):
        return self.run_python(ROOT / "examples" / "python" / name, *arguments)

    def test_gates_in_a_picture(self):
        said = self.example("gates_in_a_picture.py", FLIGHT / "img_00016.jpg", "--config", ROOT / "cameras" / "bebop.toml")
        self.assertRegex(said, r"315 x 160, [1-9] gates\n  fitness [01]\.\d+, \w+: \(")
        self.assertRegex(said, r"the drone is \d\.\d m before it")

    @support.needs_simulator
    def test_watch_a_race(self):
        said = self.example("watch_a_race.py", "oval", "--seed", 3, "--seconds", 2)
        self.assertGreater(said.count("off by"), 15)
        self.assertRegex(said.splitlines()[-1], r"^stopped: 0 of 6 gates in 2\.\d s$")

    def test_replay_a_flight(self):
        said = self.example("replay_a_flight.py", FLIGHT)
        self.assertRegex(said, r"(?s)^drag: \d+ samples.*rms x 0\.\d\d.*imu15: ")

    @support.needs_simulator
    def test_every_snippet_of_the_page_runs_in_order(self):
        page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
        snippets = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)
        self.assertGreater(len(snippets), 3)
        script = self.folder / "page.py"
        script.write_text(f"import os\nos.chdir({str(ROOT)!r})\n" + "\n".join(snippets), encoding="utf-8")
        self.run_python(script)

    def test_the_page_lists_everything(self):
        page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
        for name in gatefly.__all__:
            self.assertRegex(page, rf"\b{name}\b")


if __name__ == "__main__":
    support.main()
