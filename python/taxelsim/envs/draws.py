"""Random numbers of episodes, and functions of single numbers, with the same bytes for every batch size."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


def each(function: Callable[[float], float], values: Array) -> Array:
    """`function` of each value. NumPy's own vectorised functions may differ in the last bit by the position in an array."""
    return np.fromiter(map(function, values.ravel().tolist()), np.float64, values.size).reshape(values.shape)


def uniform_numbers(keys: NDArray[np.uint64], count: int) -> Array:
    """Numbers in [0, 1), (N, count), functions of the key and the column alone: SplitMix64 (Steele, Lea and Flood 2014)."""
    with np.errstate(over="ignore"):
        z = keys[:, None] + _GOLDEN * np.arange(1, count + 1, dtype=np.uint64)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z ^= z >> np.uint64(31)
    numbers: Array = (z >> np.uint64(11)).astype(np.float64) * 2.0**-53
    return numbers
