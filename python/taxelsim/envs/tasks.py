"""The benchmark tasks as Gymnasium environments `taxelsim/<Name>-v0`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import gymnasium

from .._arguments import checked_names
from .._core import load_scene
from ..program import SCENES
from .env import TactileEnv
from .vector_env import TactileVectorEnv

#: Conditions of a benchmark task. "unseen": a sensor with the same layout, outside of the range of "randomized".
CONDITIONS = ("nominal", "randomized", "unseen")


@dataclass(frozen=True)
class TaskSpec:
    """A benchmark task. Its success, tolerances and episode length are in the scene."""

    name: str  #: Name without namespace and version.
    scene: str  #: Scene file, relative to the folder of scenes.
    actions: tuple[str, ...]  #: Components of the twist that a policy commands.
    summary: str  #: What the task requires.

    @property
    def environment_id(self) -> str:
        """Id for `gymnasium.make_vec`."""
        return f"taxelsim/{self.name}-v0"


_PLANAR = ("v_x", "v_y", "v_z", "w_z")

TASKS = {
    spec.name: spec
    for spec in (
        TaskSpec("EdgeFollow", "benchmark/edge_follow.yaml", _PLANAR, "slide along a curved edge that moves, aligned with it"),
        TaskSpec(
            "SurfaceFollow",
            "benchmark/surface_follow.yaml",
            ("v_x", "v_y", "v_z", "w_x", "w_y"),
            "slide over a curved surface, normal to it",
        ),
        TaskSpec("EdgeAlign", "benchmark/edge_align.yaml", _PLANAR, "turn a fixed axis of the array along an edge"),
        TaskSpec("RollTrack", "benchmark/roll_track.yaml", ("v_x", "v_y", "v_z"), "keep a rolling object under the middle of the array"),
        TaskSpec("ContourLap", "benchmark/contour_lap.yaml", _PLANAR, "follow a closed contour for one lap"),
    )
}


def task_arguments(task: str, condition: str = "nominal") -> dict[str, Any]:
    """Arguments of TactileVectorEnv for a benchmark task: its scene under `condition`, and its actions."""
    checked_names("task", task, tuple(TASKS))
    checked_names("condition", condition, CONDITIONS)
    spec = TASKS[task]
    scene = load_scene(SCENES / spec.scene, condition=condition)
    return {"scene": scene, "actions": spec.actions}


def make_task_env(task: str, condition: str = "nominal", **kwargs: Any) -> TactileEnv:
    """One environment of a benchmark task. `kwargs`: of TactileVectorEnv."""
    return TactileEnv(**{**task_arguments(task, condition), **kwargs})


def make_task_vec(task: str, num_envs: int = 1, condition: str = "nominal", **kwargs: Any) -> TactileVectorEnv:
    """A vector environment of a benchmark task. `kwargs`: of TactileVectorEnv."""
    return TactileVectorEnv(num_envs=num_envs, **{**task_arguments(task, condition), **kwargs})


def register_tasks() -> None:
    """Registers all tasks with Gymnasium. Does nothing for those that are registered."""
    for spec in TASKS.values():
        if spec.environment_id not in gymnasium.registry:
            gymnasium.register(
                spec.environment_id,
                entry_point="taxelsim.envs.tasks:make_task_env",
                vector_entry_point="taxelsim.envs.tasks:make_task_vec",
                kwargs={"task": spec.name},
            )
