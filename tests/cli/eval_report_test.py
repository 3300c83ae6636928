#!/usr/bin/env python3
"""binpick eval with oracle and sweep over a sample bin: the account of faults adds up, the curves
begin at the run, and nothing of either reaches the detections. Argument: the binpick program.
Trains one part with few samples."""

import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SAMPLE = Path(__file__).resolve().parents[1] / "data" / "bin-sample"
QUICK = ["--samples", "50", "--calibration-piles", "0"]


class EvalReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.plain = cls.evaluate("plain")
        cls.full = cls.evaluate("full", "--oracle", "--sweep", "missing,centre",
                                "--report", "report")
        cls.json = json.loads((Path(cls.folder.name) / "full.json").read_text())
        cls.page = (Path(cls.folder.name) / "report" / "report.html").read_text()

    @classmethod
    def evaluate(cls, name, *options):
        """The rows that were written, without their times, and what was printed."""
        run = subprocess.run(
            [BINPICK, "eval", str(SAMPLE), "--scenes", "1", "--csv", name + ".csv", "--json",
             name + ".json", "--model-cache", "models", "--threads", "2", *QUICK, *options],
            cwd=cls.folder.name, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr
        with open(Path(cls.folder.name) / (name + ".csv"), encoding="utf-8") as file:
            rows = [row[:6] for row in csv.reader(file)]
        return rows, run.stdout

    def test_the_truth_does_not_reach_the_detections(self):
        self.assertGreater(len(self.plain[0]), 10)
        self.assertEqual(self.plain[0], self.full[0])

    def test_every_target_is_found_or_has_a_cause(self):
        (part,) = self.json["oracle"]
        scored = self.json["parts"][0]
        self.assertEqual(part["targets"], scored["instances"])
        self.assertEqual(part["targets"], part["found"] + sum(part["lost_to"].values()))
        self.assertEqual(len(part["missed"]), sum(part["lost_to"].values()))
        self.assertEqual(len(part["wrong"]), sum(part["false_picks"].values()))
        self.assertAlmostEqual(part["run"]["recall"], part["found"] / part["targets"])
        for missed in part["missed"]:
            self.assertTrue(missed["why"], missed)

    def test_what_is_begun_at_the_truth_is_mostly_found(self):
        (part,) = self.json["oracle"]
        self.assertGreater(part["from_truth"]["recall"], 0.8)
        self.assertGreaterEqual(part["from_truth"]["f1"] + 0.05, part["run"]["f1"])

    def test_curves_begin_at_the_run_and_fall(self):
        sweep = self.json["sweep"]
        for name in ("missing", "centre"):
            (part,) = sweep[name]["parts"]
            self.assertEqual(part["x"][0], 0)
            self.assertEqual(part["y"][0], self.json["parts"][0]["f1"])
            self.assertLess(part["y"][-1], part["y"][0], name)
        self.assertNotIn("noise", sweep)
        self.assertTrue(sweep["visible"]["parts"][0]["y"])
        self.assertTrue(sweep["threshold"]["parts"][0]["y"])

    def test_frames_without_depth_need_a_distance_range(self):
        root = Path(self.folder.name)
        gray = root / "gray"
        shutil.copytree(SAMPLE, gray, ignore=shutil.ignore_patterns("depth", "00000[2-9]"))
        run = subprocess.run(
            [BINPICK, "eval", str(gray), "--scenes", "1", "--csv", "gray.csv", *QUICK],
            cwd=root, capture_output=True, text=True, check=False)
        self.assertIn("give --distance-mm", run.stderr)
        run = subprocess.run(
            [BINPICK, "eval", str(gray), "--scenes", "1", "--csv", "gray.csv", "--distance-mm",
             "600:760", "--tree-depths", "3", "--min-score", "0", *QUICK],
            cwd=root, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(root / "gray.csv", encoding="utf-8") as file:
            depths = [float(row[5].split()[2]) for row in list(csv.reader(file))[1:]]
        self.assertTrue(depths)
        self.assertTrue(all(550 < z < 810 for z in depths), (min(depths), max(depths)))

    def test_reliability_counts_every_pose_once(self):
        parts = {part["name"]: part for part in self.json["reliability"]}
        self.assertEqual(set(parts), {"obj 1", "all"})
        for part in parts.values():
            self.assertEqual(part["count"], len(self.full[0]) - 1)
            self.assertEqual(part["count"], sum(b["count"] for b in part["bins"]))
            self.assertLessEqual(part["calibration_error"], 1)
            low, high = part["accepted"]["interval"]
            self.assertLessEqual(low, part["accepted"]["share"])
            self.assertGreaterEqual(high, part["accepted"]["share"])
            self.assertEqual(part["accepted"]["threshold"], 0.85)
        self.assertIn("calibration error", self.full[1])
        self.assertIn("Reliability of the score", self.page)

    def test_report_and_text_show_it(self):
        for text in ("What is reachable", "Every fault and its cause", "How scores fall"):
            self.assertIn(text, self.page)
        self.assertIn("what is reachable", self.full[1])
        self.assertNotIn("what is reachable", self.plain[1])


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BINPICK = os.path.abspath(sys.argv.pop(1))
    unittest.main()
