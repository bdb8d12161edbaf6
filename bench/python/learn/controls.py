"""The part of docs/notes/benchmark.md about controls: PPO with other observations of touch, from bench/results/dynamics-controls.json."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .page import compared, difference_cell, minutes, rate_cell, table
from .recipe import CONDITIONS

POLICIES = {
    "shear": "contact and shear",
    "image": "raw image",
    "center": "centre of pressure",
    "binary": "binary contact",
    "blind": "blind",
}
"""Names of the policies, by what they sense; the first one is compared with the others."""


def _rows(results: Mapping[str, Any], cell: Any) -> list[list[str]]:
    return [
        [f"`{task}`", name, *(cell(one["evaluations"][condition], sense) for condition in CONDITIONS)]
        for task, one in results.items()
        for sense, name in POLICIES.items()
        if sense in one["evaluations"][CONDITIONS[0]]
    ]


def rates(results: Mapping[str, Any]) -> str:
    """Success rates, tasks and policies x conditions."""
    rows = _rows(results, lambda found, sense: rate_cell(found[sense]))
    return table(["task", "PPO with", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def forces(results: Mapping[str, Any]) -> str:
    """Peak and mean normal force, medians over the episodes."""
    rows = _rows(results, lambda found, sense: f"{found[sense]['peak_force']:.2f}, {found[sense]['mean_force']:.2f}")
    return table(["task", "PPO with", *(f"`{condition}`: peak, mean, N" for condition in CONDITIONS)], rows)


def differences(results: Mapping[str, Any]) -> str:
    """Paired differences of the first policy from the others."""
    first, *others = POLICIES
    rows = [
        [
            f"`{task}`",
            f"{POLICIES[first]} - {POLICIES[other]}",
            *(difference_cell(compared(one["evaluations"][condition], first, other)) for condition in CONDITIONS),
        ]
        for task, one in results.items()
        for other in others
    ]
    return table(["task", "difference", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def section(results: Mapping[str, Any], notes: str) -> str:
    """The section, with tables and notes; empty without results."""
    if not results:
        return ""
    one = next(iter(results.values()))
    steps = ", ".join(
        f"`{task}`, {POLICIES[sense]}: {training['steps']:,} in {minutes(training)}"
        for task, found in results.items()
        for sense, training in found["trainings"].items()
    )
    parts = [
        "### Controls",
        "PPO with the settings above, one observation of touch each, in its first frame, its present frame and the change, in addition to "
        'joints, goal and the number of the step: "contact and shear" is "with touch" above, trained again; "raw image" '
        '`tactile_image`; "centre of pressure" `center_of_pressure`; "binary contact" `binary_contact` of the whole array. '
        f"{one['episodes']:,} episodes per cell, seed {one['seed']}; seed of training {one['training_seed']}. "
        "Success of the mean action in %, with 95 % Wilson intervals:",
        rates(results),
        "Paired differences over the same episodes, in points of %, with 95 % intervals; bold where the interval excludes 0:",
        differences(results),
        "Peak and mean true normal force on the sensor, medians over all episodes:",
        forces(results),
        f"Environment steps, and minutes of processor time: {steps}.",
        " ".join(f"`{task}`: commit {found['commit']}." for task, found in results.items()),
        notes.strip(),
    ]
    return "\n\n".join(part for part in parts if part)
