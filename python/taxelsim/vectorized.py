"""Vector environments without an import of Gymnasium until one is made."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from ._core import Scene

if TYPE_CHECKING:
    from .envs import TactileVectorEnv


def make_vec(scene: Scene | str | os.PathLike[str], num_envs: int = 1, **arguments: Any) -> TactileVectorEnv:
    """A vector environment of Gymnasium over a scene of kind servo with a task. arguments: of taxelsim.envs.TactileVectorEnv."""
    try:
        from .envs import TactileVectorEnv
    except ModuleNotFoundError as error:
        if error.name != "gymnasium":
            raise
        raise ImportError("environments need gymnasium: pip install gymnasium") from error
    return TactileVectorEnv(scene, num_envs, **arguments)
