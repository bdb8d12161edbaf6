"""What documents and reports say."""

import json
import re
import subprocess
from pathlib import Path

import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.program import PROGRAM

from .tools import ROOT, servo

# == Cross-validation compares what can be compared ==


def test_cross_validation_of_the_shipped_measurements_says_what_it_cannot_compare(tmp_path: Path) -> None:
    files = sorted((ROOT / "scenes/measurements").glob("*.yaml"))
    command = [PROGRAM, "characterize", *files, "-o", tmp_path / "sensor.yaml", "--cross-validate"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True)
    stamps, cycles, *_ = done.stdout.splitlines()
    assert stamps.startswith("left-out loads: this set cannot be cross-validated by stamps: no two loads were pressed at one place")
    assert cycles.startswith("left-out cycles or halves: the fitted sensor predicts better than every baseline")
    assert done.stdout.count("M4, %") == 2  # the tables of the force curves: the medians, and each measurement


# == The benchmark page shows a policy that was trained to its end ==


def test_ppo_of_the_page_is_trained_as_long_as_the_example() -> None:
    found = json.loads((ROOT / "bench/results/learn-EdgeFollow.json").read_text())
    steps = found["recipe"]["num_steps"]
    assert f'"{steps}"' in (ROOT / "examples/train_ppo.py").read_text(), "the default of NUM_STEPS"
    assert f"num_steps: int = {steps:_}\n" in (ROOT / "bench/python/learn/recipe.py").read_text(), "the default of the program"
    assert found["curves"]["ppo"]["points"][-1]["steps"] >= steps
    assert f"| PPO | {found['curves']['ppo']['steps']:,} environment steps |" in (ROOT / "docs/notes/benchmark.md").read_text()


# == inspect says what it verified ==


def test_inspect_says_that_nothing_has_changed(tmp_path):
    command = [PROGRAM, "generate", servo(tmp_path, "load: 1"), "-o", tmp_path / "out", "--episodes", "8"]
    subprocess.run(command, capture_output=True, check=True)
    subprocess.run([PROGRAM, "finish", tmp_path / "out"], capture_output=True, check=True)

    def inspected(*options: str) -> str:
        return subprocess.run([PROGRAM, "inspect", tmp_path / "out", *options], capture_output=True, text=True, check=True).stdout

    sentence = "scene verified; 4 of 4 shards unchanged since they were verified (sizes and times); --verify reads all bytes"
    assert sentence in inspected()
    assert "scene and all bytes of all shards on disk verified" in inspected("--verify")
    (tmp_path / "out/shard-000001.h5").touch()
    assert sentence.replace("4 of", "3 of").replace("times);", "times), all bytes of 1 verified now;") in inspected()


# == Documents run as they are printed ==


@pytest.mark.parametrize(
    ("page", "smaller"),
    [
        ("reference/python.md", {"N = 4096": "N = 8"}),
        ("how_to/environments.md", {"num_envs=4096": "num_envs=2", "num_episodes=100": "num_episodes=2"}),
        ("how_to/own_sensor.md", {}),
    ],
)
def test_blocks_of_a_page_run_as_one_program(page, smaller, monkeypatch, tmp_path):
    text = (ROOT / "docs" / page).read_text()
    monkeypatch.chdir(tmp_path)
    for name, content in re.findall(r"```yaml\n# (\S+)\n(.*?)```", text, re.DOTALL):
        (tmp_path / name).write_text(content)
    program = "\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL))
    for printed, small in smaller.items():
        assert printed in program
        program = program.replace(printed, small)
    names: dict = {}
    exec(compile(program, page, "exec"), names)
    for sensor in (value for value in names.values() if isinstance(value, taxelsim.Sensor)):
        taxelsim.check_sensor(sensor)


def test_folders_of_the_documents_are_ignored_by_git():
    assert {"build/", "venv/"} <= set((ROOT / ".gitignore").read_text().split())
