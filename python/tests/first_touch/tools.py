"""Files and commands that several tests share."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.program import PROGRAM

ROOT = Path(__file__).resolve().parents[3]
FORMAT_1 = ROOT / "tests/dataset/data/format_1"
THIS_PYTHON = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}  # as python3

SERVO = """
format_version: 1
name: servo
sensor: SENSOR
kind: servo
objects: [sphere: {radius_mm: 10}]
episode: {num_steps: 3, simulation_rate: 100}
randomization: {START}
controller: {tactile_servo: {total_force: {kp: 1}}}
task: {total_force: {tolerance: 1}}
record: [RECORD]
data_set: {episodes: 3, episodes_per_shard: 2}
"""


def servo(folder: Path, start: str, record: str = "features", sensor: str = "sensors/wts0614_soft_cover.yaml") -> Path:
    text = SERVO.replace("SENSOR", str(taxelsim.SCENES / sensor)).replace("START", start).replace("RECORD", record)
    (folder / "servo.yaml").write_text(text)
    return folder / "servo.yaml"


def write_cube(file: Path, size: float) -> Path:
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in itertools.product((0, size), repeat=3))
    file.write_text(corners + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
    return file


def press(file: Path, sensor: str = "wts0614") -> subprocess.CompletedProcess[str]:
    command = [PROGRAM, "frame", "--sensor", taxelsim.SCENES / f"sensors/{sensor}.yaml", "--object", file, "--load", "1"]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)
