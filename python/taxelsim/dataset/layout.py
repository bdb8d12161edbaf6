"""What dataset.h5, the view over all shards, says about a data set: its shards and columns."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .checksums import verify
from .rows import Rows

FORMATS = (1, 2)
MANIFEST = "dataset.yaml"
MAX_MANIFEST_BYTES = 24 << 20  # as the program has it
ENDS = "meta/episode_ends"
HDF5_ERRORS = (OSError, LookupError, RuntimeError, ValueError, TypeError, AttributeError, StopIteration)


@dataclass(frozen=True)
class ColumnInfo:
    """One column, from its attributes."""

    name: str
    dtype: np.dtype[Any]
    shape: tuple[int, ...]  #: Of a row.
    unit: str
    description: str
    value_names: tuple[str, ...]
    bit_names: tuple[str, ...]

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


def label_of(columns: Container[str]) -> str:
    """The column that names what touches in each episode: the object, or the file of recorded contact points."""
    return "meta/contact_points" if "meta/contact_points" in columns else "meta/object_name"


def hdf5() -> Any:
    """The package h5py, imported when a data set is opened."""
    try:
        import h5py
    except ImportError as error:
        raise ImportError("data sets need h5py: pip install 'taxelsim[dataset]'") from error
    return h5py


def text_of(value: Any) -> str:
    """A text of format 1 or 2."""
    return value.decode() if isinstance(value, bytes) else str(value)


def attributes_of(item: Any) -> dict[str, Any]:
    """Attributes as str, int and tuples of str."""
    result: dict[str, Any] = {}
    for name, value in item.attrs.items():
        if isinstance(value, np.ndarray):
            result[name] = tuple(text_of(text) for text in value.tolist())
        else:
            result[name] = int(value) if isinstance(value, np.integer) else text_of(value)
    return result


def open_file(file: Path) -> Any:
    """A file of a data set, opened with h5py."""
    # Without HDF5's cache: chunks are cached after inflation by Inflated, which has one limit for all columns.
    return hdf5().File(file, "r", rdcc_nbytes=0)


def read_layout(folder: Path) -> Layout:
    """Verifies and reads dataset.h5, and finds the shards. Throws InputError."""
    hdf5()  # first, so that an error about a file is never one about the package
    view = folder / "dataset.h5"
    version = _format_of(folder)
    if not view.is_file():
        raise InputError(f"{folder}: the data set is not complete: it has no dataset.h5; run generate again to resume it")
    if version > 1:
        verify(view)
    try:
        with open_file(view) as file:
            layout = _layout_of(folder, file)
    except HDF5_ERRORS as error:
        raise InputError(f"{view}: not a view that HDF5 can read: {error}") from error
    if layout.attributes["format_version"] != version:
        raise InputError(f"{view}: format_version: {layout.attributes['format_version']} found, {version} expected as in {MANIFEST}")
    for shard in range(len(layout.first_frames) - 1):
        if not layout.shard_file(shard).is_file():
            raise InputError(f"{layout.shard_file(shard)}: the shard is missing; run generate again to write it")
    return layout


def _format_of(folder: Path) -> int:
    """The format of a data set, from its manifest, before HDF5 opens a file."""
    manifest = folder / MANIFEST
    try:
        if manifest.exists() and (not manifest.is_file() or manifest.stat().st_size > MAX_MANIFEST_BYTES):
            raise InputError(f"{manifest}: not a regular file of at most {MAX_MANIFEST_BYTES} bytes")
        text = manifest.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{folder}: no data set: it has no {MANIFEST}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{manifest}: {error}") from error
    found = re.search(r"^format_version: *(\d+)$", text, re.MULTILINE)
    if found is None:
        raise InputError(f"{manifest}: format_version is missing")
    if int(found[1]) not in FORMATS:
        raise InputError(f"{manifest}: format_version: {found[1]} found, {FORMATS[0]} to {FORMATS[-1]} allowed")
    return int(found[1])


def _layout_of(folder: Path, file: Any) -> Layout:
    columns: dict[str, ColumnInfo] = {}

    def add(name: str, item: Any) -> None:
        if isinstance(item, hdf5().Dataset):
            texts = attributes_of(item)
            names = texts.get("value_names", ()), texts.get("bit_names", ())
            columns[name] = ColumnInfo(name, item.dtype, item.shape[1:], texts["unit"], texts["description"], *names)

    file.visititems(add)
    ends = file[ENDS][:].astype(np.int64)
    firsts = [_first_rows(file, "data/"), _first_rows(file, "meta/")]
    return Layout(folder, attributes_of(file), columns, ends, first_episodes=firsts[1], first_frames=firsts[0])


def _first_rows(file: Any, group: str) -> NDArray[np.int64]:
    """First row of each shard in the columns of a group, then the number of rows."""
    column = next(item for item in file[group].values() if isinstance(item, hdf5().Dataset) and item.is_virtual)
    starts = sorted(source.vspace.get_select_bounds()[0][0] for source in column.virtual_sources())
    return np.array([*starts, column.shape[0]], np.int64)
