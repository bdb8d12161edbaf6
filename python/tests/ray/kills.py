"""Workers and nodes that are killed at random moments: the bytes stay those of one process. Run by `scripts/campaign ray kills`.

TAXELSIM_RAY_KILLS: number of kills, default 500. One in ten kills a node, the others a process that runs a task.
"""

import contextlib
import os
import random
import signal
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

import fsspec
import pytest

import taxelsim
import taxelsim.ray
from taxelsim.ray import tasks

from .conftest import KIND, files_of, replace_node, write_sharded_scene

pytestmark = pytest.mark.filterwarnings("ignore")
NUM_KILLS = int(os.environ.get("TAXELSIM_RAY_KILLS", "500"))
KILLS_PER_NODE = 10
PAUSES = (0.2, 3.0)  # s, between two kills


def running_tasks(raylets: set[int]) -> list[int]:
    """Processes of tasks, children of these raylets."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            name = (folder / "cmdline").read_bytes()
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            if name.startswith(b"ray::make_shards") and parent in raylets:
                found.append(int(folder.name))
    return found


class Killer:
    def __init__(self, cluster: Any, seed: int) -> None:
        self._cluster = cluster
        self._random = random.Random(seed)
        self.num_kills = 0
        self.num_nodes = 0

    def kill_until(self, run: Future[Any]) -> None:
        """In the main thread: Ray starts nodes nowhere else."""
        while not wait([run], timeout=self._random.uniform(*PAUSES)).done:
            if self._random.randrange(KILLS_PER_NODE) == 0:
                self._kill_node()
            else:
                self._kill_task()

    def _kill_node(self) -> None:
        try:
            replace_node(self._cluster, self._random.choice(self._cluster.same).node_id)
        except Exception as error:  # a busy machine starts no raylet within Ray's time limit
            print(f"no new node: {error}")
        self.num_kills += 1
        self.num_nodes += 1

    def _kill_task(self) -> None:
        raylets = {process.process.pid for node in self._cluster.same for process in node.all_processes["raylet"]}
        with contextlib.suppress(ProcessLookupError, IndexError):
            os.kill(self._random.choice(running_tasks(raylets)), signal.SIGKILL)
            self.num_kills += 1


def test_kills(cluster, s3, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(tasks, "FIRST_DELAY", 0.05)
    scene = taxelsim.load_scene(write_sharded_scene(tmp_path, 32, num_frames=200), num_episodes=2000)
    taxelsim.generate(scene, tmp_path / "one")
    expected = files_of(tmp_path / "one")
    files = fsspec.filesystem("s3", skip_instance_cache=True, **s3)
    num_kills = num_nodes = num_retries = num_runs = 0
    while num_kills < NUM_KILLS:
        name = f"set-{num_runs}"
        out = f"s3://bucket/{name}" if num_runs % 2 else str(tmp_path / name)
        killer = Killer(cluster, num_runs)
        with ThreadPoolExecutor(1) as pool:
            run = pool.submit(
                taxelsim.ray.generate,
                scene,
                out,
                workers=taxelsim.ray.Workers(kind=KIND),
                task_seconds=1.0,
                max_retries=1000,
                storage_options=s3 if num_runs % 2 else None,
            )
            killer.kill_until(run)
        summary = run.result()
        files.invalidate_cache()
        stored = {p.rpartition("/")[2]: files.cat_file(p) for p in files.ls(out)} if num_runs % 2 else files_of(tmp_path / name)
        assert stored == expected, f"run {num_runs}"
        num_kills, num_nodes = num_kills + killer.num_kills, num_nodes + killer.num_nodes
        num_retries, num_runs = num_retries + summary.num_retries, num_runs + 1
        with capsys.disabled():
            print(
                f"\n{num_runs} runs, {num_kills} kills, of them {num_nodes} nodes, {num_retries} tasks sent again: equal bytes", flush=True
            )
