"""The benchmark of learned policies.

python -m learn run TASK --folder DIR    trains, evaluates, writes bench/results/learn-TASK.json and the page
python -m learn page                     writes docs/benchmark.md and its picture from bench/results/

DIR keeps networks and evaluations: a run that was stopped skips what is complete. --episodes N: of an evaluation, default 1000.
--set KEY=VALUE replaces a setting of the recipe.
"""

from __future__ import annotations

import argparse
import ast
import dataclasses
import importlib.metadata
import json
import subprocess
from pathlib import Path
from typing import Any

from report import ROOT, machine, write_json

from taxelsim import Device

from . import dynamics
from .page import page
from .recipe import RECIPES, recipe_of

RESULTS = ROOT / "bench/results"
DYNAMICS = RESULTS / "dynamics.json"  # of bench/python/dynamics_success.py
PAGE, PICTURE = ROOT / "docs/benchmark.md", ROOT / "docs/images/benchmark_curves.png"
HERE = Path(__file__).parent


def run(task: str, folder: Path, num_episodes: int, changes: dict[str, Any]) -> None:
    """Trains and evaluates all policies of a task."""
    from . import cloning, evaluation, training

    recipe = recipe_of(task, **changes)
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "clone.json").exists():
        cloning.clone(task, "clone", recipe, folder)
    for name in ("ppo", "blind"):
        if not (folder / f"{name}.curve.json").exists():
            training.train(task, name, recipe, folder, blind=name == "blind")
    files = {name: folder / f"{name}.onnx" for name in ("clone", "ppo", "blind")}
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    result = {
        "task": task,
        "machine": machine(Device.open()),
        "versions": {name: importlib.metadata.version(name) for name in ("torch", "stable_baselines3", "onnxruntime", "numpy")},
        "commit": commit,
        "recipe": dataclasses.asdict(recipe),
        "cloning": json.loads((folder / "clone.json").read_text()),
        "curves": {name: json.loads((folder / f"{name}.curve.json").read_text()) for name in ("ppo", "blind")},
        "evaluations": evaluation.evaluate_all(task, files, folder, num_episodes),
    }
    write_json(RESULTS / f"learn-{task}.json", result)


def results() -> dict[str, dict[str, Any]]:
    """The result files that are there, by task."""
    files = {task: RESULTS / f"learn-{task}.json" for task in RECIPES}
    return {task: json.loads(file.read_text()) for task, file in files.items() if file.exists()}


def page_text() -> str:
    """docs/benchmark.md."""
    found = results()
    notes = {task: file.read_text() for task in found if (file := HERE / "notes" / f"{task}.md").exists()}
    scripted = dynamics.section(json.loads(DYNAMICS.read_text()), (HERE / "notes/dynamics.md").read_text())
    return page((HERE / "page.md").read_text(), found, notes, scripted)


def write_page() -> None:
    """Writes the page and its picture."""
    from .curves import draw

    PAGE.write_text(page_text())
    draw(results(), PICTURE)
    print(f"{PAGE.relative_to(ROOT)} and {PICTURE.relative_to(ROOT)}: written")


def main() -> None:
    """Runs a subcommand."""
    parser = argparse.ArgumentParser(prog="learn", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    runner = commands.add_parser("run")
    runner.add_argument("task", choices=RECIPES)
    runner.add_argument("--folder", type=Path, required=True)
    runner.add_argument("--episodes", type=int, default=1000)
    runner.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    commands.add_parser("page")
    options = parser.parse_args()
    if options.command == "run":
        changes = {key: ast.literal_eval(value) for key, _, value in (text.partition("=") for text in options.set)}
        run(options.task, options.folder, options.episodes, changes)
    write_page()


if __name__ == "__main__":
    main()
