#!/usr/bin/env python3
"""Kills commands that write files, and compares the files with those of undisturbed runs.

    kill_commands.py TAXELSIM [--kills N] [--seed S] [--export-python PYTHON] [--only KIND ...]

Kinds in turn: `generate` by one and by two processes, a part of `evaluate` by two, `characterize` with a report, `experiment` with figures,
and with --export-python each format of `export` (a Python with the package taxelsim and what the formats need). SIGKILL, SIGTERM or SIGINT
end the command at a random time. After each signal a file with its final name has the bytes of the undisturbed run or is missing; the list
of checksums has lines of that run. Then the command runs again, until it survives, and all files must be equal. Neither the times nor the
load of the machine decide whether it passes.
"""

import argparse
import collections
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from balls_scene import ROOT, balls_scene
from kill_workers import SIGNALS, STOPPED, TIMEOUT

SCENES = ROOT / "scenes"
TASK = f"""format_version: 1
name: small
kind: servo
sensor: {SCENES}/sensors/wts0614_soft_cover.yaml
objects: [{{cylinder: {{radius_mm: 5, length_mm: 100}}, orientation: {{rpy_deg: [90, 0, 0]}}, edge: [0, 0, 1]}}]
episode: {{num_steps: 60}}
randomization: {{yaw_deg: [-40, 40], load: [1, 3]}}
controllers: [{{name: fast, tactile_servo: {{edge_angle: {{reference_deg: 90, kp: 10}}, max_angular_velocity: 20}}}}]
task: {{edge_angle: {{reference_deg: 90, tolerance_deg: 3}}, hold: 0.1}}
data_set: {{episodes: 40, seed: 3}}
"""
EXPERIMENT = f"""format_version: 1
name: small
experiment: static
reference: {SCENES}/sensors/wts0614_soft_cover.yaml
sensors: [{{sensor: {SCENES}/sensors/wts0614_soft_cover.yaml}}]
objects: [{{name: ball, sphere: {{radius_mm: 10}}}}, {{name: bar, box: {{size_mm: [5, 30, 20]}}}}]
yaw_deg: [0, 45]
loads: [1, 2, 4]
"""
MEASUREMENTS = [str(SCENES / "measurements" / f"{name}.yaml") for name in ("force_depth", "step_response")]
FORMATS = {"lerobot": [], "zarr": [], "oxt": [], "mcap": [], "robomimic": ["--next-observations"]}


def files_of(path):
    """Bytes of the files with their final names, by their path: not temporary ones, claims and exports that are incomplete."""
    files = {}
    for file in sorted(path.rglob("*")):
        names = file.relative_to(path).parts
        if file.is_file() and not any(name.startswith(".") or name.endswith(".incomplete") for name in names):
            files["/".join(names)] = file.read_bytes()
    return files


def is_part_of(file, content, whole):
    """Whether a file after a signal is whole. A run that ends by itself lists the shards that it has made: this list may have fewer lines."""
    if file.endswith("dataset.checksums"):
        return set(content.splitlines(keepends=True)) <= set(whole.splitlines(keepends=True))
    return content == whole


def commands(program, python, folder):
    """Words of the command of each kind, for an output folder."""
    (folder / "scene.yaml").write_text(balls_scene(24, 2, "tactile_image, ground_truth"))
    (folder / "task.yaml").write_text(TASK)
    (folder / "experiment.yaml").write_text(EXPERIMENT)
    fit = [program, "characterize", *MEASUREMENTS]
    kinds = {
        "generate": lambda out: [program, "generate", folder / "scene.yaml", "-o", out / "data", "--batch-size", "2"],
        "processes": lambda out: [program, "generate", folder / "scene.yaml", "-o", out / "data", "--batch-size", "2", "--processes", "2"],
        "evaluate": lambda out: [program, "evaluate", folder / "task.yaml", "-o", out / "parts", "--part", "2/3", "--processes", "2"],
        "characterize": lambda out: [*fit, "-o", out / "sensor.yaml", "--report", out / "report.html"],
        "experiment": lambda out: [program, "experiment", folder / "experiment.yaml", "-o", out / "figures"],
    }
    if python:
        data = folder / "data"
        subprocess.run([program, "generate", SCENES / "edge_servo.yaml", "--episodes", "3", "-o", data], check=True, capture_output=True)
        export = [python, "-m", "taxelsim", "export", data, "--format"]
        for name, options in FORMATS.items():
            kinds[f"export {name}"] = lambda out, words=(name, *options): [*export, *words, "-o", out / "export.hdf5"]
    return kinds


class Campaign:
    def __init__(self, folder, seed):
        self.folder = folder
        self.random = random.Random(seed)
        self.kills = collections.Counter()  # by name of the signal, of processes that were alive
        self.midway = 0  # of these, ended by the signal
        self.num_outputs = 0  # of commands that ran to their end

    def start(self, command, out):
        out.mkdir(exist_ok=True)
        return subprocess.Popen([str(word) for word in command(out)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def wait(self, process, allowed):
        _, errors = process.communicate(timeout=TIMEOUT)
        assert process.returncode in allowed, f"status {process.returncode}: {errors}"
        return process.returncode

    def run(self, name, command, num_kills):
        """A round for one kind of command."""
        expected_folder, number = self.folder / f"{name} undisturbed", 0
        begin = time.monotonic()
        self.wait(self.start(command, expected_folder), {0})
        lifetime = time.monotonic() - begin
        expected = files_of(expected_folder)
        assert expected
        left = num_kills
        while left > 0:
            out = self.folder / f"{name} {number}"
            number += 1
            survives = False
            while not survives:
                process = self.start(command, out)
                chosen = None
                if left > 0:
                    time.sleep(self.random.uniform(0, lifetime))
                    chosen = self.random.choice(SIGNALS)
                    if process.poll() is None:
                        process.send_signal(chosen)
                        self.kills[chosen.name] += 1
                        left -= 1
                status = self.wait(process, {0, STOPPED, -chosen} if chosen else {0})
                self.midway += status != 0
                for file, content in files_of(out).items():
                    assert is_part_of(file, content, expected[file]), f"{out / file} differs after {self.kills}"
                survives = status == 0 or files_of(out) == expected  # ended between its last file and its end
            assert files_of(out) == expected, f"{name}: files are missing at the end"
            self.num_outputs += 1


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=5, help="over all kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--export-python", default="")
    parser.add_argument("--only", nargs="+", metavar="KIND", help='some kinds alone, for example "export mcap"; default: all')
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        folder = pathlib.Path(directory)
        kinds = commands(options.program.resolve(), options.export_python, folder)
        kinds = {name: kinds[name] for name in options.only or kinds}
        campaign = Campaign(folder, options.seed)
        for number, (name, command) in enumerate(kinds.items()):
            before = campaign.kills.total()
            campaign.run(name, command, (options.kills * (number + 1)) // len(kinds) - (options.kills * number) // len(kinds))
            print(f"{name}: {campaign.kills.total() - before} signals", flush=True)
    counts = ", ".join(f"{count} {name}" for name, count in sorted(campaign.kills.items()))
    print(f"{campaign.kills.total()} signals ({counts}), {campaign.midway} ended a process")
    print(f"{campaign.num_outputs} outputs: the bytes of undisturbed runs")


if __name__ == "__main__":
    sys.exit(main())
