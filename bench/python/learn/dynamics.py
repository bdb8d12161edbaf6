"""The part of docs/benchmark.md about the tasks with dynamics: scripts, from bench/results/dynamics.json of dynamics_success.py, and
policies trained by PPO, from bench/results/dynamics-ppo.json.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .page import compared, difference_cell, minutes, rate_cell, setting_text, table
from .recipe import CONDITIONS

SCRIPTS = {"shear": "with touch", "normal": "without shear", "blind": "blind"}
"""Names of the scripts, by what they sense."""

Scripted = Mapping[str, Mapping[str, Mapping[str, Any]]]  # by condition and sense


def rates(evaluations: Mapping[str, Scripted], kind: str = "script") -> str:
    """Success rates, tasks and scripts x conditions. evaluations: by task. kind: heading of the names."""
    rows = [
        [f"`{task}`", name, *(rate_cell(results[condition][sense]) for condition in CONDITIONS)]
        for task, results in evaluations.items()
        for sense, name in SCRIPTS.items()
    ]
    return table(["task", kind, *(f"`{condition}`" for condition in CONDITIONS)], rows)


def differences(evaluations: Mapping[str, Scripted]) -> str:
    """Paired differences of the script with touch from the two others."""
    rows = [
        [f"`{task}`", f"with touch - {SCRIPTS[sense]}", *(difference_cell(compared(results[c], "shear", sense)) for c in CONDITIONS)]
        for task, results in evaluations.items()
        for sense in ("normal", "blind")
    ]
    return table(["task", "difference", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def trained_differences(trained: Mapping[str, Scripted], scripted: Mapping[str, Scripted]) -> str:
    """Paired differences of PPO with touch from the script with touch and from the two other policies."""
    rows = []
    for task, results in trained.items():
        pairs = {c: {**results[c], "script": scripted[task][c]["shear"]} for c in CONDITIONS}
        for other, name in (("script", "script with touch"), ("normal", "PPO without shear"), ("blind", "blind PPO")):
            rows.append(
                [f"`{task}`", f"PPO with touch - {name}", *(difference_cell(compared(pairs[c], "shear", other)) for c in CONDITIONS)]
            )
    return table(["task", "difference", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def trained_parts(trained: Mapping[str, Any], scripted: Mapping[str, Scripted], notes: str) -> list[str]:
    """Paragraphs and tables about the policies of `trained`, bench/results/dynamics-ppo.json."""
    tasks = " and ".join(f"`{task}`" for task in trained["evaluations"])
    rows = [
        [f"`{task}`", f"PPO {SCRIPTS[sense]}" if sense != "blind" else "blind PPO", f"{training['steps']:,}", minutes(training)]
        for task, trainings in trained["trainings"].items()
        for sense, training in trainings.items()
    ]
    recipes = trained["recipes"]
    settings = ", ".join(f"`{key}` {setting_text(value)}" for key, value in next(iter(recipes.values())).items() if key != "num_steps")
    versions = trained["versions"]
    return [
        "### PPO",
        f"{tasks}: PPO of Stable-Baselines3 from random weights, under `randomized`, with the rewards of the environments. A policy gets "
        "what a script gets: contact, shear, joints, goal, the first frame of the episode and the number of the step; it has no memory. "
        "Inputs are scaled by their mean and deviation in training. The same episodes as of the scripts; seed of training 102. Success of "
        "the mean action in %, with 95 % Wilson intervals:",
        rates(trained["evaluations"], "policy, PPO"),
        trained_differences(trained["evaluations"], scripted),
        table(["task", "policy", "environment steps", "minutes of training; of processor time"], rows),
        f"Settings: {settings}. Commit {trained['commit']}; Torch {versions['torch']}, Stable-Baselines3 {versions['stable_baselines3']}.",
        notes.strip(),
    ]


def section(result: Mapping[str, Any], notes: str, trained: Mapping[str, Any] | None = None, trained_notes: str = "") -> str:
    """The section, with tables and notes. trained: results of PPO, if there are any."""
    evaluations, machine = result["evaluations"], result["machine"]
    device = f"{machine['driver']}, {machine['cores']} cores of {machine['cpu']}"
    parts = [
        "## Tasks with dynamics",
        "`Push`, `Roll`, `GraspHold` and `PegInsert` ([tasks.md](tasks.md#tasks-with-dynamics)): MuJoCo moves the bodies, and scripts act. "
        '"Without shear": the same script without the shear force; "blind": the same script with assumptions in place of all readings. '
        f"{'PPO is below.' if trained else 'No policy was trained on these tasks.'}",
        f"{result['episodes']:,} episodes per cell, seed {result['seed']}. Success in %, with 95 % Wilson intervals:",
        rates(evaluations),
        "Paired differences over the same episodes, in points of %, with 95 % intervals; bold where the interval excludes 0:",
        differences(evaluations),
        f"taxelsim {machine['taxelsim']}, commit {result['commit']}; MuJoCo {result['mujoco']}; {device}.",
    ]
    parts.append(notes.strip())
    if trained:
        parts += trained_parts(trained, evaluations, trained_notes)
    return "\n\n".join(part for part in parts if part)
