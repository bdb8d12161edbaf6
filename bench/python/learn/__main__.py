"""The benchmark of learned policies.

python -m learn run TASK --folder DIR    trains, evaluates, writes bench/results/learn-TASK.json and the page
python -m learn dynamics --folder DIR    the same by PPO for the tasks with dynamics; bench/results/dynamics-ppo.json
python -m learn controls --folder DIR    the same with other observations of touch; bench/results/dynamics-controls.json
python -m learn page                     writes docs/notes/benchmark.md and its picture from bench/results/

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

from . import controls, dynamics
from .page import page
from .recipe import CONTROLS, DYNAMIC_RECIPES, RECIPES, TRAINING_SEED, recipe_of

RESULTS = ROOT / "bench/results"
DYNAMICS = RESULTS / "dynamics.json"  # of bench/python/dynamics_success.py
TRAINED_DYNAMICS = RESULTS / "dynamics-ppo.json"
CONTROLLED = RESULTS / "dynamics-controls.json"
PAGE, PICTURE = ROOT / "docs/notes/benchmark.md", ROOT / "docs/images/benchmark_curves.png"
HERE = Path(__file__).parent


def run(task: str, folder: Path, num_episodes: int, changes: dict[str, Any]) -> None:
    """Trains and evaluates all policies of a task."""
    from . import cloning, evaluation, training

    recipe = recipe_of(task, **changes)
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "clone.json").exists():
        cloning.clone(task, "clone", recipe, folder)
    trained = ("ppo", *CONTROLS, "blind")
    for name in trained:
        if not (folder / f"{name}.curve.json").exists():
            training.train(task, name, recipe, folder)
    files = {name: folder / f"{name}.onnx" for name in ("clone", *trained)}
    result = {
        "task": task,
        "machine": machine(Device.open()),
        "versions": versions("torch", "stable_baselines3", "onnxruntime", "numpy"),
        "commit": commit(),
        "recipe": dataclasses.asdict(recipe),
        "cloning": json.loads((folder / "clone.json").read_text()),
        "curves": {name: json.loads((folder / f"{name}.curve.json").read_text()) for name in trained},
        "evaluations": evaluation.evaluate_all(task, files, folder, num_episodes),
    }
    write_json(RESULTS / f"learn-{task}.json", result)


def versions(*names: str) -> dict[str, str]:
    """Versions of packages."""
    return {name: importlib.metadata.version(name) for name in names}


def commit() -> str:
    """The commit that is checked out."""
    return subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def run_dynamics(tasks: list[str], senses: list[str], file: Path, folder: Path, num_episodes: int, seed: int) -> None:
    """Trains and evaluates the policies of some tasks with dynamics. The results of other tasks and seeds stay in the file."""
    from . import dynamic_training

    folder.mkdir(parents=True, exist_ok=True)
    device = Device.open()
    found = tasks_of(file)
    for task in tasks:
        trained_at, recipe = commit(), DYNAMIC_RECIPES[task]
        for sense in senses:
            if not (folder / f"{task}-{sense}.json").exists():
                dynamic_training.train(task, sense, recipe, folder, device, seed)
        result = {
            "commit": trained_at,
            "machine": machine(device),
            "versions": versions("torch", "stable_baselines3", "mujoco", "numpy"),
            "episodes": num_episodes,
            "seed": dynamic_training.EVALUATION_SEED,
            "training_seed": seed,
            "recipe": dataclasses.asdict(recipe),
            "trainings": {sense: json.loads((folder / f"{task}-{sense}.json").read_text()) for sense in senses},
            "evaluations": dynamic_training.evaluations(task, senses, folder, num_episodes, device),
        }
        if seed == TRAINING_SEED:
            found[task] = {**result, "repetitions": found.get(task, {}).get("repetitions", {})}
        else:
            found[task].setdefault("repetitions", {})[str(seed)] = result
        write_json(file, {"tasks": {name: found[name] for name in DYNAMIC_RECIPES if name in found}})


def results() -> dict[str, dict[str, Any]]:
    """The result files that are there, by task."""
    files = {task: RESULTS / f"learn-{task}.json" for task in RECIPES}
    return {task: json.loads(file.read_text()) for task, file in files.items() if file.exists()}


def tasks_of(file: Path) -> dict[str, Any]:
    """Results of PPO by task; empty without the file."""
    return dict(json.loads(file.read_text())["tasks"]) if file.exists() else {}


def page_text() -> str:
    """docs/notes/benchmark.md."""
    found = results()
    notes = {task: file.read_text() for task in found if (file := HERE / "notes" / f"{task}.md").exists()}
    texts = [(HERE / f"notes/{name}.md").read_text() for name in ("dynamics", "dynamics-ppo", "dynamics-controls")]
    scripted = dynamics.section(json.loads(DYNAMICS.read_text()), texts[0], tasks_of(TRAINED_DYNAMICS), texts[1])
    controlled = controls.section(tasks_of(CONTROLLED), texts[2])
    return page((HERE / "page.md").read_text(), found, notes, "\n\n".join(filter(None, (scripted, controlled))))


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
    for name, tasks in (("dynamics", ",".join(DYNAMIC_RECIPES)), ("controls", "GraspHold")):
        dynamic = commands.add_parser(name)
        dynamic.add_argument("--tasks", default=tasks, help="list, separated by commas")
        dynamic.add_argument("--folder", type=Path, required=True)
        dynamic.add_argument("--episodes", type=int, default=100)
        dynamic.add_argument("--seed", type=int, default=TRAINING_SEED, help="of the training; another one repeats it, in its own folder")
    commands.add_parser("page")
    options = parser.parse_args()
    if options.command == "run":
        changes = {key: ast.literal_eval(value) for key, _, value in (text.partition("=") for text in options.set)}
        run(options.task, options.folder, options.episodes, changes)
    if options.command in ("dynamics", "controls"):
        senses, file = {"dynamics": (dynamics.SCRIPTS, TRAINED_DYNAMICS), "controls": (controls.POLICIES, CONTROLLED)}[options.command]
        run_dynamics(options.tasks.split(","), list(senses), file, options.folder, options.episodes, options.seed)
    write_page()


if __name__ == "__main__":
    main()
