# SPDX-License-Identifier: Apache-2.0
"""Helpers of the Python module's tests. Each is run as: X_test.py GATEFLY REPOSITORY_ROOT [unittest arguments],
with the module on PYTHONPATH. Exit code 77, skipped: no numpy for this interpreter."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77
try:
    import numpy  # noqa: F401
except ImportError:
    print(f"python: skipped, no numpy for {sys.executable} (apt-get install python3-numpy)")
    sys.exit(SKIPPED)
import gatefly

GATEFLY, ROOT = (pathlib.Path(path).resolve() for path in sys.argv[1:3]) if len(sys.argv) > 2 else sys.exit(__doc__)
FLIGHT = ROOT / "tests" / "replay" / "oval_flight"
GATES = pathlib.Path(os.environ.get("GATEFLY_DATA", ROOT / "../shared/data")) / "tudelft_bebop_gates"


def has_simulator():
    try:
        gatefly.Race("oval", vision="ideal")
    except gatefly.Error as error:
        if "without the simulator" not in str(error):
            raise
        return False
    return True


needs_simulator = unittest.skipUnless(has_simulator(), "built without the simulator")


class Case(unittest.TestCase):
    def setUp(self):
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job would not hear Ctrl-C
        folder = tempfile.TemporaryDirectory(prefix="gatefly-python-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def program(self, *arguments, codes=(0,)):
        """Output of the program."""
        run = subprocess.run([GATEFLY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=300, check=False)
        self.assertIn(run.returncode, codes, run.stdout + run.stderr)
        return run.stdout

    def program_json(self, *arguments, codes=(0,)):
        return json.loads(self.program(*arguments, "--json", codes=codes))

    def refused(self, kind, call, *arguments, **named):
        """The message, of one line."""
        with self.assertRaises(kind) as caught:
            call(*arguments, **named)
        if kind is gatefly.Error:
            self.assertNotIn("\n", str(caught.exception))
        return str(caught.exception)


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
