"""Recordings in Open-X-Tactile sets."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..export.oxt_rules import CAMERAS, Packed, Store, check, open_store
from .recording import BLOCK_ROWS, Block, Recording, component_names

_POSE = ["x", "y", "z", "rx", "ry", "rz"]


def read_oxt(folder: Path, episode: int | None = None) -> Recording:
    """A set of Zarr version 2, one episode or all. Needs zarr.

    Touch is called <side>_tactile_data_<group>.a0_r1_c2, a0 being functional area 0; taxels without rows a0_t3; a third axis is appended.
    Throws InputError for a folder that breaks a rule of the contract that needs no frames to be read.
    """
    store = open_store(folder)
    broken = next((faults[0] for rule, faults in check(store, reads_values=False) if faults and not rule.is_note), None)
    if broken is not None:
        raise InputError(f"{folder}: {broken}; taxelsim inspect --format oxt lists all rules")
    first, end = _range(store, episode)
    columns = {name: (array, index) for array in _numeric(store) for index, name in enumerate(_names(store, array))}
    attributes = {array: store.arrays[array].attrs.asdict() for array in _numeric(store)}
    units = {array: found["unit"] for array, found in attributes.items() if isinstance(found.get("unit"), str)}

    def blocks(chosen: Sequence[str]) -> Iterator[Block]:
        arrays = dict.fromkeys(columns[name][0] for name in chosen)
        for begin in range(first, end, BLOCK_ROWS):
            rows = min(BLOCK_ROWS, end - begin)
            flat: dict[str, NDArray[Any]] = {name: store.rows(name, begin, begin + rows).reshape(rows, -1) for name in arrays}
            yield {name: flat[columns[name][0]][:, columns[name][1]].astype(np.float64) for name in chosen}

    return Recording(str(folder), tuple(columns), blocks, units, lambda row: f"frame {first + row}")


def _range(store: Store, episode: int | None) -> tuple[int, int]:
    if episode is None:
        return 0, store.num_frames
    if not 0 <= episode < len(store.ends):
        raise InputError(f"{store.folder}: no frames of episode {episode}; it has {len(store.ends)} episodes")
    return int(store.ends[episode - 1]) if episode else 0, int(store.ends[episode])


def _numeric(store: Store) -> list[str]:
    """Arrays of numbers, without pictures."""
    return [
        name for name, array in store.arrays.items() if array.dtype.kind in "iuf" and name not in CAMERAS and not isinstance(array, Packed)
    ]


def _names(store: Store, name: str) -> list[str]:
    array = store.arrays[name]
    shape = array.shape[1:]
    if "_tactile_data_" in name:
        areas = store.arrays[name.replace("_tactile_data_", "_tactile_area_", 1)][0].tolist()
        if len(shape) == 2:
            taxels = [f"t{index}" for index in range(shape[1])]
        else:
            taxels = [part.partition(".")[2] for part in component_names("", shape[1:])]
        return [f"{name}.a{area}_{taxel}" for area in areas for taxel in taxels]
    names = array.attrs.asdict().get("names")
    return component_names(name, shape, _POSE if name.endswith("_pose") and shape == (6,) else names)
