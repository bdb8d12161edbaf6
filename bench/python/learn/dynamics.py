"""The part of docs/notes/benchmark.md about the tasks with dynamics: scripts, from bench/results/dynamics.json of dynamics_success.py, and
policies trained by PPO, from bench/results/dynamics-ppo.json.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .page import compared, difference_cell, minutes, rate_cell, recipes, table
from .recipe import CONDITIONS, TRAINING_SEED

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


def with_script(trained: Scripted, scripted: Scripted) -> Scripted:
    """Evaluations of PPO on a task, by condition, together with the script with touch, `script`."""
    return {c: {**trained[c], "script": scripted[c]["shear"]} for c in CONDITIONS}


REPEATED = (
    "Trainings with other seeds, evaluated in the same episodes. The lines above state only what all trainings of a task show; intervals "
    "cover the draw of episodes, not that of the training:"
)

OPPONENTS = {"script": "the script with touch", "normal": "PPO without shear", "blind": "blind PPO"}
"""What PPO with touch is compared with."""


def trained_differences(trained: Mapping[str, Scripted], scripted: Mapping[str, Scripted]) -> str:
    """Paired differences of PPO with touch from the script with touch and from the two other policies."""
    rows = []
    for task, results in trained.items():
        pairs = with_script(results, scripted[task])
        for other, name in OPPONENTS.items():
            rows.append(
                [f"`{task}`", f"PPO with touch - {name}", *(difference_cell(compared(pairs[c], "shear", other)) for c in CONDITIONS)]
            )
    return table(["task", "difference", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def trained_findings(trainings: Mapping[str, Sequence[Scripted]], scripted: Mapping[str, Scripted]) -> str:
    """Under which conditions PPO with touch beats the script and the other policies, and under which it loses to them; a line per task.

    trainings: evaluations by task, of each training. Only what all trainings of a task show is stated.
    """
    lines = []
    for task, repeated in trainings.items():
        pairs = [with_script(results, scripted[task]) for results in repeated]
        parts = []
        for other, name in OPPONENTS.items():
            found = {c: [compared(pair[c], "shear", other) for pair in pairs] for c in CONDITIONS}
            better = ", ".join(f"`{c}`" for c in CONDITIONS if all(one.low > 0 for one in found[c]))
            worse = ", ".join(f"`{c}`" for c in CONDITIONS if all(one.high < 0 for one in found[c]))
            parts += [f"better than {name} under {better}"] * bool(better) + [f"worse than {name} under {worse}"] * bool(worse)
            if not better and not worse:
                parts.append(f"not shown to differ from {name}")
        both = "" if len(repeated) == 1 else f" in each of {len(repeated)} trainings"
        lines.append(f"- `{task}`: PPO with touch is{both} {'; '.join(parts)}.")
    return "\n".join(lines)


def repeated_rates(trained: Mapping[str, Any]) -> str:
    """Success rates of all trainings of the tasks that were trained more than once, by seed."""
    rows = [
        [f"`{task}`", SCRIPTS[sense], str(seed), *(rate_cell(evaluations[condition][sense]) for condition in CONDITIONS)]
        for task, results in trained.items()
        if results.get("repetitions")
        for sense in SCRIPTS
        for seed, evaluations in evaluations_by_seed(results).items()
    ]
    return table(["task", "policy, PPO", "seed", *(f"`{condition}`" for condition in CONDITIONS)], rows) if rows else ""


def evaluations_by_seed(results: Mapping[str, Any]) -> dict[int, Scripted]:
    """Evaluations of a task by the seed of the training; that of all tasks is first."""
    repeated = {int(seed): one["evaluations"] for seed, one in results.get("repetitions", {}).items()}
    return {TRAINING_SEED: results["evaluations"], **repeated}


def trained_parts(trained: Mapping[str, Any], scripted: Mapping[str, Scripted], notes: str) -> list[str]:
    """Paragraphs and tables about the policies of `trained`, by task, as in bench/results/dynamics-ppo.json."""
    evaluations = {task: results["evaluations"] for task, results in trained.items()}
    tasks = ", ".join(f"`{task}`" for task in trained)
    rows = [
        [f"`{task}`", f"PPO {SCRIPTS[sense]}" if sense != "blind" else "blind PPO", f"{training['steps']:,}", minutes(training)]
        for task, results in trained.items()
        for sense, training in results["trainings"].items()
    ]
    return [
        "### PPO",
        f"{tasks}: PPO of Stable-Baselines3 from random weights, under `randomized`, with the rewards of the environments. A policy gets "
        "what a script gets: contact, shear, joints, goal, the first frame of the episode and the number of the step; it has no memory. "
        "Inputs are scaled by mean and deviation in training. The same episodes as of the scripts; seed of training 102. Success of the "
        "mean action in %, with 95 % Wilson intervals:",
        rates(evaluations, "policy, PPO"),
        trained_findings({task: list(evaluations_by_seed(results).values()) for task, results in trained.items()}, scripted),
        *([REPEATED, repeated] if (repeated := repeated_rates(trained)) else []),
        f"Paired differences of the trainings with seed {TRAINING_SEED}, in points of %; bold where the interval excludes 0:",
        trained_differences(evaluations, scripted),
        table(["task", "policy", "environment steps", "minutes of processor time"], rows),
        "Settings:",
        recipes(trained),
        " ".join(
            f"`{task}`: commit {results['commit']}, Torch {results['versions']['torch']}, Stable-Baselines3 "
            f"{results['versions']['stable_baselines3']}."
            for task, results in trained.items()
        ),
        notes.strip(),
    ]


def section(result: Mapping[str, Any], notes: str, trained: Mapping[str, Any] | None = None, trained_notes: str = "") -> str:
    """The section, with tables and notes. trained: results of PPO by task, if there are any."""
    evaluations, machine = result["evaluations"], result["machine"]
    device = f"{machine['driver']}, {machine['cores']} cores of {machine['cpu']}"
    parts = [
        "## Tasks with dynamics",
        "`Push`, `Roll`, `GraspHold` and `PegInsert` ([Tasks with dynamics](../reference/tasks.md#tasks-with-dynamics)): MuJoCo moves the bodies, and scripts act. "
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
