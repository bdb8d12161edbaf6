"""Adapter for rsl_rl, which is not a dependency: import this module only where rsl_rl, torch and tensordict are installed."""

from __future__ import annotations

from typing import Any

import torch
from gymnasium.vector import AutoresetMode
from rsl_rl.env import VecEnv
from tensordict import TensorDict

from ..errors import InputError
from .vector_env import TactileVectorEnv


class RslRlVecEnv(VecEnv):  # type: ignore[misc]
    """Vector environment for rsl_rl: observations in a TensorDict, `time_outs` of truncated episodes in the extras.

    A single observation is the group "policy"; several are groups of their own names. seed: of the first reset; None draws one.
    """

    def __init__(self, envs: TactileVectorEnv, device: str = "cpu", seed: int | None = None) -> None:
        if envs.autoreset_mode is not AutoresetMode.SAME_STEP:
            raise InputError(f"autoreset_mode: {envs.autoreset_mode.value} is not allowed: SameStep")
        self.envs, self.device = envs, device
        self.cfg: dict[str, Any] = {}
        self.num_envs = envs.num_envs
        self.num_actions = envs.num_actions
        self.max_episode_length = envs.max_episode_steps
        self.episode_length_buf = torch.zeros(self.num_envs, dtype=torch.long, device=device)
        self._observation = self._tensors(envs.reset(seed=seed)[0])

    def _tensors(self, observation: Any) -> TensorDict:
        groups = observation if isinstance(observation, dict) else {"policy": observation}
        tensors = {name: torch.as_tensor(values, dtype=torch.float32, device=self.device) for name, values in groups.items()}
        return TensorDict(tensors, batch_size=[self.num_envs])

    def get_observations(self) -> TensorDict:
        return self._observation

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]:
        observation, rewards, terminated, truncated, _ = self.envs.step(actions.detach().cpu())
        self._observation = self._tensors(observation)
        dones = torch.as_tensor(terminated | truncated, dtype=torch.long, device=self.device)
        self.episode_length_buf = (self.episode_length_buf + 1) * (1 - dones)
        extras = {"time_outs": torch.as_tensor(truncated & ~terminated, device=self.device)}
        return self._observation, torch.as_tensor(rewards, dtype=torch.float32, device=self.device), dones, extras
