"""Rows of a data set that HDF5 reads in child processes, which a hostile file cannot leave."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .layout import ColumnInfo
from .rows import Rows


class IsolatedShards:
    """As Shards. Each run of consecutive rows is one child process."""

    def __init__(self, reader: _core.DatasetReader) -> None:
        self._reader = reader
        self._lock = threading.Lock()  # the reader is for one thread at a time

    def take(self, columns: list[ColumnInfo], rows: Rows, *, per_episode: bool) -> list[NDArray[Any]]:
        """Rows of columns that are all per episode or all per frame."""
        runs = np.split(rows, np.flatnonzero(np.diff(rows) != 1) + 1) if rows.size else []
        return [self._column(column, runs) for column in columns]

    def _column(self, column: ColumnInfo, runs: list[Rows]) -> NDArray[Any]:
        with self._lock:
            parts = [self._reader.read(column.path, int(run[0]), len(run)) for run in runs]
        values = np.concatenate(parts) if parts else np.empty(0, np.uint8)
        return values.view(column.dtype).reshape(-1, *column.shape)
