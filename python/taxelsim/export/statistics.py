"""Statistics of the episodes of a data set, as LeRobot stores them, and of all episodes together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Statistics = dict[str, NDArray[Any]]  # count: (E, 1), all others (E, D)
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
MEASURES = ("min", "max", "mean", "std", "count", *QUANTILES)


def of_episodes(values: NDArray[Any], ends: NDArray[np.int64]) -> Statistics:
    """Statistics of each episode. values: (F, D); ends: (E), frames up to the end of each episode, without empty ones."""
    begins = np.concatenate(([0], ends[:-1]))
    counts = (ends - begins)[:, None]
    numbers = values.astype(np.float64)
    mean = np.add.reduceat(numbers, begins) / counts
    numbers -= np.repeat(mean, counts[:, 0], axis=0)
    std = np.sqrt(np.add.reduceat(np.square(numbers, out=numbers), begins) / counts)
    low, high = np.minimum.reduceat(values, begins), np.maximum.reduceat(values, begins)
    return {"min": low, "max": high, "mean": mean, "std": std, "count": counts, **_quantiles(values, begins, counts[:, 0])}


def _quantiles(values: NDArray[Any], begins: NDArray[np.int64], lengths: NDArray[np.int64]) -> Statistics:
    """QUANTILES of each episode, linear between frames. Episodes of the same length are sorted together."""
    result = np.empty((len(QUANTILES), len(begins), values.shape[1]))
    for length in np.unique(lengths):
        chosen = lengths == length
        frames = np.sort(values[begins[chosen][:, None] + np.arange(length)], axis=1)
        for number, place in enumerate((length - 1) * np.array(list(QUANTILES.values()))):
            low = int(place)
            below, above = (frames[:, index].astype(np.float64) for index in (low, min(low + 1, length - 1)))
            result[number, chosen] = below + (place - low) * (above - below)
    return dict(zip(QUANTILES, result, strict=True))


class Total:
    """Statistics of all frames, from those of episodes in the order in which they are added."""

    def __init__(self) -> None:
        self._count = 0
        self._mean: Any = 0.0
        self._squares: Any = 0.0  # sum of squared deviations from the mean
        self._min: Any = np.inf
        self._max: Any = -np.inf
        self._quantiles = {name: np.zeros(1) for name in QUANTILES}

    def add(self, episodes: Mapping[str, NDArray[Any]]) -> None:
        """Parallel variant of Welford's algorithm (Chan, Golub and LeVeque, 1979)."""
        counts = episodes["count"].astype(np.float64)
        count = counts.sum()
        mean = (episodes["mean"] * counts).sum(axis=0) / count
        squares = ((episodes["std"] ** 2 + (episodes["mean"] - mean) ** 2) * counts).sum(axis=0)
        total, shift = self._count + count, mean - self._mean
        for name in QUANTILES:
            self._quantiles[name] = (self._quantiles[name] * self._count + (episodes[name] * counts).sum(axis=0)) / total
        self._squares += squares + shift**2 * self._count * count / total
        self._mean += shift * count / total
        self._count += int(count)
        self._min = np.minimum(self._min, episodes["min"].min(axis=0))
        self._max = np.maximum(self._max, episodes["max"].max(axis=0))

    def result(self) -> dict[str, list[Any]]:
        """count: (1), all others (D). Quantiles are means of those of the episodes, weighted by frames, as LeRobot has them."""
        std = np.sqrt(self._squares / self._count)
        measures = {"min": self._min, "max": self._max, "mean": self._mean, "std": std, **self._quantiles}
        return {name: np.asarray(values).tolist() for name, values in measures.items()} | {"count": [self._count]}
