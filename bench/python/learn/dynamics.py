"""The part of docs/benchmark.md about the tasks with dynamics, from bench/results/dynamics.json of dynamics_success.py."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .page import compared, difference_cell, rate_cell, table
from .recipe import CONDITIONS

SCRIPTS = {"shear": "with touch", "normal": "without shear", "blind": "blind"}
"""Names of the scripts, by what they sense."""

Scripted = Mapping[str, Mapping[str, Mapping[str, Any]]]  # by condition and sense


def rates(evaluations: Mapping[str, Scripted]) -> str:
    """Success rates, tasks and scripts x conditions. evaluations: by task."""
    rows = [
        [f"`{task}`", name, *(rate_cell(results[condition][sense]) for condition in CONDITIONS)]
        for task, results in evaluations.items()
        for sense, name in SCRIPTS.items()
    ]
    return table(["task", "script", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def differences(evaluations: Mapping[str, Scripted]) -> str:
    """Paired differences of the script with touch from the two others."""
    rows = [
        [f"`{task}`", f"with touch - {SCRIPTS[sense]}", *(difference_cell(compared(results[c], "shear", sense)) for c in CONDITIONS)]
        for task, results in evaluations.items()
        for sense in ("normal", "blind")
    ]
    return table(["task", "difference", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def section(result: Mapping[str, Any], notes: str) -> str:
    """The section, with tables and `notes`."""
    evaluations, machine = result["evaluations"], result["machine"]
    device = f"{machine['driver']}, {machine['cores']} cores of {machine['cpu']}"
    parts = [
        "## Tasks with dynamics",
        "`Push`, `Roll`, `GraspHold` and `PegInsert` ([tasks.md](tasks.md#tasks-with-dynamics)): MuJoCo moves the bodies, and scripts act. "
        '"Without shear": the same script without the shear force; "blind": the same script with assumptions in place of all readings. '
        "No policy was trained on these tasks.",
        f"{result['episodes']:,} episodes per cell, seed {result['seed']}. Success in %, with 95 % Wilson intervals:",
        rates(evaluations),
        "Paired differences over the same episodes, in points of %, with 95 % intervals; bold where the interval excludes 0:",
        differences(evaluations),
        f"taxelsim {machine['taxelsim']}, commit {result['commit']}; MuJoCo {result['mujoco']}; {device}.",
    ]
    return "\n\n".join(part for part in [*parts, notes.strip()] if part)
