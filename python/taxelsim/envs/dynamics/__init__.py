"""Tasks with dynamics: MuJoCo moves bodies that a tactile array observes. Needs MuJoCo 4: pip install 'taxelsim[mujoco]'.

>>> envs = gymnasium.make_vec("taxelsim/Push-v0", num_envs=1024, shear=False)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gymnasium.vector import AutoresetMode

from ..._arguments import checked_names
from ...tasks import DYNAMIC_TASKS
from ..env import EpisodicEnv

if TYPE_CHECKING:
    from .vector_env import DynamicVectorEnv


def make_vec(task: str, num_envs: int = 1, **kwargs: Any) -> DynamicVectorEnv:
    """A vector environment of a task with dynamics. `kwargs`: of DynamicVectorEnv. Raises ImportError without MuJoCo 4."""
    checked_names("task", task, tuple(DYNAMIC_TASKS))
    import_module("taxelsim.mujoco.batch").require_batch(f"the task {task}")
    module = import_module(f"{__name__}.{DYNAMIC_TASKS[task]}")
    envs: DynamicVectorEnv = getattr(module, f"{task}VectorEnv")(num_envs, **kwargs)
    return envs


def make_env(task: str, **kwargs: Any) -> EpisodicEnv:
    """One environment of a task with dynamics. As make_vec()."""
    return EpisodicEnv(make_vec(task, autoreset_mode=AutoresetMode.DISABLED, **kwargs))
