"""Seeds, episode keys and automatic resets, shared by the vector environments of this package."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from .._arguments import checked_actions, checked_count, checked_mask, checked_seeds
from .._tensors import converted, converter
from ..environment import episode_keys
from ..errors import InputError

Mask = NDArray[np.bool_]
Infos = dict[str, Any]


class EpisodicVectorEnv(VectorEnv[Any, NDArray[Any], NDArray[Any]], ABC):
    """Vector environment whose episodes depend on seed, environment index and reset count alone.

    The random key of environment `i` in its episode `k` (counted from the last `reset(seed=...)`) is
    `episode_keys(seed, i, k)`. A trajectory therefore has the same bytes for every `num_envs`.

    Autoreset modes (`autoreset_mode`):

    - SAME_STEP (default): an episode that ends is replaced in the same `step()`. The observation is the first one of
      the new episode; the last one of the old episode is in `infos["final_obs"]`, its info in `infos["final_info"]`.
    - NEXT_STEP: the next `step()` ignores the action of that environment and returns the first observation, reward 0.
    - DISABLED: the caller resets by `reset(options={"reset_mask": mask})`, `mask` (num_envs,) bool. A `step()` while
      an environment has ended raises `gymnasium.error.ResetNeeded`.

    Every array in `infos` has one row per environment, and a mask `_name` of the rows that are valid.

    backend: "numpy", or "torch", "jax" or "warp": the library whose tensors reset() and step() return, on the CPU; PyTorch and Warp share
    the memory. Numbers are those of NumPy, but JAX makes 64 bits to 32. Actions may come from any library on the CPU.

    Subclasses set the spaces and `step_time`, and implement `_start`, `_advance`, `_observe`, `_info` and `render`. One
    thread at a time may use an environment; several environments may run in several threads. An environment does not
    survive `os.fork()`: its use in the child raises `taxelsim.DeviceError`.
    """

    step_time: float  #: s, simulated time of one step

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.SAME_STEP}  # noqa: RUF012

    def __init__(self, num_envs: int, autoreset_mode: AutoresetMode | str, render_mode: str | None, backend: str = "numpy") -> None:
        super().__init__()
        self.backend = backend
        self._convert = converter(backend)
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise InputError(f"render_mode: {render_mode!r} is not allowed: None and 'rgb_array'")
        self.render_mode = render_mode
        self.num_envs = checked_count("num_envs", num_envs)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**type(self).metadata, "autoreset_mode": self.autoreset_mode}
        self._seeds = np.zeros(num_envs, np.uint64)
        self._reset_counts = np.zeros(num_envs, np.uint64)
        self._keys = np.zeros(num_envs, np.uint64)
        self._ended: Mask | None = None  # (num_envs), None before the first reset

    @abstractmethod
    def _start(self, mask: Mask, keys: NDArray[np.uint64]) -> None:
        """Starts the episodes `keys` (num_envs) of the environments in `mask`; leaves the others as they are."""

    @abstractmethod
    def _advance(self, actions: NDArray[Any], running: Mask) -> tuple[NDArray[np.float64], Mask, Mask]:
        """Performs one step. Returns rewards, terminated and truncated, (num_envs) each.

        Rows where `running` is False belong to episodes that have ended. Their results are ignored.
        """

    @abstractmethod
    def _observe(self) -> Any:
        """Latest observation, batched."""

    @abstractmethod
    def _info(self) -> dict[str, NDArray[Any]]:
        """Info of the latest step, (num_envs, ...) each."""

    @abstractmethod
    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Picture (height, width, 3) of each environment; None without `render_mode`, and before the first reset()."""

    def reset(self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Infos]:
        """Starts new episodes, and returns the first observations and infos.

        `seed`: one for all environments, or one per environment; also sets their reset counts to 0. None continues with
        the present seed and counts, or draws a seed at the first reset.
        `options["reset_mask"]` (num_envs,) bool: environments to reset. Default: all.
        """
        self._check_usable()
        mask = checked_mask(options, self.num_envs)
        if self._ended is None and not mask.all():
            raise ResetNeeded("the first reset() must reset all environments, without a reset_mask")
        seeds = checked_seeds(seed, self.num_envs)
        if seeds is None and self._ended is None:
            seeds = np.full(self.num_envs, self.np_random.integers(2**63), np.uint64)
        elif seeds is not None:
            super().reset(seed=int(seeds[0]))
        if seeds is not None:
            self._seeds[mask] = seeds[mask]
            self._reset_counts[mask] = 0
        self._begin(mask)
        return self._given(self._observe()), self._given(_masked(self._info(), mask))

    def _on_host(self, actions: Any) -> Any:
        """Actions where checks and controllers read them."""
        return actions

    def _given(self, value: Any) -> Any:
        """The arrays of `value` in the library of the backend."""
        return value if self.backend == "numpy" else converted(value, self._convert)

    def step(self, actions: NDArray[Any]) -> tuple[Any, NDArray[np.float64], Mask, Mask, Infos]:
        """Performs `actions` (num_envs, ...); see `action_space`. Values outside of [-1, 1] are clipped.

        Raises InputError for a wrong shape or dtype, and one that names the environment for an action that is not
        finite. The episodes are then unchanged.
        """
        self._check_usable()
        if self._ended is None:
            raise ResetNeeded("call reset() before step()")
        actions = checked_actions(self._on_host(actions), self.action_space.shape or ())
        ended = self._ended
        if self.autoreset_mode is AutoresetMode.DISABLED and ended.any():
            raise ResetNeeded(
                f"the episode of environment {int(ended.argmax())} has ended; reset it by reset(options={{'reset_mask': mask}})"
            )
        rewards, terminated, truncated = self._advance(actions, ~ended)
        if ended.any():  # NEXT_STEP
            rewards[ended] = 0
            terminated &= ~ended
            truncated &= ~ended
            self._begin(ended)
        self._ended = terminated | truncated
        infos: Infos = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._ended.any():
            self._replace_ended(infos)
        infos.update(_masked(self._info(), np.ones(self.num_envs, np.bool_)))
        results = self._observe(), rewards, terminated, truncated, infos
        return results if self.backend == "numpy" else tuple(map(self._given, results))

    def _replace_ended(self, infos: Infos) -> None:
        assert self._ended is not None
        ended = self._ended.copy()
        final = np.full(self.num_envs, None, object)
        observation = self._observe()
        for i in np.flatnonzero(ended):
            final[i] = _row(observation, int(i))
        infos["final_obs"], infos["_final_obs"] = final, ended
        infos["final_info"], infos["_final_info"] = _masked(self._info(), ended), ended.copy()
        self._begin(ended)

    def _begin(self, mask: Mask) -> None:
        indices = np.arange(self.num_envs, dtype=np.uint32)
        keys = episode_keys(self._seeds, indices, self._reset_counts)
        self._keys[mask] = keys[mask]
        self._reset_counts[mask] += np.uint64(1)
        self._start(mask, self._keys)
        if self._ended is None:
            self._ended = np.zeros(self.num_envs, np.bool_)
        self._ended[mask] = False

    def _check_usable(self) -> None:
        if self.closed:
            raise RuntimeError("this environment is closed")


def _masked(info: dict[str, NDArray[Any]], mask: Mask) -> Infos:
    infos: Infos = {}
    for name, values in info.items():
        infos[name], infos["_" + name] = values, mask.copy()
    return infos


def _row(observation: Any, i: int) -> Any:
    if isinstance(observation, dict):
        return {name: _row(values, i) for name, values in observation.items()}
    return observation[i].copy() if isinstance(observation, np.ndarray) else observation[i].clone()
