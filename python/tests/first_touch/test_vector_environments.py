"""Gymnasium's own vector environments."""

import re
import subprocess
import sys

import gymnasium
import numpy as np
import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco

from .tools import ROOT

GYMNASIUM_TASKS = (
    "EdgeFollow",
    "SurfaceFollow",
    "EdgeAlign",
    "RollTrack",
    "ContourLap",
    "TouchClassify",
    "Push",
    "Roll",
    "GraspHold",
    "PegInsert",
)


@pytest.mark.filterwarnings("ignore:.*A Box observation space:UserWarning")
@pytest.mark.parametrize("task", GYMNASIUM_TASKS)
def test_every_task_in_a_sync_vector_environment(device, task):
    seeds = [1, 2**64 - 1]
    envs = gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=2, vectorization_mode="sync", device=device)
    observations, infos = envs.reset(seed=seeds)
    expected = taxelsim.episode_keys(seeds, 0, 0)
    assert infos["episode_key"].dtype == np.uint64
    assert infos["episode_key"].tolist() == expected.tolist()
    assert envs.observation_space.contains(observations)
    *_, infos = envs.step(np.zeros(envs.action_space.shape, np.float32))
    assert infos["episode_key"].tolist() == expected.tolist()
    envs.close()


WORKERS = """
import gymnasium, numpy as np

if __name__ == "__main__":
    # Gymnasium imports the module that the id names.
    def play(**arguments):
        envs = gymnasium.make_vec("taxelsim.envs:taxelsim/EdgeAlign-v0", num_envs=2, **arguments)
        observations, infos = envs.reset(seed=1)
        observations, rewards, *_ = envs.step(np.full((2, 4), 0.1, np.float32))
        envs.close()
        return observations.tobytes(), rewards.tobytes(), infos["episode_key"].tobytes(), infos["episode_key"].dtype

    expected = play(vectorization_mode="sync")
    for context in ("fork", "spawn"):
        assert play(vectorization_mode="async", vector_kwargs={"context": context}) == expected, context
"""


def test_workers_that_are_forked_and_spawned(tmp_path):
    script = tmp_path / "workers.py"
    script.write_text(WORKERS)
    done = subprocess.run([sys.executable, "-W", "ignore", script], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr


def test_the_entry_point_registers_every_task_and_imports_none():
    text = (ROOT / "pyproject.toml").read_text()
    found = re.search(r'\[project.entry-points."gymnasium.envs"\]\ntaxelsim = "(.*)"', text)
    command = f"""
import sys, gymnasium
from importlib.metadata import EntryPoint
EntryPoint("taxelsim", {found[1]!r}, "gymnasium.envs").load()()
tasks = {{id: spec for id, spec in gymnasium.registry.items() if spec.namespace == "taxelsim"}}
assert sorted(tasks) == sorted(f"taxelsim/{{task}}-v0" for task in {GYMNASIUM_TASKS!r}), tasks
assert all(spec.entry_point and spec.vector_entry_point for spec in tasks.values())
assert "taxelsim.envs" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
