"""One episode at a time, as a `gymnasium.Env`."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from .._core import Scene
from ..vectorized import EnvArguments
from .episodic import EpisodicVectorEnv
from .vector_env import TactileVectorEnv

if TYPE_CHECKING:
    from typing_extensions import Unpack


class EpisodicEnv(gymnasium.Env[Any, NDArray[Any]]):
    """An EpisodicVectorEnv of one environment with the interface of `gymnasium.Env`.

    For one-at-a-time tools and debugging; a vector environment of many is far faster. `episode_key` of its infos is a numpy.uint64, which
    Gymnasium's SyncVectorEnv and AsyncVectorEnv keep; an int would become an int64.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012, as declared by Gymnasium

    def __init__(self, batch: EpisodicVectorEnv) -> None:
        """batch: of one environment, with AutoresetMode.DISABLED."""
        self._batch = batch
        self.metadata = {**self.metadata, "render_fps": round(1 / batch.step_time)}
        self.render_mode = batch.render_mode
        self.observation_space = batch.single_observation_space
        self.action_space = batch.single_action_space

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Starts a new episode."""
        observation, infos = self._batch.reset(seed=seed, options=options)
        super().reset(seed=None if seed is None else int(seed))
        return _single(observation), _single_info(infos)

    def step(self, action: NDArray[Any]) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Performs one action; see the vector environment."""
        observation, rewards, terminated, truncated, infos = self._batch.step(np.asarray(action)[None])
        return _single(observation), float(rewards[0]), bool(terminated[0]), bool(truncated[0]), _single_info(infos)

    def render(self) -> NDArray[np.uint8] | None:
        """Picture (height, width, 3) of the tactile image; None without `render_mode`."""
        frames = self._batch.render()
        return None if frames is None else frames[0]

    def close(self) -> None:
        """Releases the device memory."""
        self._batch.close()


class TactileEnv(EpisodicEnv):
    """`TactileVectorEnv` with one environment and the interface of `gymnasium.Env`. Takes the same arguments."""

    def __init__(self, scene: Scene | str | os.PathLike[str], **kwargs: Unpack[EnvArguments]) -> None:
        super().__init__(TactileVectorEnv(scene, 1, autoreset_mode=AutoresetMode.DISABLED, **kwargs))


def _single(observation: Any) -> Any:
    if isinstance(observation, dict):
        return {name: values[0] for name, values in observation.items()}
    return observation[0]


def _single_info(infos: dict[str, Any]) -> dict[str, Any]:
    values = {name: rows[0] for name, rows in infos.items() if not name.startswith("_")}
    return {name: value if np.ndim(value) or isinstance(value, np.uint64) else value.item() for name, value in values.items()}
