"""The tasks of tactile servoing as environments, by name and condition."""

from __future__ import annotations

from typing import Any

from .._arguments import checked_names
from .._core import load_scene
from ..program import SCENES
from ..tasks import TASKS
from .env import TactileEnv
from .vector_env import TactileVectorEnv

#: Conditions of a benchmark task. "unseen": a sensor with the same layout, outside of the range of "randomized".
CONDITIONS = ("nominal", "randomized", "unseen")


def task_arguments(task: str, condition: str = "nominal") -> dict[str, Any]:
    """Arguments of TactileVectorEnv for a benchmark task: its scene under `condition`, and its actions."""
    checked_names("task", task, tuple(TASKS))
    checked_names("condition", condition, CONDITIONS)
    spec = TASKS[task]
    scene = load_scene(SCENES / spec.scene, condition=condition)
    return {"scene": scene, "actions": spec.actions}


def make_env(task: str, condition: str = "nominal", **kwargs: Any) -> TactileEnv:
    """One environment of a benchmark task. `kwargs`: of TactileVectorEnv."""
    return TactileEnv(**{**task_arguments(task, condition), **kwargs})


def make_vec(task: str, num_envs: int = 1, condition: str = "nominal", **kwargs: Any) -> TactileVectorEnv:
    """A vector environment of a benchmark task. `kwargs`: of TactileVectorEnv."""
    return TactileVectorEnv(num_envs=num_envs, **{**task_arguments(task, condition), **kwargs})
