"""Tables of a recording: a CSV file, or frames of a LeRobotDataset."""

from __future__ import annotations

import csv
import difflib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError


@dataclass(frozen=True)
class Recording:
    """Named columns of numbers, all with R rows."""

    source: str  #: Of which file or folder, for messages.
    columns: dict[str, NDArray[np.float64]]  #: (R). Components of a feature are called FEATURE.NAME and, alone, NAME where no two have it.

    def column(self, name: str) -> NDArray[np.float64]:
        """(R). Throws InputError."""
        if name not in self.columns:
            near = [other for other in self.columns if other.endswith(f".{name}")] or difflib.get_close_matches(name, self.columns, n=2)
            hint = f"; did you mean {' or '.join(near)}" if near else f"; it has {', '.join(list(self.columns)[:8])}, ..."
            raise InputError(f"{self.source}: no column {name!r}{hint}")
        return self.columns[name]


def read_csv(file: Path, delimiter: str = ",") -> Recording:
    """Reads a table whose first line names its columns. Lines that begin with # are ignored. Columns with texts are left out.

    Throws InputError for rows with another number of values, and numbers that are not finite.
    """
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: {error}") from error
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(numbered) < 2:
        raise InputError(f"{file}: a line of names and at least one row expected")
    rows = list(csv.reader((line for _, line in numbered), delimiter=delimiter))
    names = [name.strip() for name in rows[0]]
    if len(set(names)) < len(names):
        raise InputError(f"{file}: column {next(name for name in names if names.count(name) > 1)!r} found twice")
    for (number, _), row in zip(numbered, rows, strict=True):
        if len(row) != len(names):
            raise InputError(f"{file}:{number}: {len(row)} values are not allowed: {len(names)} as in the first line")
    columns = {}
    for index, name in enumerate(names):
        cells = [row[index] for row in rows[1:]]
        try:
            values = np.array(cells, np.float64)
        except ValueError:
            if _is_number(cells[0]):
                wrong = next(row for row, cell in enumerate(cells) if not _is_number(cell))
                raise InputError(f"{file}:{numbered[wrong + 1][0]}: {name}: {cells[wrong]!r} is not allowed: a number") from None
            continue  # a column of texts
        if not np.isfinite(values).all():
            wrong = int(np.argmin(np.isfinite(values)))
            raise InputError(f"{file}:{numbered[wrong + 1][0]}: {name}: {cells[wrong]!r} is not allowed: a finite number")
        columns[name] = values
    return Recording(str(file), columns)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_lerobot(folder: Path, episode: int | None = None) -> Recording:
    """Reads the numbers of a LeRobotDataset of version 2 or 3, of one episode or of all. Needs pyarrow. Throws InputError."""
    try:
        import pyarrow.parquet as pq
    except ImportError as error:
        raise ImportError("LeRobotDataset needs the package pyarrow: pip install 'taxelsim[export]'") from error
    try:
        features = json.loads((folder / "meta/info.json").read_text(encoding="utf-8"))["features"]
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise InputError(f"{folder}: no LeRobotDataset: meta/info.json: {error}") from error
    names = [name for name, feature in features.items() if feature["dtype"] not in ("video", "image", "string")]
    tables = []
    chosen = None if episode is None else [("episode_index", "=", episode)]
    for file in sorted((folder / "data").glob("*/*.parquet")):
        try:
            tables.append(pq.read_table(file, columns=names, filters=chosen))
        except (OSError, ValueError, LookupError) as error:
            raise InputError(f"{file}: {' '.join(str(error).split())}") from error
    count = sum(len(table) for table in tables)
    if not count:
        raise InputError(f"{folder}: no frames{'' if episode is None else f' of episode {episode}'}")
    columns: dict[str, NDArray[np.float64]] = {}
    for name in names:
        flat = np.concatenate([_numbers(table[name]) for table in tables if len(table)])
        if not np.isfinite(flat).all():
            raise InputError(f"{folder}: {name}: frame {int(np.argwhere(~np.isfinite(flat))[0][0])} is not finite")
        parts = _component_names(features[name], flat.shape[1])
        columns |= {f"{name}.{part}" if part else name: flat[:, index] for index, part in enumerate(parts)}
    short: dict[str, list[str]] = {}
    for name in columns:
        short.setdefault(name.rsplit(".", 1)[-1], []).append(name)
    columns |= {part: columns[full[0]] for part, full in short.items() if len(full) == 1 and part not in columns}
    return Recording(str(folder), columns)


def _numbers(column: Any) -> NDArray[np.float64]:
    """(R, D) of a column of numbers, lists or lists of lists, all of one size."""
    array = column.combine_chunks()
    while hasattr(array, "flatten") and hasattr(array.type, "value_type"):
        array = array.flatten()
    numbers: NDArray[Any] = array.to_numpy(zero_copy_only=False)
    return numbers.astype(np.float64).reshape(len(column), -1)


def _component_names(feature: dict[str, Any], size: int) -> list[str]:
    """Names of the numbers of a feature: those that it has, else r0_c0, ... of two axes, 0, 1, ... of one."""
    names, shape = feature.get("names"), feature["shape"]
    if isinstance(names, dict):  # as some recorders write them: {"motors": [...]}
        names = next(iter(names.values()))
    if size == 1:
        return [""]
    if isinstance(names, list) and len(names) == size:
        return [str(name) for name in names]
    if len(shape) == 2:
        return [f"r{row}_c{col}" for row in range(shape[0]) for col in range(shape[1])]
    return [str(index) for index in range(size)]
