"""The tasks of this package, and their registration with Gymnasium. Imports no environment: Gymnasium does so when it makes one."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TaskSpec:
    """A benchmark task. Its success, tolerances and episode length are in the scene."""

    name: str  #: Name without namespace and version.
    scene: str  #: Scene file, relative to the folder of scenes.
    actions: tuple[str, ...]  #: Components of the twist that a policy commands.
    summary: str  #: What the task requires.


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
"""Tasks of tactile servoing."""

DYNAMIC_TASKS = {"Push": "push", "Roll": "roll", "GraspHold": "grasp_hold", "PegInsert": "peg_insert"}
"""Modules of taxelsim.envs.dynamics by task."""


def register_envs() -> None:
    """Registers all tasks with Gymnasium as `taxelsim/<Name>-v0`, for make() and make_vec(). Does nothing for those that are registered.

    `import taxelsim.envs` does it, and so does Gymnasium for an id that names that module: "taxelsim.envs:taxelsim/EdgeFollow-v0". It is
    the entry point `gymnasium.envs` of the package, which Gymnasium loads at its import before version 1.0 only.
    """
    import gymnasium

    makers = {task: ("tasks", {"task": task}) for task in TASKS}
    makers |= {"TouchClassify": ("touch_classify", {})}
    makers |= {task: ("dynamics", {"task": task}) for task in DYNAMIC_TASKS}
    for task, (module, arguments) in makers.items():
        place = f"taxelsim.envs.{module}"
        if f"taxelsim/{task}-v0" not in gymnasium.registry:
            gymnasium.register(
                f"taxelsim/{task}-v0", entry_point=f"{place}:make_env", vector_entry_point=f"{place}:make_vec", kwargs=arguments
            )
