#!/usr/bin/env python3
"""The program bench/law_cost: its cases have limits below their times.

law_cost_program_test.py PROGRAM [TEST ...]
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = None
SMALL = ["--only", "winkler", "--repetitions", "1", "--instances", "16"]


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=240, check=False)


class Limits(unittest.TestCase):
    def run_with(self, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "law_cost.json"
            done = run(*SMALL, *arguments, "--json", file)
            self.assertEqual(done.returncode, 0, done)
            return done.stdout, json.loads(file.read_text())

    def test_no_frame_is_faster_than_its_limit(self):
        output, results = self.run_with()
        self.assertEqual(len(re.findall(r"limit +[\d.]+ us of (?:bytes|operations), +limit / time +[\d.]+ %", output)), 2, output)
        self.assertEqual(results["bandwidth_bytes_per_second"], 33e9)
        self.assertEqual(results["arithmetic_operations_per_second"], 225e9)
        for item in results["objects"]:
            (case,) = item["cases"]
            limit, seconds = case["limit_seconds_per_frame"], case["seconds"]["min"] / results["num_instances"]
            self.assertGreater(limit, 0)
            self.assertLess(limit, seconds)
            self.assertAlmostEqual(case["limit_over_time"], limit / (case["seconds"]["median"] / results["num_instances"]), places=9)
            by_hand = sum(max(w["bytes"] / 33e9, w["operations"] / 225e9) for w in case["work_per_frame"].values())
            self.assertAlmostEqual(limit / by_hand, 1, places=9)
            self.assertGreater(case["counts_per_frame"]["touched_samples"], 0)

    def test_rates_are_those_of_the_machine(self):
        _, usual = self.run_with()
        output, slow = self.run_with("--bandwidth", 1e-3, "--arithmetic", 225)
        self.assertIn("us of bytes", output)
        for a, b in zip(usual["objects"], slow["objects"], strict=True):
            (first,), (second,) = a["cases"], b["cases"]
            self.assertEqual(first["work_per_frame"], second["work_per_frame"])
            self.assertGreater(second["limit_seconds_per_frame"], first["limit_seconds_per_frame"])

    def test_rates_must_be_positive(self):
        for name in ("--bandwidth", "--arithmetic"):
            done = run(*SMALL, name, 0)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(name, done.stderr)


if __name__ == "__main__":
    PROGRAM = sys.argv[1]
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
