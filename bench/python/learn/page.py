"""docs/notes/benchmark.md from the result files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from taxelsim.policies import Comparison, compare, wilson_interval

from .recipe import CONDITIONS, CONTROLS, EVALUATION_SEED, HISTORY, TRAINING_CONDITION

POLICIES = {
    "servo": "scripted servo",
    "clone": "behaviour cloning",
    "ppo": "PPO",
    "image": "PPO, raw image",
    "center": "PPO, centre of pressure",
    "binary": "PPO, binary contact",
    "blind": "blind PPO",
}
LEARNED = ("clone", "ppo")
UNITS = {"edge_angle": ("deg", 180 / np.pi), "total_force": ("N", 1.0), "center": ("mm", 1e3), "contour": ("mm", 1e3)}

Evaluations = Mapping[str, Mapping[str, Mapping[str, Any]]]  # by condition and policy


def successes_of(result: Mapping[str, Any]) -> np.ndarray:
    """(num_episodes) bool."""
    return np.array([digit == "1" for digit in result["successes"]])


def rate_cell(result: Mapping[str, Any]) -> str:
    """Success rate in % with its 95 % Wilson interval."""
    successes = successes_of(result)
    low, high = wilson_interval(int(successes.sum()), len(successes))
    return f"{100 * successes.mean():.1f} ({100 * low:.1f} to {100 * high:.1f})"


def compared(results: Mapping[str, Mapping[str, Any]], name: str, control: str) -> Comparison:
    """Paired comparison of two policies in the same episodes."""
    return compare(name, successes_of(results[name]), control, successes_of(results[control]))


def difference_cell(comparison: Comparison) -> str:
    """Difference of two success rates in points of %, with its 95 % interval; bold where the interval excludes 0."""
    cell = f"{100 * comparison.difference:+.1f} ({100 * comparison.low:+.1f} to {100 * comparison.high:+.1f})"
    return f"**{cell}**" if comparison.low > 0 or comparison.high < 0 else cell


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def rates(evaluations: Evaluations) -> str:
    """Success rates, policies x conditions."""
    names = [name for name in POLICIES if name in evaluations[CONDITIONS[0]]]
    rows = [[POLICIES[name], *(rate_cell(evaluations[condition][name]) for condition in CONDITIONS)] for name in names]
    return table(["policy", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def differences(evaluations: Evaluations) -> str:
    """Paired differences: each policy from the servo, the learned ones from the blind one."""
    names = evaluations[CONDITIONS[0]]
    pairs = [(name, "servo") for name in POLICIES if name in names and name != "servo"]
    pairs += [(name, "blind") for name in LEARNED if name in names and "blind" in names]
    pairs += [("ppo", name) for name in CONTROLS if name in names]
    rows = [
        [
            f"{POLICIES[name]} - {POLICIES[control]}",
            *(difference_cell(compared(evaluations[condition], name, control)) for condition in CONDITIONS),
        ]
        for name, control in pairs
    ]
    return table(["difference", *(f"`{condition}`" for condition in CONDITIONS)], rows)


def measures(evaluations: Evaluations) -> str:
    """Median errors, peak forces and losses of contact."""
    kinds = [m for m in UNITS if any(m in result["steady_errors"] for result in evaluations[CONDITIONS[0]].values())]
    rows = []
    for condition in CONDITIONS:
        for name, result in evaluations[condition].items():
            errors = result["steady_errors"]
            cells = [f"{errors[m] * UNITS[m][1]:.2f}" if m in errors else "-" for m in kinds]
            peak = result["peak_force"]
            rows.append([f"`{condition}`", POLICIES[name], *cells, f"{peak:.1f}", f"{result['num_lost']:,}"])
    head = ["condition", "policy", *(f"{m.replace('_', ' ')}, {UNITS[m][0]}" for m in kinds), "peak force, N", "lost contact"]
    return table(head, rows)


def findings(task: str, evaluations: Evaluations) -> list[str]:
    """Whether a learned policy beats the blind one and the servo."""
    lines = []
    for control, condition in (("blind", TRAINING_CONDITION), ("blind", "unseen"), ("servo", "unseen"), ("servo", TRAINING_CONDITION)):
        results = evaluations[condition]
        if control not in results:
            continue
        better = [name for name in LEARNED if name in results and compared(results, name, control).low > 0]
        names = " and ".join(POLICIES[name] for name in better) or "no learned policy"
        verb = "beats" if len(better) < 2 else "beat"
        lines.append(f"- `{task}`, `{condition}`: {names} {verb} the {POLICIES[control]}.")
    return lines


def training(result: Mapping[str, Any]) -> str:
    """What was trained, for how long."""
    cloning = result["cloning"]
    rows = [
        [
            POLICIES["clone"],
            f"{cloning['num_demonstrations']:,} successful episodes of the servo, {cloning['num_frames']:,} frames",
            minutes(cloning),
        ]
    ]
    for name, curve in result["curves"].items():
        rows.append([POLICIES[name], f"{curve['steps']:,} environment steps", minutes(curve)])
    return table(["policy", "trained with", "minutes of processor time"], rows)


def minutes(times: Mapping[str, float]) -> str:
    """Processor time of a training."""
    return f"{times['cpu_seconds'] / 60:.1f}"


def section(task: str, result: Mapping[str, Any], notes: str) -> str:
    """The part of the page about one task."""
    evaluations = result["evaluations"]
    servo = evaluations[CONDITIONS[0]]["servo"]
    machine = result["machine"]
    parts = [
        f"## {task}",
        f"{servo['num_episodes']:,} episodes per cell, seed {EVALUATION_SEED}; the servo is `{servo['controller']}`. "
        "Success in %, with 95 % Wilson intervals:",
        rates(evaluations),
        "Paired differences over the same episodes, in points of %, with 95 % intervals; bold where the interval excludes 0:",
        differences(evaluations),
        "Medians over the episodes that kept contact to the end, peak force over all:",
        measures(evaluations),
        training(result),
        f"taxelsim {machine['taxelsim']}, commit {result['commit']}; {machine['driver']}, {machine['cores']} cores of {machine['cpu']}. "
        f"Torch {result['versions']['torch']}, Stable-Baselines3 {result['versions']['stable_baselines3']}.",
    ]
    return "\n\n".join(part for part in [*parts, notes.strip()] if part)


def page(template: str, results: Mapping[str, Mapping[str, Any]], notes: Mapping[str, str], dynamics: str) -> str:
    """The whole page. `template` has the fields {findings}, {history}, {recipes}, {sections} and {dynamics}.

    notes: text by task. dynamics: the section of dynamics.py.
    """
    lines = [line for task, result in results.items() for line in findings(task, result["evaluations"])]
    sections = "\n\n".join(section(task, result, notes.get(task, "")) for task, result in results.items())
    fields = {
        "findings": "\n".join(lines),
        "history": str(HISTORY),
        "recipes": recipes(results),
        "sections": sections,
        "dynamics": dynamics,
    }
    text = template
    for name, value in fields.items():
        text = text.replace("{" + name + "}", value)
    return text.rstrip() + "\n"


def recipes(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Settings of the trainings, tasks in columns."""
    keys = dict.fromkeys(key for result in results.values() for key in result["recipe"])
    rows = [[f"`{key}`", *(setting_text(result["recipe"].get(key, "-")) for result in results.values())] for key in keys]
    return table(["setting", *results], rows)


def setting_text(value: Any) -> str:
    """A setting of a recipe."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {setting_text(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return " ".join(setting_text(item) for item in value)
    return value if isinstance(value, str) else f"{value:,}" if isinstance(value, int) else f"{value:g}"
