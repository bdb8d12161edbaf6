"""Success of the servo and of networks in ONNX files, in the same episodes, under every condition."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import taxelsim
from taxelsim import TASK_MEASURES, Device, Evaluation, Scene
from taxelsim.tasks import TASKS

from .recipe import CONDITIONS, EVALUATION_SEED

SERVO = "servo"  # the first controller of the scene, in results


def scene_of(task: str, condition: str, num_episodes: int) -> Scene:
    """The evaluated episodes."""
    return taxelsim.load_scene(taxelsim.SCENES / TASKS[task].scene, num_episodes=num_episodes, seed=EVALUATION_SEED, condition=condition)


def summary(evaluation: Evaluation) -> dict[str, Any]:
    """Numbers of an evaluation that the page shows, and the successes, one digit per episode."""
    total, verdicts = evaluation.total, evaluation.verdicts
    errors = {name: total.steady_error[m].median for m, name in enumerate(TASK_MEASURES)}
    return {
        "controller": evaluation.controller,
        "num_episodes": total.num_episodes,
        "num_lost": total.num_lost,
        "peak_force": total.peak_force.median,
        "steady_errors": {name: error for name, error in errors.items() if np.isfinite(error)},
        "successes": "".join("01"[int(success)] for success in verdicts["success"]),
    }


def evaluate_all(task: str, policies: dict[str, Path], folder: Path, num_episodes: int) -> dict[str, dict[str, Any]]:
    """Results by condition and policy. Keeps each in a file of `folder`, and reads what is there already."""
    device = Device.open()
    results: dict[str, dict[str, Any]] = {}
    for condition in CONDITIONS:
        scene = scene_of(task, condition, num_episodes)
        results[condition] = {}
        for name in (SERVO, *policies):
            file = folder / f"{name}-{condition}-{num_episodes}.json"
            if not file.exists():
                if name == SERVO:
                    (evaluation,) = taxelsim.evaluate(scene, [scene.controllers[0]], device=device)
                else:
                    (evaluation,) = taxelsim.evaluate(scene, policy=policies[name], device=device)
                print(f"{task} {condition}: {name} {100 * evaluation.total.success_rate:.1f} %", flush=True)
                file.write_text(json.dumps(summary(evaluation)) + "\n")
            results[condition][name] = json.loads(file.read_text())
    return results
