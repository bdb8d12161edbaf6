#!/usr/bin/env python3
"""Success of the scripted policies on the tasks with dynamics: with touch, without shear, blind; three conditions.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/dynamics_success.py --json bench/results/dynamics.json

Prints a table in Markdown, in % with 95 % Wilson intervals. All policies play the same episodes. `scripts/campaign learn dynamics` writes
the file of results and docs/notes/benchmark.md.
"""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path
from typing import Any

import gymnasium
import mujoco
from report import ROOT, machine, write_json

import taxelsim
from taxelsim.envs import CONDITIONS, DYNAMIC_TASKS
from taxelsim.envs.dynamics.evaluation import evaluate
from taxelsim.envs.dynamics.scripts import SCRIPTS, SENSES

LABELS = dict(zip(SENSES, ("with touch", "without shear", "blind"), strict=True))


def main() -> None:
    """Runs all tasks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", default=",".join(DYNAMIC_TASKS), help="list, separated by commas")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="file of results to write")
    options = parser.parse_args()
    device = taxelsim.Device.open()
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    print(f"| task | script | {' | '.join(f'`{name}`' for name in CONDITIONS)} |\n|---|---|---|---|---|")
    evaluations: dict[str, dict[str, dict[str, Any]]] = {}
    for task in options.tasks.split(","):
        evaluations[task] = {condition: {} for condition in CONDITIONS}
        for sense in SENSES:
            cells = []
            for condition in CONDITIONS:
                envs = gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=options.episodes, condition=condition, device=device)
                evaluation = evaluate(envs, SCRIPTS[task](sense), options.seed)  # type: ignore[arg-type]
                envs.close()
                cells.append(str(evaluation))
                evaluations[task][condition][sense] = {"successes": "".join("01"[int(success)] for success in evaluation.success)}
            print(f"| `{task}` | {LABELS[sense]} | {' | '.join(cells)} |", flush=True)
    results = {
        "machine": machine(device),
        "mujoco": mujoco.__version__,
        "commit": commit,
        "episodes": options.episodes,
        "seed": options.seed,
        "evaluations": evaluations,
    }
    write_json(options.json, results)


if __name__ == "__main__":
    main()
