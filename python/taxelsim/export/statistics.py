"""Statistics of the episodes of a data set, as LeRobot stores them, and of all episodes together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Statistics = dict[str, NDArray[Any]]  # min, max, mean, std: (E, D); count: (E, 1)
MEASURES = ("min", "max", "mean", "std", "count")


def of_episodes(values: NDArray[Any], ends: NDArray[np.int64]) -> Statistics:
    """Statistics of each episode. values: (F, D); ends: (E), frames up to the end of each episode, without empty ones."""
    begins = np.concatenate(([0], ends[:-1]))
    counts = (ends - begins)[:, None]
    numbers = values.astype(np.float64)
    mean = np.add.reduceat(numbers, begins) / counts
    numbers -= np.repeat(mean, counts[:, 0], axis=0)
    std = np.sqrt(np.add.reduceat(np.square(numbers, out=numbers), begins) / counts)
    low, high = np.minimum.reduceat(values, begins), np.maximum.reduceat(values, begins)
    return {"min": low, "max": high, "mean": mean, "std": std, "count": counts}


class Total:
    """Statistics of all frames, from those of episodes in the order in which they are added."""

    def __init__(self) -> None:
        self._count = 0
        self._mean: Any = 0.0
        self._squares: Any = 0.0  # sum of squared deviations from the mean
        self._min: Any = np.inf
        self._max: Any = -np.inf

    def add(self, episodes: Mapping[str, NDArray[Any]]) -> None:
        """Parallel variant of Welford's algorithm (Chan, Golub and LeVeque, 1979)."""
        counts = episodes["count"].astype(np.float64)
        count = counts.sum()
        mean = (episodes["mean"] * counts).sum(axis=0) / count
        squares = ((episodes["std"] ** 2 + (episodes["mean"] - mean) ** 2) * counts).sum(axis=0)
        total, shift = self._count + count, mean - self._mean
        self._squares += squares + shift**2 * self._count * count / total
        self._mean += shift * count / total
        self._count += int(count)
        self._min = np.minimum(self._min, episodes["min"].min(axis=0))
        self._max = np.maximum(self._max, episodes["max"].max(axis=0))

    def result(self) -> dict[str, list[Any]]:
        """min, max, mean, std: (D); count: (1)."""
        std = np.sqrt(self._squares / self._count)
        measures = {"min": self._min, "max": self._max, "mean": self._mean, "std": std}
        return {name: np.asarray(values).tolist() for name, values in measures.items()} | {"count": [self._count]}
