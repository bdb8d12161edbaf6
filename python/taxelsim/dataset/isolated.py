"""A data set that HDF5 reads in child processes, which a hostile file cannot leave."""

from __future__ import annotations

import hashlib
import threading
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .layout import ENDS, ColumnInfo, Layout
from .rows import Rows


def open_isolated(folder: Path) -> tuple[Layout, IsolatedShards]:
    """Verifies and reads what a Layout has, and opens the rows. Throws InputError."""
    reader = _core.IsolatedReader(folder)
    ends = reader.episode_ends.astype(np.int64)
    ends_info = ColumnInfo(ENDS, np.dtype(np.uint64), (), "1", "Number of frames up to the end of each episode.", (), ())
    columns = {ENDS: ends_info, **{column.name: _info_of(column) for column in reader.columns}}
    attributes = {
        "format_version": reader.format_version,
        "num_episodes": len(ends),
        "num_frames": int(ends[-1]),
        "seed": reader.seed,
        "scene_sha256": hashlib.sha256(reader.scene).hexdigest(),
        "policy": reader.policy,
    }
    # One range of rows: the reader finds the shards.
    layout = Layout(folder, attributes, columns, ends, np.array([0, len(ends)]), np.array([0, int(ends[-1])]))
    return layout, IsolatedShards(reader)


def _info_of(column: Any) -> ColumnInfo:
    dtype = np.dtype(f"S{column.text_length}" if column.type == "text" else column.type)
    names = tuple(column.value_names), tuple(column.bit_names)
    return ColumnInfo(column.name, dtype, tuple(column.shape), column.unit, column.description, *names)


class IsolatedShards:
    """As Shards. Each run of consecutive rows is one child process."""

    def __init__(self, reader: Any) -> None:
        self._reader = reader
        self._lock = threading.Lock()  # the reader is for one thread at a time

    def take(self, columns: list[ColumnInfo], rows: Rows, *, per_episode: bool) -> list[NDArray[Any]]:
        """Rows of columns that are all per episode or all per frame."""
        runs = np.split(rows, np.flatnonzero(np.diff(rows) != 1) + 1) if rows.size else []
        return [self._column(column, runs) for column in columns]

    def _column(self, column: ColumnInfo, runs: list[Rows]) -> NDArray[Any]:
        with self._lock:
            parts = [self._reader.read(column.name, int(run[0]), len(run)) for run in runs]
        values = np.concatenate(parts) if parts else np.empty(0, np.uint8)
        return values.view(column.dtype).reshape(-1, *column.shape)
