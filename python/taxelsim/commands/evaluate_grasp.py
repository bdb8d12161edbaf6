"""`taxelsim evaluate SCENE --policy FILE` of a scene of kind grasp."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from .._core import FingerScore, GraspEvaluation, Scene, gain_name
from ..policies.statistics import Comparison, compare
from .evaluation_table import plain, quantiles_text, rate_text, table_text


def print_grasps(scene: Scene, evaluations: Sequence[GraspEvaluation], as_json: bool) -> None:
    """Prints the evaluations of a policy and of gains, and their differences, as a table or as JSON."""
    comparisons = [_compared(evaluations[0], control) for control in evaluations[1:]]
    if evaluations:
        print(_json(scene, evaluations, comparisons) if as_json else _table(scene, evaluations, comparisons))


def _name(evaluation: GraspEvaluation) -> str:
    return evaluation.policy or gain_name(evaluation.gain)


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
