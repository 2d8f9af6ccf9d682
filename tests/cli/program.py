# SPDX-License-Identifier: Apache-2.0
"""The program as somebody who types sees it: run in a folder of its own, its answers, its refusals.

Of whoever imports this: FILE_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

if len(sys.argv) < 3:
    sys.exit(sys.modules["__main__"].__doc__)
GATEFLY = str(pathlib.Path(sys.argv[1]).resolve())
ROOT = pathlib.Path(sys.argv[2]).resolve()


class Cli(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gatefly-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.cache = self.folder / "cache"

    def run_it(self, *arguments, preexec_fn=None, **variables):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.cache), **variables)
        return subprocess.run([GATEFLY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder,
                              env=environment, timeout=120, check=False, preexec_fn=preexec_fn)

    def file(self, name, content):
        path = self.folder / name
        path.write_text(content, encoding="utf-8")
        return path

    def refused(self, *arguments, **variables):
        """Runs what must be refused: exit 2, nothing on stdout, one line on stderr, nothing left behind."""
        before = sorted(path for path in self.folder.rglob("*"))
        result = self.run_it(*arguments, **variables)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(sorted(path for path in self.folder.rglob("*")), before)
        return result.stderr

    def fly_track(self, content):
        return self.refused("fly", self.file("mine.toml", content))


def main(at_once=1):
    """at_once: so many cases run beside each other, each in a process of its own; for those that wait most of the time."""
    if at_once == 1 or sys.argv[3:]:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
    suites = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    names = [case.id().removeprefix("__main__.") for suite in suites for case in suite]
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        sys.exit(any(list(pool.map(lambda name: subprocess.run([sys.executable, *sys.argv, name], check=False).returncode, names))))
