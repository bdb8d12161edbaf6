#!/usr/bin/env python3
"""The program bench/sweep: rejected input, results, and libraries that it needs.

    sweep_program_test.py PROGRAM READELF [TEST ...]
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = READELF = None
# The Vulkan loader and the C and C++ runtimes. Any other library would have to be copied along.
ALLOWED = re.compile(r"(libvulkan\.so\.1|libstdc\+\+\.so\.6|libgcc_s\.so\.1|lib(c|m)\.so\.6|libpthread\.so\.0|libdl\.so\.2|ld-linux-[\w-]+\.so\.\d)")
SMALL = ["--quick", "--cases", "wts0614_cylinder", "--instances", "4", "--repetitions", "1", "--axes", "contact_repeat,image_team"]


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=240, check=False)


class Libraries(unittest.TestCase):
    def test_needs_only_the_loader_and_runtimes(self):
        output = subprocess.run([READELF, "--dynamic", PROGRAM], capture_output=True, text=True, check=True).stdout
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", output)
        self.assertIn("libc.so.6", needed)
        self.assertEqual([name for name in needed if not ALLOWED.fullmatch(name)], [])
        self.assertNotIn("RUNPATH", output)
        self.assertNotIn("RPATH", output)


class BadInput(unittest.TestCase):
    def assert_rejected(self, part, *arguments):
        done = run(*arguments)
        self.assertEqual(done.returncode, 2, done)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertTrue(done.stderr.startswith("sweep: "), done.stderr)
        self.assertIn(part, done.stderr)

    def test_rejected(self):
        with tempfile.TemporaryDirectory() as folder:
            other = Path(folder) / "other.json"
            self.assert_rejected("wts0614_cylinder", "--cases", "wts0614_cylinder,nothing")
            self.assert_rejected("image_team", "--axes", "nothing")
            self.assert_rejected("--instances", "--instances", "0")
            self.assert_rejected("--repetitions", "--repetitions", "many")
            self.assert_rejected("--nothing", "--nothing")
            self.assert_rejected("nowhere", "--results", Path(folder) / "nowhere")
            self.assert_rejected("excludes", "--results", folder, "--json", other)
            self.assert_rejected("cannot be read", "--compare", other)
            # A file with other content is an error, not a crash.
            for text in ["", "{", "[]", '{"bench": "peers", "cases": []}', '{"bench": "sweep", "cases": {}}', '{"bench": 1}']:
                other.write_text(text)
                self.assert_rejected("not the results of a sweep", "--compare", other)

    def test_no_such_device(self):
        done = run("--device", "none of that name")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no device matches", done.stderr)


class Run(unittest.TestCase):
    def test_results_and_comparison(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second = Path(folder) / "first.json", Path(folder) / "second.json"
            done = run(*SMALL, "--json", first)
            self.assertEqual(done.returncode, 0, done)
            results = json.loads(first.read_text())
            self.assertEqual(results["bench"], "sweep")
            self.assertIn("driver", results["machine"])
            (case,) = results["cases"]
            self.assertEqual((case["case"], case["num_instances"], case["without_force"]), ("wts0614_cylinder", 4, 0))
            self.assertGreater(case["chosen"]["seconds"]["wall"], 0)
            self.assertGreaterEqual(case["gain"], 1)
            self.assertGreaterEqual(len(case["tried"]), 2)
            for tried in case["tried"]:
                self.assertIn("seconds" if "refused" not in tried else "refused", tried)
                self.assertNotIn("differs_in", tried)
            self.assertEqual(set(case["hashes"]), {"num_instances", "inputs", "tactile_image", "floats", "instances"})

            # Compared with the first run; then with a run whose images differ.
            done = run(*SMALL, "--results", folder, "--compare", first)
            self.assertEqual(done.returncode, 0, done)
            self.assertIn("inputs agree, tactile_image agree, floats agree", done.stdout)
            self.assertEqual(len(list(Path(folder).glob("sweep-*.json"))), 1)
            case["hashes"]["tactile_image"] = case["hashes"]["instances"][7] = "0"
            first.write_text(json.dumps(results))
            done = run(*SMALL, "--json", second, "--compare", first)
            self.assertEqual(done.returncode, 0, done)
            self.assertIn("inputs agree, tactile_image DIFFER (1 of 64), floats agree", done.stdout)
            agreement = json.loads(second.read_text())["cases"][0]["agreement"]
            self.assertEqual(agreement, {"inputs": True, "tactile_image": False, "floats": True, "images_that_differ": 1})


if __name__ == "__main__":
    PROGRAM, READELF = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
