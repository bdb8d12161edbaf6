"""Success rates of policies on the tasks with dynamics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...policies.statistics import wilson_interval
from .vector_env import DynamicVectorEnv


@dataclass(frozen=True)
class Evaluation:
    """Episodes of one policy."""

    success: NDArray[np.bool_]  #: (E)
    metrics: dict[str, NDArray[Any]]  #: Infos at the end of each episode, (E) each.

    @property
    def rate(self) -> tuple[float, float, float]:
        """Success rate, and the ends of its 95 % Wilson interval."""
        count, total = int(self.success.sum()), len(self.success)
        return count / total, *wilson_interval(count, total)

    def __str__(self) -> str:
        rate, low, high = self.rate
        return f"{100 * rate:.1f} ({100 * low:.1f} to {100 * high:.1f})"


def evaluate(envs: DynamicVectorEnv, policy: Callable[[Any, NDArray[np.int64]], NDArray[np.float32]], seed: int = 0) -> Evaluation:
    """Plays the first episode of every environment after reset(seed=seed).

    policy: actions (N, A) from observations and the numbers of steps (N) of the present episodes.
    envs: of mode SAME_STEP. Raises InputError for actions of another shape, and as step().
    """
    observation, _ = envs.reset(seed=seed)
    steps = np.zeros(envs.num_envs, np.int64)
    done = np.zeros(envs.num_envs, np.bool_)
    metrics: dict[str, NDArray[Any]] = {}
    while not done.all():
        observation, _, terminated, truncated, infos = envs.step(policy(observation, steps))
        ended = terminated | truncated
        steps = np.where(ended, 0, steps + 1)
        first = ended & ~done
        if first.any():
            for name, values in infos["final_info"].items():
                if not name.startswith("_"):
                    metrics.setdefault(name, values.copy())[first] = values[first]
        done |= ended
    return Evaluation(metrics["success"], metrics)
