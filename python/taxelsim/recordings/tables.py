"""Recordings in CSV files."""

from __future__ import annotations

import csv
import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .recording import BLOCK_ROWS, Block, Recording

_Row = tuple[int, list[str]]  # number of the line, cells


def read_csv(file: Path, delimiter: str = ",") -> Recording:
    """A table whose first line names its columns. Lines that begin with # are ignored. Columns with texts are left out.

    Throws InputError; for rows with another number of values, and for cells that are no finite numbers, when the rows are read.
    """
    rows = _rows(file, delimiter)
    header, first = next(rows, None), next(rows, None)
    if header is None or first is None:
        raise InputError(f"{file}: a line of names and at least one row expected")
    names = [name.strip() for name in header[1]]
    if len(set(names)) < len(names):
        raise InputError(f"{file}: column {next(name for name in names if names.count(name) > 1)!r} found twice")
    _check_width(file, first, names)
    places = {name: index for index, name in enumerate(names) if _is_number(first[1][index])}

    def blocks(chosen: Sequence[str]) -> Iterator[Block]:
        found = itertools.islice(_rows(file, delimiter), 1, None)
        while part := list(itertools.islice(found, BLOCK_ROWS)):
            for row in part:
                _check_width(file, row, names)
            yield {name: _numbers(file, part, name, places[name]) for name in chosen}

    return Recording(str(file), tuple(places), blocks)


def _rows(file: Path, delimiter: str) -> Iterator[_Row]:
    try:
        with file.open(encoding="utf-8-sig", newline="") as stream:
            numbered = ((number, line) for number, line in enumerate(stream, 1) if line.strip() and not line.startswith("#"))
            for number, line in numbered:
                yield number, next(csv.reader([line], delimiter=delimiter))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file}: {error}") from error


def _check_width(file: Path, row: _Row, names: Sequence[str]) -> None:
    if len(row[1]) != len(names):
        raise InputError(f"{file}:{row[0]}: {len(row[1])} values are not allowed: {len(names)} as in the first line")


def _numbers(file: Path, rows: Sequence[_Row], name: str, index: int) -> NDArray[np.float64]:
    cells = [cells[index] for _, cells in rows]
    try:
        values = np.array(cells, np.float64)
    except ValueError:
        wrong = next(row for row, cell in enumerate(cells) if not _is_number(cell))
        raise InputError(f"{file}:{rows[wrong][0]}: {name}: {cells[wrong]!r} is not allowed: a number") from None
    if not np.isfinite(values).all():
        wrong = int(np.argmin(np.isfinite(values)))
        raise InputError(f"{file}:{rows[wrong][0]}: {name}: {cells[wrong]!r} is not allowed: a finite number")
    return values


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
