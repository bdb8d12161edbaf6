"""`taxelsim evaluate SCENE --policy FILE` of a scene of kind grasp."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from typing import Any

from .._core import Device, FingerScore, GraspEvaluation, Progress, Scene
from ..errors import InputError
from ..policies.failures import failed_episodes
from ..policies.policy import Policy
from ..policies.statistics import Comparison, compare
from ..runs import Interrupted, evaluate_grasp
from .evaluation_table import plain, quantiles_text, rate_text, table_text

MAX_BATCH_SIZE = 256
"""Instances of a hand at a time."""


def run(options: argparse.Namespace, scene: Scene, policy: Policy, on_progress: Callable[[Progress], None] | None) -> int:
    """Evaluates the policy and the gains of the options, and prints a table or JSON. Returns the exit status."""
    for given, name in ((options.controller, "--controller"), (options.episode_range, "--episode-range"), (options.part, "--part")):
        if given:
            raise InputError(f"{name}: a scene of kind grasp is evaluated as a whole, and has no controllers; --gain")
    if options.merge is not None:
        raise InputError("--merge: a scene of kind grasp has no parts of an evaluation")
    status, evaluations = 0, []
    try:
        evaluations = evaluate_grasp(
            scene,
            options.gain,
            policy=policy,
            save_failures=options.save_failures,
            max_failures=options.max_failures,
            device=Device.open(options.device),
            batch_size=min(options.batch_size, MAX_BATCH_SIZE),
            on_progress=on_progress,
        )
    except Interrupted as interrupt:
        status, evaluations = 130, interrupt.partial
        print(f"interrupted: {len(evaluations)} of {1 + len(options.gain)} policies and gains are complete", file=sys.stderr)
    if options.save_failures and status == 0:
        failed = len(failed_episodes(evaluations[0]))
        print(f"wrote {min(failed, options.max_failures)} of {failed} failed episodes to {options.save_failures}", file=sys.stderr)
    comparisons = [_compared(evaluations[0], control) for control in evaluations[1:]]
    if evaluations:
        print(_json(scene, evaluations, comparisons) if options.json else _table(scene, evaluations, comparisons))
    return status


def _name(evaluation: GraspEvaluation) -> str:
    return evaluation.policy or f"gain {evaluation.gain:.4g}"


def _compared(evaluation: GraspEvaluation, control: GraspEvaluation) -> Comparison:
    return compare(_name(evaluation), evaluation.verdicts["success"], _name(control), control.verdicts["success"])


def _table(scene: Scene, evaluations: Sequence[GraspEvaluation], comparisons: Sequence[Comparison]) -> str:
    rows = [["policy", "finger", "episodes", "success (95 %)", "settling s", "force error N", "drift mm", "peak force N", "lost contact"]]
    for evaluation in evaluations:
        scores = [evaluation.total, *evaluation.fingers]
        rows += [_row(_name(evaluation) if k == 0 else "", score) for k, score in enumerate(scores)]
    head = f"{scene.name}: columns show median / 95th percentile over episodes, for all fingers of the finger with the largest value"
    return "\n".join([head, "", table_text(rows), *([""] if comparisons else []), *map(str, comparisons)])


def _row(name: str, score: FingerScore) -> list[str]:
    cells = [name, score.name, f"{score.num_episodes:,}", rate_text(score.held_rate, score.held_low, score.held_high)]
    cells += [quantiles_text(score.settling_time), quantiles_text(score.force_error), quantiles_text(score.drift, 1e3)]
    return [*cells, quantiles_text(score.peak_force), f"{score.num_lost:,}"]


def _json(scene: Scene, evaluations: Sequence[GraspEvaluation], comparisons: Sequence[Comparison]) -> str:
    entries: list[dict[str, Any]] = []
    for evaluation in evaluations:
        total = evaluation.total
        entries.append(
            {
                "name": _name(evaluation),
                "episodes": total.num_episodes,
                "successes": total.num_held,
                "success_rate": total.held_rate,
                "success_rate_95": [total.held_low, total.held_high],
                "fingers": [score.name for score in evaluation.fingers],
                "verdicts": {name: plain(values) for name, values in evaluation.verdicts.items()},
            }
        )
    content = {"scene": scene.name, "seed": scene.seed, "evaluations": entries, "comparisons": [vars(c) for c in comparisons]}
    return json.dumps(content, indent=2)
