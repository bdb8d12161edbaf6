"""The shards and columns of a data set."""

from __future__ import annotations

import hashlib
from collections.abc import Container, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import _core
from ..errors import InputError
from .rows import Rows

MANIFEST = "dataset.yaml"
ENDS = "meta/episode_ends"
HDF5_ERRORS = (OSError, LookupError, RuntimeError, ValueError, TypeError, AttributeError, StopIteration)


@dataclass(frozen=True)
class ColumnInfo:
    """One column, as the manifest has it."""

    name: str
    dtype: np.dtype[Any]
    shape: tuple[int, ...]  #: Of a row.
    unit: str
    description: str
    value_names: tuple[str, ...]
    bit_names: tuple[str, ...]
    path: str  #: In the files; differs from the name in the columns of one sensor.

    @property
    def is_per_episode(self) -> bool:
        return self.name.startswith("meta/")


@dataclass(frozen=True)
class Layout:
    """Shards and columns of a data set."""

    folder: Path
    attributes: dict[str, Any]
    columns: dict[str, ColumnInfo]
    episode_ends: Rows  #: (num_episodes), frames up to the end of each episode.
    first_episodes: Rows  #: (num_shards + 1), first episode of each shard, then num_episodes.
    first_frames: Rows  #: (num_shards + 1), first frame of each shard, then num_frames.

    def shard_file(self, shard: int) -> Path:
        return self.folder / f"shard-{shard:06d}.h5"


def label_of(columns: Container[str]) -> str | None:
    """The column with the name of the object, or of the file of contact points, of each episode; None if all have the same objects."""
    return next((name for name in ("meta/contact_points", "meta/object_name") if name in columns), None)


def hdf5() -> Any:
    """The package h5py, imported when a data set is opened."""
    try:
        import h5py
    except ImportError as error:
        raise ImportError("data sets need h5py: pip install 'taxelsim[dataset]'") from error
    return h5py


def open_file(file: Path) -> Any:
    """A file of a data set, opened with h5py."""
    # Without HDF5's cache: chunks are cached after inflation by Inflated, which has one limit for all columns.
    return hdf5().File(file, "r", rdcc_nbytes=0)


def layout_of(folder: Path, reader: _core.DatasetReader) -> Layout:
    """The layout, with all rows in one range: for a reader that finds the shards by itself."""
    ends = reader.episode_ends.astype(np.int64)
    text = "Number of frames up to the end of each episode, counted from the first frame of all."
    columns = {
        ENDS: ColumnInfo(ENDS, np.dtype(np.uint64), (), "1", text, (), (), ENDS),
        **{column.name: _info_of(column) for column in reader.columns},
    }
    attributes = {
        "format_version": reader.format_version,
        "num_episodes": len(ends),
        "num_frames": int(ends[-1]),
        "num_shards": reader.num_shards,
        "policy": reader.policy,
        "scene_sha256": hashlib.sha256(reader.scene).hexdigest(),
        "seed": reader.seed,
    }
    return Layout(folder, attributes, columns, ends, np.array([0, len(ends)]), np.array([0, int(ends[-1])]))


def _info_of(column: _core.DatasetColumn) -> ColumnInfo:
    dtype = np.dtype(f"S{column.text_length}" if column.type == "text" else column.type)
    names = tuple(column.value_names), tuple(column.bit_names)
    return ColumnInfo(column.name, dtype, tuple(column.shape), column.unit, column.description, *names, column.name)


def sensors_of(columns: Iterable[str]) -> tuple[str, ...]:
    """Names of the sensors whose columns are groups, data/NAME/..., as in data sets of kind grasp; else none."""
    parts = [name.split("/") for name in columns]
    marks = ("sensor_pose", "tactile_image")  # which other groups of columns lack
    return tuple(dict.fromkeys(part[1] for part in parts if len(part) == 3 and part[0] == "data" and part[2] in marks))


def of_sensor(layout: Layout, sensor: str) -> Layout:
    """The layout with the columns data/SENSOR/NAME as data/NAME, without those of other sensors. Raises InputError for another name."""
    sensors = sensors_of(layout.columns)
    if sensor not in sensors:
        known = f"its sensors are {', '.join(sensors)}" if sensors else "its columns are not grouped by sensor"
        raise InputError(f"{layout.folder}: sensor {sensor!r}: {known}")
    columns = {}
    for name, info in layout.columns.items():
        group, _, rest = name.removeprefix("data/").partition("/")
        if not (name.startswith("data/") and group in sensors):
            columns[name] = info
        elif group == sensor:
            columns[f"data/{rest}"] = replace(info, name=f"data/{rest}")
    return replace(layout, columns=columns)


def by_shard(layout: Layout, reader: _core.DatasetReader) -> Layout:
    """The layout with the range of rows of each shard. Columns are in the order of HDF5."""
    columns = dict(sorted(layout.columns.items(), key=lambda item: item[0].split("/")))
    firsts = np.minimum(np.arange(reader.num_shards + 1) * reader.episodes_per_shard, len(layout.episode_ends))
    return replace(layout, columns=columns, first_episodes=firsts, first_frames=np.append(0, layout.episode_ends)[firsts])
