"""Open shards of one process, and the rows in them."""

from __future__ import annotations

import mmap
import os
import threading
from collections import OrderedDict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..errors import InputError, IoError
from .checksums import is_verified, remember, stamp_of
from .layout import HDF5_ERRORS, ColumnInfo, Layout, open_file
from .rows import Rows, groups

MAX_OPEN_SHARDS = 128  # two file descriptors each; processes may have 1024 by default


class Inflated:
    """Inflated chunks, the least recently used ones removed beyond a limit in bytes."""

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._num_bytes = 0
        self._chunks: OrderedDict[tuple[int, str, int], NDArray[Any]] = OrderedDict()
        self._lock = threading.Lock()

    def find(self, key: tuple[int, str, int]) -> NDArray[Any] | None:
        with self._lock:
            chunk = self._chunks.get(key)
            if chunk is not None:
                self._chunks.move_to_end(key)
            return chunk

    def add(self, key: tuple[int, str, int], chunk: NDArray[Any]) -> None:
        with self._lock:
            if key in self._chunks or chunk.nbytes > self._max_bytes:
                return
            self._chunks[key] = chunk
            self._num_bytes += chunk.nbytes
            while self._num_bytes > self._max_bytes:
                self._num_bytes -= self._chunks.popitem(last=False)[1].nbytes


class Shard:
    """One open shard. Uncompressed columns are memory-mapped; of compressed ones whole chunks are read."""

    def __init__(self, layout: Layout, reader: _core.DatasetReader, number: int, inflated: Inflated) -> None:
        self._number = number
        self._file = layout.shard_file(number)
        self._inflated = inflated
        self._columns: dict[str, Any] = {}  # arrays, or h5py datasets of compressed columns
        if not self._file.is_file():
            problem = "is not a regular file" if self._file.exists() else "the shard is missing; run generate again to write it"
            raise InputError(f"{self._file}: {problem}")
        stamp = stamp_of(self._file)
        reader.check_shard(number, contents=not is_verified(self._file))
        remember({os.fspath(self._file): stamp})
        try:
            self._hdf5 = open_file(self._file)
            with self._file.open("rb") as stream:
                self._bytes = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
        except HDF5_ERRORS as error:
            raise InputError(f"{self._file}: not a shard that HDF5 can read: {error}") from error

    def take(self, column: ColumnInfo, rows: Rows) -> NDArray[Any]:
        """Rows of a column, counted from the first one of the shard. A copy."""
        source = self._columns.get(column.path)
        if source is None:
            source = self._columns[column.path] = self._open(column.path)
        if isinstance(source, np.ndarray):
            taken: NDArray[Any] = source[rows]
            return taken
        chunk_rows = source.chunks[0]
        result = np.empty((len(rows), *column.shape), column.dtype)
        numbers = rows // chunk_rows
        for number, places in groups(numbers):
            result[places] = self._chunk(source, column.path, number)[rows[places] - number * chunk_rows]
        return result

    def _open(self, name: str) -> Any:
        try:
            data = self._hdf5[name]
            return data if data.chunks else np.ndarray(data.shape, data.dtype, buffer=self._bytes, offset=data.id.get_offset())
        except HDF5_ERRORS as error:
            raise InputError(f"{self._file}: column {name}: HDF5 cannot open it: {error}") from error

    def _chunk(self, data: Any, name: str, number: int) -> NDArray[Any]:
        key = self._number, name, number
        chunk = self._inflated.find(key)
        if chunk is None:
            first = number * data.chunks[0]
            try:
                chunk = data[first : first + data.chunks[0]]
            except HDF5_ERRORS as error:
                raise IoError(f"{self._file}: column {name}: HDF5 cannot read rows from {first}: {error}") from error
            self._inflated.add(key, chunk)
        return chunk


class Shards:
    """Shards of one process, opened when they are first read. A forked process opens them again."""

    def __init__(self, layout: Layout, reader: _core.DatasetReader, cache_bytes: int) -> None:
        self._layout = layout
        self._reader = reader
        self._cache_bytes = cache_bytes
        self._reset()

    def _reset(self) -> None:
        self._process = os.getpid()
        self._lock = threading.Lock()
        self._inflated = Inflated(self._cache_bytes)
        self._open: OrderedDict[int, Shard] = OrderedDict()

    def _shard(self, number: int) -> Shard:
        if self._process != os.getpid():
            self._reset()
        with self._lock:
            shard = self._open.get(number)
            if shard is None:
                shard = self._open[number] = Shard(self._layout, self._reader, number, self._inflated)
                if len(self._open) > MAX_OPEN_SHARDS:
                    self._open.popitem(last=False)  # closed when no other thread reads it any more
            else:
                self._open.move_to_end(number)
            return shard

    def take(self, columns: list[ColumnInfo], rows: Rows, *, per_episode: bool) -> list[NDArray[Any]]:
        """Rows of columns that are all per episode or all per frame."""
        firsts = self._layout.first_episodes if per_episode else self._layout.first_frames
        parts = list(groups(np.searchsorted(firsts, rows, side="right") - 1))
        if len(parts) == 1:
            shard, first = self._shard(parts[0][0]), firsts[parts[0][0]]
            return [shard.take(column, rows - first) for column in columns]
        results = [np.empty((len(rows), *column.shape), column.dtype) for column in columns]
        for number, places in parts:
            shard, local = self._shard(number), rows[places] - firsts[number]
            for column, result in zip(columns, results, strict=True):
                result[places] = shard.take(column, local)
        return results
