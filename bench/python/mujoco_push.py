#!/usr/bin/env python3
"""Share of the tactile part in the task Push, and MuJoCo's own tactile sensor in the same model: time and peak memory.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/mujoco_push.py --json bench/results/mujoco_push-lavapipe.json

A step is ten time steps of 1 ms of MuJoCo and one frame of every sensor. Each side runs in a process of its own, in turns. taxelsim: 16
samples per taxel, shear, features, counts. MuJoCo: a point per taxel, depth and sliding speed, 0.5 mm in front of the cover, whose
contact is too stiff to be deep.
Time is that of the process on all its threads (CPU) and that of the clock.
"""

from __future__ import annotations

import argparse
import copy
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch
from report import machine, write_json
from tactile_peer import peak_memory, skin_mesh

import taxelsim
from taxelsim.envs.dynamics.push import PushVectorEnv
from taxelsim.envs.dynamics.scripts import Push

GRID = (6, 14, 0.0034)
SUBSTEPS = 10


class Clock:
    """Adds up times by name, (clock, CPU), s."""

    def __init__(self) -> None:
        self.totals: dict[str, list[float]] = {}

    def __call__(self, name: str, function: Any, *arguments: Any, **keywords: Any) -> Any:
        start = time.perf_counter(), time.process_time()
        result = function(*arguments, **keywords)
        total = self.totals.setdefault(name, [0.0, 0.0])
        total[0] += time.perf_counter() - start[0]
        total[1] += time.process_time() - start[1]
        return result


def run_taxelsim(num_envs: int, steps: int) -> dict[str, Any]:
    """The task, driven by its script."""
    envs, script, clock = PushVectorEnv(num_envs), Push("shear"), Clock()
    observation, _ = envs.reset(seed=1)
    observe, step = envs.tactile.observe, envs.batch.step
    counts = np.zeros(num_envs, np.int64)
    for k in range(steps + 5):
        if k == 5:  # after kernels are compiled and the contact has begun
            envs.tactile.observe = lambda *a, **b: clock("tactile", observe, *a, **b)  # type: ignore[method-assign]
            clock.totals.clear()
        action = script(observation, counts + k)
        if k < 5:
            observation, *_ = envs.step(action)
            continue
        envs._targets(action.astype(np.float64) * envs.speeds)
        clock("physics", step, nstep=SUBSTEPS)
        envs._frame = envs.tactile.observe(envs.batch, envs.step_time)["skin"]
        envs._elapsed += 1
        observation = clock("environment", envs._observe)
    if not (envs._frame.ground_truth.total_force > 0).mean() > 0.9:
        sys.exit("less than 90 % of the pads touch their disc")
    return {"times": clock.totals}


def run_mujoco(num_envs: int, steps: int) -> dict[str, Any]:
    """The same model with a tactile sensor, pushed straight ahead."""
    text = PushVectorEnv.model_text(1.73e8)
    text = text.replace('<flag sensor="disable"/>', "").replace(
        "<worldbody>", '<asset><mesh name="s" file="s.obj" inertia="shell"/></asset><worldbody>', 1
    )
    text = text.replace(
        '<geom name="cover"',
        '<geom name="skin" type="mesh" mesh="s" pos="0 0 .0005" contype="0" conaffinity="0" mass="0"/><geom name="cover"',
    )
    text = text.replace("</mujoco>", '<sensor><tactile mesh="s" geom="skin"/></sensor></mujoco>')
    model = mujoco.MjModel.from_xml_string(text, {"s.obj": skin_mesh(*GRID, 1).encode()})
    batch, clock = Batch(model, num_envs), Clock()
    data = batch.bind("sensordata")
    stage = int(model.sensor_needstage[0])
    without = copy.copy(model)
    without.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_SENSOR)
    bare = Batch(without, num_envs)
    for k in range(steps + 5):
        if k == 5:
            clock.totals.clear()
        for each in (batch, bare):
            each.ctrl[:, 0] += 0.0004
        # MuJoCo evaluates sensors in every time step; a caller who wants one frame per control step runs the others without them.
        clock("physics", bare.step, nstep=SUBSTEPS)
        batch.state[:] = bare.state
        clock("tactile", batch.forward, stage=stage)
    if not (data.reshape(num_envs, -1)[:, :84] > 0).any(axis=1).mean() > 0.9:
        sys.exit("less than 90 % of the sensors see their disc")
    return {"times": clock.totals}


def main() -> None:
    """Runs both sides in turns, or one of them in this process."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--envs", type=int, default=1024)
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--side", choices=("taxelsim", "mujoco"), help="run one side and print JSON")
    parser.add_argument("--json", type=Path, help="file of results to write")
    options = parser.parse_args()
    if options.side:
        start = peak_memory()
        found = {"taxelsim": run_taxelsim, "mujoco": run_mujoco}[options.side](options.envs, options.steps)
        print(json.dumps({**found, "memory": peak_memory() - start}))
        return
    results: dict[str, Any] = {**machine(taxelsim.Device.open()), "envs": options.envs, "steps": options.steps, "sides": {}}
    for _ in range(options.turns):
        for side in ("taxelsim", "mujoco"):
            command = [sys.executable, "-B", __file__, "--side", side, "--envs", str(options.envs), "--steps", str(options.steps)]
            ran = subprocess.run(command, capture_output=True, text=True)
            if ran.returncode != 0:
                sys.exit(f"mujoco_push.py: {side}: {ran.stderr.strip()}")
            results["sides"].setdefault(side, []).append(json.loads(ran.stdout))
    for side, runs in results["sides"].items():
        for name in runs[0]["times"]:
            clock, cpu = (np.median([run["times"][name][k] for run in runs]) / options.steps * 1e3 for k in (0, 1))
            shares = [run["times"][name][1] / (run["times"]["physics"][1] + run["times"]["tactile"][1]) for run in runs]
            print(f"{side:10}{name:14}{clock:9.1f} ms, CPU {cpu:9.1f} ms a step; {100 * np.median(shares):5.1f} % of physics and tactile")
        print(f"{side:10}peak memory above the interpreter's {np.median([run['memory'] for run in runs]) / 1e6:.0f} MB", flush=True)
    write_json(options.json, results)


if __name__ == "__main__":
    main()
