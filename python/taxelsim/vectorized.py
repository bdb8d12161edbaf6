"""Vector environments without an import of Gymnasium until one is made."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

from ._core import Device, Scene

if TYPE_CHECKING:
    from gymnasium.vector import AutoresetMode
    from typing_extensions import Unpack

    from .envs import Reward, TactileVectorEnv


class EnvArguments(TypedDict, total=False):
    """Optional arguments of taxelsim.envs.TactileEnv."""

    observations: str | Sequence[str]
    image_unit: str
    normalized: bool
    history: int
    copy: bool
    action: str | None
    actions: str | Sequence[str] | None
    linear_scale: float | None
    angular_scale: float | None
    reward: Reward | None
    max_lost_time: float | None
    render_mode: str | None
    range: float | None
    device: Device | str


class VectorEnvArguments(EnvArguments, total=False):
    """Optional arguments of taxelsim.envs.TactileVectorEnv."""

    autoreset_mode: AutoresetMode | str
    backend: str
    memory: str


def make_vec(scene: Scene | str | os.PathLike[str], num_envs: int = 1, **arguments: Unpack[VectorEnvArguments]) -> TactileVectorEnv:
    """A vector environment of Gymnasium over a scene of kind servo with a task, or of kind grasp.

    arguments: of taxelsim.envs.TactileVectorEnv.
    """
    try:
        from .envs import TactileVectorEnv
    except ModuleNotFoundError as error:
        if error.name != "gymnasium":
            raise
        raise ImportError("environments need gymnasium: pip install gymnasium") from error
    return TactileVectorEnv(scene, num_envs, **arguments)
