#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""gatefly campaign: many seeds of one course, interrupted and gone on with.

usage: campaign_test.py GATEFLY REPOSITORY_ROOT [unittest arguments]
"""
import csv
import json
import shlex
import signal
import subprocess
import time

from program import GATEFLY, ROOT, Cli, main


class Campaign(Cli):
    FLIGHT = ("--vision", "ideal", "--laps", "1")

    def campaign(self, out, *arguments, runs=6):
        return self.run_it("campaign", "oval", "--runs", runs, *self.FLIGHT, "--out", out, *arguments)

    def results(self, out):
        return [(self.folder / out / name).read_bytes() for name in ("runs.csv", "campaign.json")]

    def test_a_row_for_every_seed_and_their_statistics(self):
        result = self.campaign("all", "--first-seed", "11", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        header, *rows = (self.folder / "all" / "runs.csv").read_text().splitlines()
        self.assertEqual(header, "seed,finished,gates,gates_total,time_s,mean_speed_mps,max_speed_mps,cause,"
                                 "rmse_x_m,rmse_y_m,rmse_z_m,frames,true_positives,false_positives,searches,"
                                 "nees_mean,nees_inside,nis_mean,nis_inside,divergences,why,estimate_cm,guidance_cm,map_cm,"
                                 "detection_cm,since_fix_s,commit,configuration,tilt_error_deg,tilt_sigma_deg,heading_error_deg,"
                                 "heading_sigma_deg,thrust_error_percent,thrust_sigma_percent,latency_error_ms,latency_sigma_ms,"
                                 "map_reports,through_false_gates,through_other_gates")
        cells = [dict(zip(header.split(","), row.split(","))) for row in rows]
        self.assertEqual([cell["seed"] for cell in cells], [str(seed) for seed in range(11, 17)])
        answer = json.loads(result.stdout)
        self.assertEqual(answer, json.loads((self.folder / "all" / "campaign.json").read_text()))
        finished = sum(cell["finished"] == "1" for cell in cells)
        self.assertEqual(answer["result"]["finished"], finished)
        low, high = answer["result"]["completion_wilson95"]
        self.assertLess(low, finished / 6)
        self.assertGreaterEqual(high, finished / 6)
        for cell in cells:  # what fly says of the same seed
            run = json.loads((self.folder / "all" / f"run_{int(cell['seed']):06}.json").read_text())
            self.assertEqual(float(cell["time_s"]), run["race_time_s"])
        alone = json.loads(self.run_it("fly", "oval", *self.FLIGHT, "--seed", "13", "--json").stdout)
        flown = json.loads((self.folder / "all" / "run_000013.json").read_text())
        for summary in (alone, flown):
            del summary["timings"]
        self.assertEqual(alone, flown)

    def test_the_fault_table_has_a_row_for_every_level_and_goes_on(self):
        arguments = ("campaign", "--faults", "--runs", "1", "--first-seed", "1001", "--only", "F6,F7", "--laps", "1", "--out",
                     "faults")
        self.assertEqual(self.run_it(*arguments).returncode, 0)
        text = (self.folder / "faults" / "faults.csv").read_text()
        rows = list(csv.DictReader(text.splitlines()))
        self.assertEqual([row["fault"] for row in rows], ["F0"] + ["F6"] * 5 + ["F7"] * 3)
        self.assertTrue((self.folder / "faults" / "F0-1" / "run_001001.json").is_file())
        self.assertEqual((rows[0]["finished"], rows[0]["met"]), ("1", "met"), "nothing was broken")
        for row in rows:
            self.assertTrue(row["met"].startswith(("met", "not yet: ", "not injected: ")), row)
            ended = sum(int(row[how] or 0) for how in ("finished", "landed", "crashed"))
            self.assertLessEqual(ended, int(row["runs"] or 0), row)
        again = self.run_it(*arguments)
        self.assertEqual((again.returncode, (self.folder / "faults" / "faults.csv").read_text()), (0, text))
        self.assertIn("runs was 1, is 2", self.refused("campaign", "--faults", "--runs", "2", *arguments[4:]))
        self.assertEqual((self.folder / "faults" / "faults.csv").read_text(), text, "what is refused takes nothing away")
        self.assertIn("F99", self.refused("campaign", "--faults", "--only", "F99", "--out", "other"))
        self.assertFalse((self.folder / "other").exists())

    def test_the_number_of_jobs_changes_nothing(self):
        for jobs in ("1", "3"):
            self.assertEqual(self.campaign("jobs" + jobs, "--jobs", jobs).returncode, 0)
        self.assertEqual(self.results("jobs1"), self.results("jobs3"))

    def test_interrupted_or_killed_it_flies_only_what_is_missing(self):
        arguments = ("campaign", "oval", "--runs", "16", "--vision", "ideal", "--jobs", "2", "--quiet", "--out")
        self.assertEqual(self.run_it(*arguments, "whole").returncode, 0)
        for name, sent, code in (("interrupted", signal.SIGINT, 130), ("killed", signal.SIGKILL, -signal.SIGKILL)):
            out = self.folder / name
            process = subprocess.Popen([GATEFLY, *arguments, name], cwd=self.folder, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            deadline = time.monotonic() + 60
            while len(list(out.glob("run_*.json"))) < 4 and time.monotonic() < deadline:
                time.sleep(0.01)
            process.send_signal(sent)
            stdout, stderr = process.communicate(timeout=60)
            self.assertEqual(process.returncode, code, stderr)
            self.assertEqual(stdout, "")
            kept = {path: path.stat().st_mtime_ns for path in out.glob("run_*.json")}
            self.assertGreaterEqual(len(kept), 4)
            self.assertLess(len(kept), 16)
            if sent == signal.SIGINT:
                self.assertIn(f"{len(kept)} of 16 runs kept", stderr)
            self.assertFalse((out / "runs.csv").exists())

            self.assertEqual(self.run_it(*arguments, name).returncode, 0)
            for path, written in kept.items():
                self.assertEqual(path.stat().st_mtime_ns, written, path)
            self.assertEqual(self.results(name), self.results("whole"))
            self.assertEqual(list(out.glob("*.partial")), [])

    def test_a_damaged_run_is_flown_again(self):
        self.assertEqual(self.campaign("hurt").returncode, 0)
        before = self.results("hurt")
        (self.folder / "hurt" / "run_000003.json").write_text('{"seed": 3, "fini', encoding="utf-8")
        self.assertEqual(self.campaign("hurt").returncode, 0)
        self.assertEqual(self.results("hurt"), before)

    def test_shards_together_are_the_whole(self):
        self.assertEqual(self.campaign("whole", runs=7).returncode, 0)
        for shard in ("1", "2", "3"):
            self.assertEqual(self.campaign("part" + shard, "--shard", shard + "/3", runs=7).returncode, 0)
        self.assertEqual(len(list((self.folder / "part2").glob("run_*.json"))), 2)
        self.assertIn("seed 2", self.refused("campaign", "--merge", "part1", "part3", "--out", "merged"))
        result = self.run_it("campaign", "--merge", "part1", "part2", "part3", "--out", "merged")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.results("merged"), self.results("whole"))

    def test_a_campaign_from_before_a_key_was_renamed_goes_on(self):
        setting = ("--set", "sim.outliers_percent=20")
        self.assertEqual(self.campaign("mine", *setting, runs=2).returncode, 0)
        written = self.folder / "mine" / "campaign.json"
        before = json.loads(written.read_text(encoding="utf-8"))
        written.write_text(written.read_text(encoding="utf-8").replace('"outliers_percent"', '"ghosts_percent"'), encoding="utf-8")
        result = self.campaign("mine", "--set", "sim.ghosts_percent=20", runs=2)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("sim.ghosts_percent is the old name of sim.outliers_percent", result.stderr)
        after = json.loads(written.read_text(encoding="utf-8"))
        for key in ("arguments", "result"):
            self.assertEqual(after[key], before[key])

    def test_shards_of_different_campaigns_are_not_merged(self):
        self.assertEqual(self.campaign("one", "--shard", "1/2", runs=2).returncode, 0)
        self.assertEqual(self.campaign("two", "--shard", "2/2", "--set", "control.speed_mps=1.5", runs=2).returncode, 0)
        error = self.refused("campaign", "--merge", "one", "two", "--out", "merged")
        self.assertIn("two", error)
        self.assertIn("config.control.speed_mps", error)

    def test_what_another_commit_flew_is_not_mixed_in(self):
        self.assertEqual(self.campaign("mine", runs=2).returncode, 0)
        written = self.folder / "mine" / "campaign.json"
        mine = json.loads(written.read_text(encoding="utf-8"))
        commit = mine["arguments"]["commit"]
        header, *rows = (self.folder / "mine" / "runs.csv").read_text().splitlines()
        cells = [dict(zip(header.split(","), row.split(","))) for row in rows]
        self.assertEqual({cell["commit"] for cell in cells}, {commit})
        self.assertEqual(len({cell["configuration"] for cell in cells}), 1)
        run = self.folder / "mine" / "run_000002.json"
        whole = run.read_text(encoding="utf-8")
        run.write_text(whole.replace(f'"commit": "{commit}"', '"commit": "0123456789ab"'), encoding="utf-8")
        self.assertIn('run_000002.json: flown by commit "0123456789ab"', self.refused("campaign", "oval", "--runs", "2", *self.FLIGHT, "--out", "mine"))
        run.write_text(whole, encoding="utf-8")
        mine["arguments"]["commit"] = "0123456789ab"
        written.write_text(json.dumps(mine), encoding="utf-8")
        error = self.refused("campaign", "oval", "--runs", "2", *self.FLIGHT, "--out", "mine")
        self.assertIn(f'commit was "0123456789ab", is "{commit}"', error)
        self.assertEqual(self.campaign("part", "--shard", "2/2", runs=2).returncode, 0)
        self.assertIn("commit", self.refused("campaign", "--merge", "part", "mine", "--out", "merged"))

    def test_two_campaigns_are_compared_seed_by_seed(self):
        self.assertEqual(self.campaign("early", "--set", "sim.timeout_s=5", runs=3).returncode, 0)
        result = self.campaign("late", "--first-seed", "2", "--compare", "early", "--json", runs=3)
        self.assertEqual(result.returncode, 0, result.stderr)
        comparison = json.loads(result.stdout)["comparison"]
        self.assertEqual(comparison["pairs"], 2)  # seeds 2 and 3
        self.assertEqual(comparison["unpaired"], 2)
        self.assertEqual((comparison["only_first"], comparison["only_second"]), ([], [2, 3]))
        self.assertAlmostEqual(comparison["mcnemar_p"], 0.5)
        self.assertEqual(comparison["differences"], ["sim.timeout_s: 5.0 | 240.0"])
        stored = json.loads((self.folder / "late" / "campaign.json").read_text())
        self.assertNotIn("comparison", stored)
        self.assertIn('"mcnemar_p":0.5', (self.folder / "late" / "comparison.html").read_text(encoding="utf-8"))
        again = self.run_it("campaign", "--compare", "early", "late")
        page = self.folder / "out" / "compare-early-late"
        self.assertIn(str(page.relative_to(self.folder) / "report.html"), again.stdout)
        self.assertEqual(json.loads((page / "comparison.json").read_text())["only_second"], [2, 3])
        html = (page / "report.html").read_text(encoding="utf-8")
        self.assertIn('"seeds":[{"seed":2', html)
        self.assertNotRegex(html, r'(src|href)="https?:')
        self.assertIn("early", self.refused("campaign", "--compare", "early", "late", "--out", "early"))
        self.assertIn("0 | 2 by one alone", again.stdout)
        self.assertIn("only the second seed 2, 3", again.stdout)
        self.assertEqual(self.campaign("other", "--first-seed", "900", runs=1).returncode, 0)
        self.assertIn("no seed in common", self.refused("campaign", "--compare", "early", "other"))
        self.assertIn("nowhere/campaign.json", self.refused("campaign", "oval", "--runs", "1", "--compare", "nowhere"))
        self.assertIn("--compare", self.refused("campaign", "--compare", "early", "late", "other"))

    def test_a_small_p_has_an_exponent(self):
        self.assertEqual(self.campaign("early", "--set", "sim.timeout_s=5", runs=16).returncode, 0)
        self.assertEqual(self.campaign("late", runs=16).returncode, 0)
        p = json.loads(self.run_it("campaign", "--compare", "early", "late", "--json").stdout)["mcnemar_p"]
        self.assertLess(p, 1e-3)
        self.assertIn(f"p = {p:.1e})", self.run_it("campaign", "--compare", "early", "late").stdout)

    def test_what_races_were_lost_by(self):
        result = self.campaign("blind", "--set", "faults.camera_out_s=[0, 300]", "--set", "randomize.wind_mps=0.5", runs=4)
        self.assertEqual(result.returncode, 0, result.stderr)
        answer = json.loads((self.folder / "blind" / "campaign.json").read_text())["result"]
        self.assertEqual(sum(cause["count"] for cause in answer["lost_by"]), 4 - answer["finished"])
        self.assertIn(" by estimate", result.stdout)
        run = json.loads((self.folder / "blind" / f"run_{answer['lost_by'][0]['seeds'][0]:06}.json").read_text())
        self.assertIn(run["why_lost"]["line"], (self.folder / "blind" / "report.html").read_text(encoding="utf-8"))

    def test_a_folder_with_other_arguments_is_refused(self):
        self.assertEqual(self.campaign("mine", runs=1).returncode, 0)
        error = self.refused("campaign", "oval", "--runs", "2", *self.FLIGHT, "--out", "mine")
        self.assertIn("runs was 1, is 2", error)
        error = self.refused("campaign", "oval", "--runs", "1", *self.FLIGHT, "--out", "mine",
                             "--set", "control.speed_mps=1.5")
        self.assertIn("config.control.speed_mps", error)
        thesis = self.folder / "thesis"
        thesis.mkdir()
        (thesis / "chapter1.tex").write_text("years of work", encoding="utf-8")
        self.assertIn("thesis", self.refused("campaign", "oval", "--runs", "1", *self.FLIGHT, "--out", thesis))

    def test_a_damaged_campaign_is_named(self):
        (self.folder / "bad").mkdir()
        for damage in ("", "[]", '{"arguments": {"runs": "x"}}', '{"arguments": {"runs": 0, "first_seed": 1, "shard": [1, 1]}, "fly": ""}',
                       '{"arguments": {"runs": 2, "first_seed": 1, "shard": [0, 0]}, "fly": ""}', '{"arguments": {"runs": 2, "first_seed": 1, "shard": [1, 1]}, "fly": 7}'):
            self.file("bad/campaign.json", damage)
            self.assertRegex(self.refused("campaign", "--merge", "bad", "--out", "merged"),
                             r"bad/campaign\.json: (is damaged|is \[\]|arguments\.\w+ (=|is missing)|fly =)")

    def test_the_printed_command_flies_the_failed_run_again(self):
        track = self.file("my track.toml", (ROOT / "tracks" / "oval.toml").read_text(encoding="utf-8"))
        result = self.run_it("campaign", track, "--runs", "2", *self.FLIGHT, "--set", "sim.timeout_s=5", "--out", "late")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("2 x timeout (seed 1, 2)", result.stdout)
        (line,) = [line for line in result.stdout.splitlines() if "fly one again" in line]
        program, *arguments = shlex.split(line.split("again", 1)[1])
        self.assertEqual(program, "gatefly")
        again = self.run_it(*arguments, "--json")
        self.assertEqual(again.returncode, 1, again.stderr)
        summaries = [json.loads(again.stdout), json.loads((self.folder / "late" / "run_000001.json").read_text())]
        for summary in summaries:
            del summary["timings"]
        self.assertEqual(summaries[0], summaries[1])

    def test_unusable_arguments(self):
        self.assertIn("--runs", self.refused("campaign", "oval"))
        self.assertIn("--runs", self.refused("campaign", "oval", "--runs", "0"))
        self.assertIn("--first-seed", self.refused("campaign", "oval", "--runs", "1", "--first-seed", "-1"))
        self.assertIn("--shard x", self.refused("campaign", "oval", "--shard", "x"))
        for shard in ("3/2", "0/2", "1", "1/2/3", "a/b", "-1/2"):
            self.assertIn("--shard", self.refused("campaign", "oval", "--runs", "2", "--shard", shard))
        self.assertIn("--out", self.refused("campaign", "--merge", "a", "b"))
        self.assertIn("campaign.json", self.refused("campaign", "--merge", "a", "b", "--out", "c"))


if __name__ == "__main__":
    main()
