"""Indices of rows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, OutOfRangeError

Rows = NDArray[np.int64]


def checked_index(place: str, index: Any, count: int) -> int:
    """`index` as a number from 0 to count - 1; negative ones count from the end. place: what it indexes, for messages."""
    if isinstance(index, bool | np.bool_) or not isinstance(index, int | np.integer):
        raise InputError(f"{place}: {type(index).__name__} is not allowed: an integer")
    if not -count <= index < count:
        raise OutOfRangeError(f"{place}: {index} is not allowed: {_allowed(count)}")
    return int(index) % count


def checked_rows(place: str, indices: Any, count: int) -> Rows:
    """A slice, integers (R) or a mask (count) as row numbers (R) from 0 to count - 1, else InputError."""
    if isinstance(indices, slice):
        return np.arange(*indices.indices(count))
    rows = np.asarray(indices)
    if rows.dtype == np.bool_:
        if rows.shape != (count,):
            raise InputError(f"{place}: a mask of shape {rows.shape} is not allowed: {(count,)}")
        return np.flatnonzero(rows)
    if rows.ndim != 1 or (rows.dtype.kind not in "iu" and rows.size):
        raise InputError(f"{place}: {rows.dtype} of shape {rows.shape} is not allowed: integers of shape (R,)")
    if rows.size and (rows.min() < -count or rows.max() >= count):
        wrong = rows[(rows < -count) | (rows >= count)][0]
        raise OutOfRangeError(f"{place}: {wrong} is not allowed: {_allowed(count)}")
    rows = rows.astype(np.int64)
    return np.where(rows < 0, rows + count, rows)


def _allowed(count: int) -> str:
    return f"{-count} to {count - 1}" if count else "there are none"


def groups(keys: Rows) -> Iterator[tuple[int, Any]]:
    """Each different value of `keys`, with an index of its places."""
    if not keys.size:
        return
    if (keys == keys[0]).all():
        yield int(keys[0]), slice(None)
        return
    order = np.argsort(keys, kind="stable")
    for places in np.split(order, np.flatnonzero(np.diff(keys[order])) + 1):
        yield int(keys[places[0]]), places
