"""Recordings in robomimic's HDF5 files."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..dataset.layout import HDF5_ERRORS, hdf5
from ..errors import Error, InputError
from .recording import BLOCK_ROWS, Block, Recording, component_names

_DEMO = "demo_"
_NOT_OBSERVATIONS = ("actions", "rewards", "dones")  # of an episode


def read_robomimic(file: Path, episode: int | None = None) -> Recording:
    """Observations, actions, rewards and dones of data/demo_N, of one episode or of all in the order of N. Needs h5py.

    Numbers of obs/NAME are called NAME.r0_c0, ... of two axes, NAME.0, ... of one; an export of taxelsim names them. Throws InputError.
    """
    h5py = hdf5()
    with _opened(file, h5py) as data:
        numbers = sorted(int(name.removeprefix(_DEMO)) for name in data if name.startswith(_DEMO) and name[len(_DEMO) :].isdigit())
        chosen = numbers if episode is None else [number for number in numbers if number == episode]
        if not chosen:
            raise InputError(f"{file}: no frames{'' if episode is None else f' of episode {episode}'}")
        about = _about(data)
        places: dict[str, tuple[str, int]] = {}
        shapes = {name: array.shape[1:] for name, array in _arrays(data[f"{_DEMO}{chosen[0]}"]).items()}
        for name, shape in shapes.items():
            names = about.get("names", {}).get(name)
            places |= {column: (name, index) for index, column in enumerate(component_names(name, shape, names))}
        units = {name: str(unit) for name, unit in about.get("units", {}).items()}

    def blocks(columns: Sequence[str]) -> Iterator[Block]:
        names = list(dict.fromkeys(places[column][0] for column in columns))
        with _opened(file, h5py) as data:
            for number in chosen:
                for flat in _flat_rows(
                    f"{file}: {_DEMO}{number}", _arrays(data[f"{_DEMO}{number}"]), {name: shapes[name] for name in names}
                ):
                    yield {column: flat[places[column][0]][:, places[column][1]] for column in columns}

    return Recording(str(file), tuple(places), blocks, units, "frame {}".format)


@contextmanager
def _opened(file: Path, h5py: Any) -> Iterator[Any]:
    """The group data of a file. Gives errors of HDF5 in one line, as InputError."""
    try:
        with h5py.File(file, "r") as opened:
            yield opened["data"]
    except Error:
        raise
    except HDF5_ERRORS as error:
        raise InputError(f"{file}: no file of robomimic: {' '.join(str(error).split())}") from error


def _about(data: Any) -> dict[str, Any]:
    """Units and settings that an export of taxelsim states."""
    try:
        about = json.loads(data.attrs["taxelsim"])
        return about if isinstance(about, dict) else {}
    except (KeyError, ValueError, TypeError):
        return {}


def _arrays(demo: Any) -> dict[str, Any]:
    """Arrays of numbers with a row per frame, by name."""
    found = {**{name: demo[name] for name in _NOT_OBSERVATIONS if name in demo}, **dict(demo["obs"])}
    return {name: array for name, array in found.items() if getattr(array, "ndim", 0) and array.dtype.kind in "biuf" and array.ndim < 4}


def _flat_rows(place: str, arrays: dict[str, Any], shapes: dict[str, tuple[int, ...]]) -> Iterator[dict[str, NDArray[np.float64]]]:
    """Arrays (R, numbers) of blocks of frames of an episode. shapes: of a row of each."""
    for name, shape in shapes.items():
        if name not in arrays or arrays[name].shape[1:] != shape:
            raise InputError(f"{place}: {name}: {arrays[name].shape if name in arrays else 'nothing'} found, (T, {shape}) as in the first")
    lengths = {name: arrays[name].shape[0] for name in shapes}
    if len(set(lengths.values())) > 1:
        raise InputError(f"{place}: {lengths} frames found, one number expected")
    for first in range(0, next(iter(lengths.values())), BLOCK_ROWS):
        parts = {name: arrays[name][first : first + BLOCK_ROWS] for name in shapes}
        yield {name: part.reshape(len(part), -1).astype(np.float64) for name, part in parts.items()}
