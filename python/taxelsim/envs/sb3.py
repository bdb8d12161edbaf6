"""Adapter for Stable-Baselines3, which is not a dependency: import this module only where it is installed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from ..errors import InputError
from .episodic import EpisodicVectorEnv


class StableBaselinesVecEnv(VecEnv):  # type: ignore[misc]
    """Vector environment for Stable-Baselines3.

    `envs` must be in mode SAME_STEP. Of an episode that ended, `infos[i]` has `terminal_observation`,
    `TimeLimit.truncated` and `is_success`.
    """

    def __init__(self, envs: EpisodicVectorEnv) -> None:
        if envs.autoreset_mode is not AutoresetMode.SAME_STEP:
            raise InputError(f"autoreset_mode: {envs.autoreset_mode.value} is not allowed: SameStep")
        self.envs = envs
        self.render_mode = envs.render_mode
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> Any:
        seed = None if self._seeds[0] is None else list(self._seeds)
        observation, _ = self.envs.reset(seed=seed)
        self._reset_seeds()
        return observation

    def step_async(self, actions: np.ndarray) -> None:
        self._pending = actions

    def step_wait(self) -> Any:
        observation, rewards, terminated, truncated, infos = self.envs.step(self._pending)
        done = terminated | truncated
        rows: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(done):
            rows[i] = {
                "terminal_observation": infos["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i] and not terminated[i]),
                "is_success": bool(infos["final_info"]["success"][i]),
            }
        return observation, rewards.astype(np.float32), done, rows

    def close(self) -> None:
        self.envs.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self.envs, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError("the environments share their attributes; set them where they are made")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        raise NotImplementedError("the environments are one batch; call its methods through `envs`")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        return [False] * len(list(self._get_indices(indices)))

    def get_images(self) -> Sequence[np.ndarray | None]:
        return [np.asarray(frame) for frame in self.envs.render() or ()]
