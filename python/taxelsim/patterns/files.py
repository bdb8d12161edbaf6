"""Patterns of taxels from files of places and normals."""

from __future__ import annotations

import zipfile
from os import PathLike
from pathlib import Path

import numpy as np

from .._arguments import LENGTH_UNITS, checked_names
from .._core import Sensor
from ..errors import InputError, IoError
from ..recordings.tables import read_csv
from .surface import Array
from .taxels import LIKE, SensorLike, sensor_of

COLUMNS = ("x", "y", "z", "nx", "ny", "nz")
"""Columns of a CSV pattern."""


def load_pattern(
    file: str | PathLike[str],
    *,
    unit: str = "m",
    size: float | tuple[float, float] | None = None,
    name: str | None = None,
    like: SensorLike = LIKE,
) -> Sensor:
    """A sensor from a file of places and normals of taxels, in the order of the file.

    file: CSV with a line of names, of which x, y, z, nx, ny and nz are read, and lines that begin with # ignored; or NPZ with the arrays
        `positions` (T, 3) and `normals` (T, 3).
    unit: of the positions: m, mm, cm, um or inch. It is never guessed.
    size, like: as for sensor_of(), in m. name: default: that of the file without its ending.

    Raises InputError for another ending, a missing column or array, what sensor_of() refuses, and IoError for a file that cannot be read.
    """
    path = Path(file)
    factor = LENGTH_UNITS[checked_names("unit", unit, tuple(LENGTH_UNITS))[0]]
    readers = {".csv": _read_csv, ".npz": _read_npz}
    if path.suffix.lower() not in readers:
        raise InputError(f"{path}: ending {path.suffix!r} is not allowed: .csv or .npz")
    if not path.is_file():
        raise IoError(f"{path}: No such file")
    positions, normals = readers[path.suffix.lower()](path)
    try:
        return sensor_of(positions * factor, normals, size, name=path.stem if name is None else name, like=like)
    except InputError as error:
        hint = f" (unit={unit!r})" if "span" in str(error) else ""
        raise InputError(f"{path}: {error}{hint}") from error


def _read_csv(path: Path) -> tuple[Array, Array]:
    table = read_csv(path)
    missing = [column for column in COLUMNS if column not in table.names]
    if missing:
        raise InputError(f"{path}: column {missing[0]!r} is missing: {', '.join(COLUMNS)} are needed")
    values = np.concatenate([np.stack([block[column] for column in COLUMNS], axis=1) for block in table.blocks(COLUMNS)])
    return values[:, :3], values[:, 3:]


def _read_npz(path: Path) -> tuple[Array, Array]:
    found = []
    try:
        with np.load(path, allow_pickle=False) as arrays:
            for key in ("positions", "normals"):
                if key not in arrays:
                    raise InputError(f"{path}: array {key!r} is missing; it has {', '.join(arrays) or 'none'}")
                found.append(arrays[key])
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: {error} is not allowed: an NPZ file of numbers") from error
    for key, values in zip(("positions", "normals"), found, strict=True):
        if values.dtype.kind not in "fiu" or values.ndim != 2 or values.shape[1] != 3:
            raise InputError(f"{path}: {key}: {values.dtype} of shape {values.shape} is not allowed: numbers of shape (T, 3)")
    return found[0].astype(np.float64), found[1].astype(np.float64)
