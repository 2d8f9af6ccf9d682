#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly campaign on Slurm: its job scripts, run here by a stand-in for sbatch that runs them at once.

usage: slurm_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import os
import shutil

from program import ROOT, Cli, main

class Slurm(Cli):
    FLIGHTS = ("campaign", "oval", "--vision", "ideal", "--laps", "1", "--runs", "5", "--first-seed", "11")

    def setUp(self):
        super().setUp()
        programs = self.folder / "bin"
        programs.mkdir()
        shutil.copy(ROOT / "tests" / "support" / "sbatch", programs)
        self.slurm = {"PATH": f"{programs}:{os.environ['PATH']}", "SBATCH_LOG": str(self.folder / "sbatch.log")}

    def answer(self, *arguments, **variables):
        result = self.run_it(*arguments, **{**self.slurm, **variables})
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def results(self, out):
        return [(self.folder / out / name).read_bytes() for name in ("runs.csv", "campaign.json")]

    def test_two_shards_merge_to_what_one_machine_gives(self):
        said = self.answer(*self.FLIGHTS, "--slurm", "2", "--out", "out/it's big")
        self.assertIn("2 shards of 5 runs as job", said)
        self.answer(*self.FLIGHTS, "--out", "whole")
        self.assertEqual(self.results("out/it's big"), self.results("whole"))
        log = (self.folder / "sbatch.log").read_text()
        self.assertIn("--dependency=afterany:", log)

    def test_what_is_missing_is_submitted_again(self):
        self.answer(*self.FLIGHTS, "--slurm", "3", "--out", "big", SBATCH_SKIPS="2")
        self.assertFalse((self.folder / "big").exists())
        self.assertIn("2of3", (self.folder / "sbatch.log").read_text())  # the merge says which
        said = self.answer("campaign", "--resume", "big")
        self.assertIn("1 of 3 shards as job", said)
        self.assertIn("--array=2 ", (self.folder / "sbatch.log").read_text())
        self.answer(*self.FLIGHTS, "--out", "whole")
        self.assertEqual(self.results("big"), self.results("whole"))
        submitted = (self.folder / "sbatch.log").read_bytes()
        self.assertIn("5 runs", self.answer("campaign", "--resume", "big"))  # whole: merged here, nothing submitted
        self.assertEqual((self.folder / "sbatch.log").read_bytes(), submitted)

    def test_wrong_uses_submit_nothing(self):
        self.assertIn("sbatch", self.refused(*self.FLIGHTS, "--slurm", "2", PATH="/nonexistent"))
        for wrong in (("--slurm", "6"), ("--slurm", "0"), ("--slurm", "2", "--shard", "1/2")):
            self.assertIn("--slurm", self.refused(*self.FLIGHTS, *wrong, **self.slurm))
        self.assertIn("no_such", self.refused("campaign", "no_such", "--runs", "2", "--slurm", "2", **self.slurm))
        self.assertIn("slurm.json", self.refused("campaign", "--resume", "none", **self.slurm))
        self.answer(*self.FLIGHTS, "--slurm", "1", "--out", "big")
        self.assertIn("--resume big", self.refused(*self.FLIGHTS, "--slurm", "1", "--out", "big", **self.slurm))
        (self.folder / "big.slurm" / "slurm.json").write_text('{"shards": "many"}')
        self.assertIn("shards", self.refused("campaign", "--resume", "big", **self.slurm))


if __name__ == "__main__":
    main()
