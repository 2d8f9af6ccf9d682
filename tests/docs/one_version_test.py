#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One version everywhere: CMakeLists.txt, which the packages follow, CITATION.cff, CHANGELOG.md, docs, and the tag of this commit.

usage: one_version_test.py REPOSITORY_ROOT [unittest arguments]
"""
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(sys.argv[1]).resolve()


def text_of(path):
    return (ROOT / path).read_text(encoding="utf-8")


VERSION = re.search(r"project\(gatefly VERSION (\d+\.\d+\.\d+)", text_of("CMakeLists.txt"))[1]


class Version(unittest.TestCase):
    def test_the_citation_has_it(self):
        self.assertEqual(re.search(r"(?m)^version: (.*)$", text_of("CITATION.cff"))[1], VERSION)

    def test_packages_take_theirs_from_the_project(self):
        self.assertIn("set(package_version ${PROJECT_VERSION})", text_of("cmake/gatefly_package.cmake"))

    def test_the_changelog_has_released_it_or_announces_it(self):
        log = text_of("CHANGELOG.md")
        unreleased = re.search(r"(?s)^## \[Unreleased\]\n(.*?)(?=^## \[)", log, re.M)[1]
        self.assertTrue(f"## [{VERSION}]" in log or f"Becomes {VERSION} at the tag." in unreleased)
        self.assertLessEqual(unreleased.count("\n"), 40)

    def test_pages_name_this_one(self):
        major_minor = VERSION.rpartition(".")[0]
        self.assertIn(f"find_package(gatefly {major_minor} REQUIRED", text_of("docs/installing.md"))
        self.assertIn(f"gatefly {VERSION}:", text_of("docs/your_drone.md"))

    def test_a_tag_of_this_commit_is_its_name(self):
        tags = subprocess.run(["git", "-C", ROOT, "tag", "--points-at", "HEAD"], capture_output=True, text=True, check=False)
        versions = [tag for tag in tags.stdout.split() if re.fullmatch(r"v?\d+\.\d+\.\d+", tag)]
        self.assertLessEqual({tag.removeprefix("v") for tag in versions}, {VERSION})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
