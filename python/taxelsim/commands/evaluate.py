"""`taxelsim evaluate SCENE --policy FILE`: evaluates an ONNX policy, alone or compared with controllers of the scene."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .._core import TASK_MEASURES, Device, Evaluation, Progress, Scene, Score, load_scene
from ..errors import InputError
from ..parts import MAX_HANDS, EvaluationPart, check_players, evaluate_part, merge_evaluations, merge_grasp_evaluations
from ..policies.actions import COMMANDS
from ..policies.failures import failed_episodes
from ..policies.observations import OBSERVATIONS
from ..policies.policy import Policy, as_policy
from ..policies.statistics import Comparison, compare
from ..runs import Interrupted, evaluate, evaluate_grasp
from .evaluate_grasp import print_grasps
from .evaluate_parts import add_part_arguments, chosen_episodes, part_file, part_files
from .evaluation_table import plain, quantiles_text, rate_text, table_text
from .running import run_command

# Display units of TASK_MEASURES: name, and how many are one SI unit.
_UNITS = {"edge_angle": ("deg", 180 / np.pi), "total_force": ("N", 1.0), "center": ("mm", 1e3), "contour": ("mm", 1e3)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the subcommand."""
    add = parser.add_argument
    add("scene", metavar="SCENE", help="scene file of kind servo with a task, or of kind grasp")
    add("--policy", required=True, metavar="FILE", help="ONNX file: observations in, actions in [-1, 1] out")
    add("--controller", action="append", default=[], metavar="NAME", help="controller of the scene to compare with; repeatable")
    add("--gain", action="append", default=[], type=float, metavar="GAIN", help="of kind grasp, 1/s: gain to compare with; repeatable")
    add("--observations", type=_names, metavar="NAMES", help=f"out of {', '.join(OBSERVATIONS)}, separated by commas; default: contact")
    add("--action", choices=COMMANDS, help="what the policy commands, default twist; of kind grasp joint_velocities")
    add("--actions", type=_names, metavar="NAMES", help="components of the twist, as v_x,v_y,w_z, or names of joints; default: all")
    add("--history", type=int, metavar="N", help="latest frames that the policy sees, default 1")
    add("--normalized", action="store_const", const=True, help="divide observations by their scales")
    add("--image-unit", choices=("counts", "newtons"), help="unit of tactile_image, default counts")
    add("--episodes", type=int, metavar="N", help="replaces the number of episodes of the scene")
    add("--seed", type=int, metavar="N", help="replaces the seed of the scene")
    add("--condition", default="nominal", metavar="NAME", help="condition of the scene, default nominal")
    add("--batch-size", type=int, default=2048, metavar="N", help="instances at a time; does not change a verdict; default 2048")
    add("--device", default="", metavar="NAME", help='"cpu", "discrete", an index, or part of a name; default: the best')
    add("--save-failures", type=Path, metavar="DIR", help="writes failed episodes of the policy as a data set, for `taxelsim render`")
    add("--max-failures", type=int, default=64, metavar="N", help="episodes that --save-failures writes, default 64")
    add_part_arguments(parser)
    add("--json", action="store_true", help="prints JSON instead of a table")


def _names(text: str) -> str | tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    return names[0] if len(names) == 1 else names


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    parser = argparse.ArgumentParser(prog="taxelsim evaluate", description=__doc__)
    add_arguments(parser)
    options = parser.parse_args(arguments)
    return run_command("evaluate", lambda: _run(options))


def _run(options: argparse.Namespace) -> int:
    policy = as_policy(
        options.policy,
        observations=options.observations,
        action=options.action,
        actions=options.actions,
        history=options.history,
        normalized=options.normalized,
        image_unit=options.image_unit,
    )
    scene = load_scene(options.scene, num_episodes=options.episodes, seed=options.seed, condition=options.condition)
    check_players(scene, options.controller, options.gain)
    unknown = [name for name in options.controller if name not in scene.controllers]
    if unknown:
        raise InputError(f"--controller {unknown[0]}: not in this scene; it has {', '.join(scene.controllers)}")
    episodes = chosen_episodes(options, scene.num_episodes)
    if options.save_failures and (episodes is not None or options.merge is not None):
        raise InputError("--save-failures: not with --episode-range, --part or --merge")
    if episodes is not None:
        return _play_part(options, scene, policy, episodes)
    interrupted = False
    try:
        evaluations = _evaluations(options, scene, policy)
    except Interrupted as interrupt:
        interrupted, evaluations = True, interrupt.partial
        num_players = 1 + len(options.controller) + len(options.gain)
        print(f"interrupted: {len(evaluations)} of {num_players} policies and controllers are complete", file=sys.stderr)
    if options.save_failures and not interrupted:
        failed = len(failed_episodes(evaluations[0]))
        print(f"wrote {min(failed, options.max_failures)} of {failed} failed episodes to {options.save_failures}", file=sys.stderr)
    if scene.kind == Scene.Kind.GRASP:
        print_grasps(scene, evaluations, options.json)
        return 130 if interrupted else 0
    comparisons = [_compared(evaluations[0], control) for control in evaluations[1:]]
    print(_json(scene, evaluations, comparisons) if options.json else _table(scene, evaluations, comparisons))
    return 130 if interrupted else 0


def _evaluations(options: argparse.Namespace, scene: Scene, policy: Policy) -> list[Any]:
    if options.merge is not None:
        files = part_files(options.merge)
        if scene.kind == Scene.Kind.GRASP:
            return merge_grasp_evaluations(scene, files, options.gain, policy=policy)
        return merge_evaluations(scene, files, options.controller, policy=policy)
    common: dict[str, Any] = {
        "policy": policy,
        "save_failures": options.save_failures,
        "max_failures": options.max_failures,
        "device": Device.open(options.device),
        "on_progress": _show_progress if sys.stderr.isatty() else None,
    }
    if scene.kind == Scene.Kind.GRASP:
        return evaluate_grasp(scene, options.gain, batch_size=min(options.batch_size, MAX_HANDS), **common)
    return evaluate(scene, options.controller, batch_size=options.batch_size, **common)


def _play_part(options: argparse.Namespace, scene: Scene, policy: Policy, episodes: range) -> int:
    if not episodes:
        print(f"{options.output}: part {options.part} of {scene.num_episodes:,} episodes is empty")
        return 0
    file, device = part_file(options.output, episodes), Device.open(options.device)
    if file.exists():
        found = EvaluationPart.load(file)
        found.check(scene, options.controller, gains=options.gain, policy=policy, device=device, name=str(file))
    else:
        progress = _show_progress if sys.stderr.isatty() else None
        part = evaluate_part(
            scene,
            options.controller,
            episodes=episodes,
            gains=options.gain,
            policy=policy,
            device=device,
            batch_size=options.batch_size,
            on_progress=progress,
        )
        options.output.mkdir(parents=True, exist_ok=True)
        part.save(file)
    print(f"{file}: {len(episodes):,} episodes of each; `taxelsim evaluate --policy FILE --merge {options.output}` puts the parts together")
    return 0


def _show_progress(progress: Progress) -> None:
    print(f"\r{progress.episodes_done} of {progress.num_episodes} episodes ", end="", file=sys.stderr, flush=True)


def _compared(evaluation: Evaluation, control: Evaluation) -> Comparison:
    return compare(evaluation.controller, evaluation.verdicts["success"], control.controller, control.verdicts["success"])


def _measures(evaluations: Sequence[Evaluation]) -> list[str]:
    errors = evaluations[0].verdicts["start_error"]
    return [name for m, name in enumerate(TASK_MEASURES) if not np.isnan(errors[:, m]).all()]


def _table(scene: Scene, evaluations: Sequence[Evaluation], comparisons: Sequence[Comparison]) -> str:
    if not evaluations:
        return ""
    measures = _measures(evaluations)
    rows = [["policy", "episodes of", "episodes", "success (95 %)", "settling s", *(f"{m} {_UNITS[m][0]}" for m in measures)]]
    rows[0] += ["peak force N", "lost contact"]
    for evaluation in evaluations:
        scores = [evaluation.total, *(evaluation.by_object if len(evaluation.by_object) > 1 else [])]
        rows += [_row(evaluation.controller if k == 0 else "", score, measures) for k, score in enumerate(scores)]
    head = f"{scene.name}: columns show median / 95th percentile over episodes"
    return "\n".join([head, "", table_text(rows), *([""] if comparisons else []), *map(str, comparisons)])


def _row(name: str, score: Score, measures: Sequence[str]) -> list[str]:
    success = rate_text(score.success_rate, score.success_low, score.success_high)
    cells = [name, score.name, f"{score.num_episodes:,}", success, quantiles_text(score.settling_time)]
    cells += [quantiles_text(score.steady_error[TASK_MEASURES.index(m)], _UNITS[m][1]) for m in measures]
    return [*cells, quantiles_text(score.peak_force), f"{score.num_lost:,}"]


def _json(scene: Scene, evaluations: Sequence[Evaluation], comparisons: Sequence[Comparison]) -> str:
    entries = []
    for evaluation in evaluations:
        total, verdicts = evaluation.total, evaluation.verdicts
        entries.append(
            {
                "controller": evaluation.controller,
                "episodes": total.num_episodes,
                "successes": total.num_successes,
                "success_rate": total.success_rate,
                "success_rate_95": [total.success_low, total.success_high],
                "verdicts": {name: plain(values) for name, values in verdicts.items() if values.ndim == 1},
            }
        )
    content = {"scene": scene.name, "seed": scene.seed, "controllers": entries, "comparisons": [vars(c) for c in comparisons]}
    return json.dumps(content, indent=2)
