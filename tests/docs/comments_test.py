#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/check_comments.py counts the comments that it should, and no others.

usage: comments_test.py REPOSITORY_ROOT [unittest arguments]
"""
import importlib.util
import pathlib
import sys
import unittest

spec = importlib.util.spec_from_file_location("check_comments", pathlib.Path(sys.argv[1]) / "tools" / "check_comments.py")
check = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check)


def counted(text, suffix=".hpp"):
    return [number for number, _ in check.openings(text, suffix)]


class Comments(unittest.TestCase):
    def test_a_block_counts_by_its_first_line(self):
        self.assertEqual(counted("/// What it is.\nint a;\n/// The place\n/// Where it is.\nint b;\n"), [1])

    def test_a_comment_behind_code_counts(self):
        self.assertEqual(counted("int a = 0;  ///< Of the gate [m].\nint b = 0;  ///< Width [m].\n"), [1])

    def test_words_that_only_begin_alike_do_not(self):
        self.assertEqual(counted("// Offset of the gate.\n// Whole gates.\nint a;  ///< Wherefore\n"), [])

    def test_python_has_comments_and_docstrings(self):
        self.assertEqual(counted('# Who asks.\nx = 1  # Of it.\n"""What it does."""\n', ".py"), [1, 2, 3])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
