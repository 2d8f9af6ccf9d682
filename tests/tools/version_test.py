#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A build names its commit: in a clone, in an archive of it, and not where there is neither.

usage: version_test.py REPOSITORY_ROOT CMAKE [unittest arguments]"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT, CMAKE = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
FILES = ("cmake/gatefly_version.cmake", "cmake/archived_commit.txt", ".gitattributes", "CMakeLists.txt")
ASKS = 'include(cmake/gatefly_version.cmake)\ngatefly_commit("${CMAKE_CURRENT_LIST_DIR}")\nmessage("${GATEFLY_COMMIT} [${GATEFLY_BUILD}]")\n'


def git(folder, *arguments):
    who = ("-c", "user.name=test", "-c", "user.email=test@localhost")
    return subprocess.run(["git", *who, *arguments], cwd=folder, check=True, capture_output=True, text=True).stdout.strip()


class Version(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gatefly-version-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.clone = self.folder / "clone"
        for name in FILES:
            (self.clone / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.clone / name)
        (self.clone / "ask.cmake").write_text(ASKS)
        git(self.clone, "init", "-q")
        git(self.clone, "add", "-A")
        git(self.clone, "commit", "-qm", "one", "--date", "2026-01-02T03:04:05Z")
        self.hash = git(self.clone, "rev-parse", "HEAD")

    def said(self, folder):
        done = subprocess.run([CMAKE, "-P", "ask.cmake"], cwd=folder, check=True, capture_output=True, text=True)
        commit, build = done.stderr.strip().split(" ")
        return commit, build.strip("[]")

    def test_a_clone_names_its_commit_and_that_it_was_changed(self):
        commit, build = self.said(self.clone)
        self.assertEqual(commit, self.hash[:12])
        self.assertRegex(build, rf"^\d{{12}}\.g{self.hash[:7]}$")
        with open(self.clone / "CMakeLists.txt", "a") as file:
            file.write("# changed\n")
        self.assertRegex(self.said(self.clone)[0], rf"^{self.hash[:12]}\+[0-9a-f]{{8}}$")
        self.assertEqual(self.said(self.clone)[1], build + ".changed")

    def test_an_archive_says_what_its_clone_says(self):
        for where in (self.folder / "plain", self.clone / "inside_a_clone"):
            where.mkdir()
            archive = subprocess.run(["git", "archive", "HEAD"], cwd=self.clone, check=True, capture_output=True).stdout
            subprocess.run(["tar", "-x"], cwd=where, input=archive, check=True)
            self.assertEqual(self.said(where), self.said(self.clone))

    def test_without_either_the_commit_is_unknown(self):
        shutil.rmtree(self.clone / ".git")
        self.assertEqual(self.said(self.clone), ("unknown", ""))

    def test_a_citation_is_of_this_version(self):
        version = re.search(r"project\(gatefly VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
        self.assertIn(f"\nversion: {version}\n", (ROOT / "CITATION.cff").read_text())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
