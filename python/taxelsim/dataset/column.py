"""Columns of a data set, read when they are indexed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import EllipsisType
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from .layout import ColumnInfo
from .rows import Rows, checked_index, checked_rows


def texts_of(values: NDArray[Any]) -> NDArray[Any]:
    """Texts of fixed length as str; numbers as they are."""
    return np.char.decode(values, "utf-8") if values.dtype.kind == "S" else values


class Column:
    """One column: reads rows when it is indexed, as h5py does. Every result is a copy. Texts are str.

    Indices: an integer, a slice, integers (R), a mask (rows), or a tuple of one of these and indices of the values of a row.
    """

    def __init__(self, folder: Path, info: ColumnInfo, num_rows: int, take: Callable[[Rows], NDArray[Any]]) -> None:
        self._place = f"{folder}: {info.name}"
        self._info = info
        self._take = take
        self.name = info.name
        self.path = info.path  #: Name in the files, which has the sensor of Dataset(sensor=...).
        self.shape = (num_rows, *info.shape)  #: (num_frames, ...), or (num_episodes, ...) of a column in meta/.
        self.dtype = info.dtype  #: Type in the file; texts are read as str.
        self.unit = info.unit
        self.description = info.description
        self.value_names = info.value_names  #: Names of the values 0, 1, ... of an enumeration or flag, else empty.
        self.bit_names = info.bit_names  #: Names of the bits of a set of flags, lowest first, else empty.

    def __repr__(self) -> str:
        return f"<Column {self.name}: {self.dtype} {self.shape}, {self.unit}>"

    def __len__(self) -> int:
        return self.shape[0]

    @overload
    def __getitem__(self, key: slice | EllipsisType | Sequence[int] | NDArray[Any]) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, key: int | np.integer[Any] | tuple[Any, ...]) -> Any: ...
    def __getitem__(self, key: Any) -> Any:
        first, *rest = (key or (...,)) if isinstance(key, tuple) else (key,)
        if first is Ellipsis:
            first, rest = slice(None), [..., *rest] if rest else []
        if isinstance(first, int | np.integer):
            values = self._rows(np.array([checked_index(self._place, first, len(self))]))[0]
            return values[tuple(rest)] if rest else values
        values = self._rows(checked_rows(self._place, first, len(self)))
        selected = slice(None), *rest
        return values[selected] if rest else values

    def _rows(self, rows: Rows) -> NDArray[Any]:
        return texts_of(self._take(rows))

    def __iter__(self) -> Iterator[Any]:
        return (self[row] for row in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False:
            raise ValueError(f"{self._place}: reading a column makes a copy")
        return np.asarray(self[:], dtype)
