"""Checks of arguments. Every error says which value is not allowed, what is, and which environment it belongs to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import to_numpy
from .errors import InputError

LENGTH_UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "inch": 0.0254}
"""Units of length of files that name none, in m."""


def checked_count(name: str, value: int) -> int:
    """`value` if it is an integer >= 1, else InputError."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise InputError(f"{name}: {type(value).__name__} is not allowed: an integer")
    if value < 1:
        raise InputError(f"{name}: {value} is not allowed: at least 1")
    return int(value)


def checked_names(name: str, values: str | Sequence[str], allowed: Sequence[str]) -> tuple[str, ...]:
    """`values` as a tuple if they are different names out of `allowed`, else InputError."""
    names = (values,) if isinstance(values, str) else tuple(values)
    if not names:
        raise InputError(f"{name}: empty; allowed are {', '.join(allowed)}")
    for i, value in enumerate(names):
        if value not in allowed:
            raise InputError(f"{name}: {value!r} is not allowed: {', '.join(allowed)}")
        if value in names[:i]:
            raise InputError(f"{name}: {value!r} found twice")
    return names


def checked_positive(name: str, value: float) -> float:
    """`value` if it is a finite number above 0, else InputError."""
    if not (np.isfinite(value) and value > 0):
        raise InputError(f"{name}: {value} is not allowed: a finite number above 0")
    return float(value)


def checked_actions(
    actions: Any, shape: tuple[int, ...], name_of: Callable[[int], str] = "environment {}".format
) -> NDArray[np.floating[Any]]:
    """`actions` clipped to [-1, 1] if they are finite floating-point numbers of `shape`, else InputError.

    name_of: name of a row in messages.
    """
    array = np.asarray(to_numpy("actions", actions))
    if not np.issubdtype(array.dtype, np.floating):
        raise InputError(f"actions: dtype {array.dtype} is not allowed: floating-point numbers")
    if array.shape != shape:
        hint = "; did you mean the transposed array?" if array.shape == shape[::-1] else ""
        raise InputError(f"actions: shape {array.shape} is not allowed: {shape}{hint}")
    finite = np.isfinite(array)
    if not finite.all():
        index = tuple(int(k) for k in np.argwhere(~finite)[0])
        raise InputError(f"actions: {array[index]} found in {name_of(index[0])}, dimension {index[-1]}; must be finite")
    clipped: NDArray[np.floating[Any]] = np.clip(array, -1, 1)
    return clipped


def checked_mask(options: dict[str, Any] | None, num_envs: int) -> NDArray[np.bool_]:
    """The mask of `reset(options=...)`: all environments without one."""
    options = dict(options or {})
    mask = to_numpy("options['reset_mask']", options.pop("reset_mask", None))
    if options:
        raise InputError(f"options: {next(iter(options))!r} is not allowed: only 'reset_mask'")
    if mask is None:
        return np.ones(num_envs, np.bool_)
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
        found = mask.dtype if isinstance(mask, np.ndarray) else type(mask).__name__
        raise InputError(f"options['reset_mask']: {found} is not allowed: a NumPy array of bool")
    if mask.shape != (num_envs,):
        raise InputError(f"options['reset_mask']: shape {mask.shape} is not allowed: {(num_envs,)}")
    if not mask.any():
        raise InputError("options['reset_mask']: at least one environment must be True")
    return np.array(mask, np.bool_)


def checked_seeds(seed: Any, num_envs: int) -> NDArray[np.uint64] | None:
    """One seed per environment, from one for all or one for each; None without."""
    if seed is None:
        return None
    seeds = list(seed) if isinstance(seed, Sequence | np.ndarray) else [seed] * num_envs
    if len(seeds) != num_envs:
        raise InputError(f"seed: {len(seeds)} seeds are not allowed: {num_envs}")
    for i, value in enumerate(seeds):
        if isinstance(value, bool) or not isinstance(value, int | np.integer):
            raise InputError(f"seed: {type(value).__name__} is not allowed for environment {i}: an integer")
        if not 0 <= value < 2**64:
            raise InputError(f"seed: {value} is not allowed for environment {i}: 0 to 2^64 - 1")
    return np.array([int(value) for value in seeds], np.uint64)
