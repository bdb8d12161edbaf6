"""Tasks with dynamics: MuJoCo moves bodies that a tactile array observes. Needs MuJoCo 4: pip install 'taxelsim[mujoco]'.

>>> envs = gymnasium.make_vec("taxelsim/Push-v0", num_envs=1024, shear=False)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import gymnasium

from ..._arguments import checked_names

if TYPE_CHECKING:
    from .vector_env import DynamicVectorEnv

DYNAMIC_TASKS = {"Push": "push", "Roll": "roll", "GraspHold": "grasp_hold", "PegInsert": "peg_insert"}
"""Modules of this package by task."""


def make_dynamic_vec(task: str, num_envs: int = 1, **kwargs: Any) -> DynamicVectorEnv:
    """A vector environment of a task with dynamics. `kwargs`: of DynamicVectorEnv. Raises ImportError without MuJoCo 4."""
    checked_names("task", task, tuple(DYNAMIC_TASKS))
    import_module("taxelsim.mujoco")  # says what to install
    module = import_module(f"{__name__}.{DYNAMIC_TASKS[task]}")
    envs: DynamicVectorEnv = getattr(module, f"{task}VectorEnv")(num_envs, **kwargs)
    return envs


def register_dynamics() -> None:
    """Registers all tasks with Gymnasium, for `gymnasium.make_vec` only. Does nothing for those that are registered."""
    for task in DYNAMIC_TASKS:
        if f"taxelsim/{task}-v0" not in gymnasium.registry:
            gymnasium.register(f"taxelsim/{task}-v0", vector_entry_point=f"{__name__}:make_dynamic_vec", kwargs={"task": task})
