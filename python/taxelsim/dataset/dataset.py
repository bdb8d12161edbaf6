"""A data set as arrays."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._arguments import checked_count, checked_names
from .._counts import IMAGE_UNITS
from ..errors import InputError
from .checksums import Stamp, remember, verified_files
from .column import Column, texts_of
from .isolated import IsolatedShards
from .layout import ENDS, ColumnInfo, by_shard, hdf5, layout_of, of_sensor, sensors_of
from .rows import Rows, checked_index, checked_rows
from .shards import Shards
from .windows import Windows, windows_class

CACHE_BYTES = 256 << 20


class Dataset:
    """A complete data set that `generate` wrote, of format 1 or 2.

    >>> data = taxelsim.Dataset("out")
    >>> data["data/tactile_image"][100:200]  # (100, num_rows, num_cols), counts; reads these frames only
    >>> data["meta/object_name"][3]  # of episode 3
    >>> data.windows(length=16, stride=4)  # for torch.utils.data.DataLoader

    folder: the directory. Missing shards and a damaged dataset.h5 raise InputError.
    cache_bytes: limit of the inflated chunks of compressed columns that stay in memory, per process.

    sensor: name of a sensor, for data sets of kind grasp. Its columns data/SENSOR/NAME appear as data/NAME; those of other sensors are
        hidden. Code for data sets of one sensor then works on it.
    isolated: for data sets from strangers, of format 1 above all: HDF5 reads in child processes with limits of memory and time, so that
        a file that crashes or hangs it raises InputError. Slower, as each read starts a process; needs no h5py.

    A shard is compared with its SHA-256 and the manifest when its first row is read; the SHA-256 once per process. A damaged shard, and one
    with links out of its file, raises InputError.
    Shards stay open. Uncompressed columns are memory-mapped. Any thread may read. Forked processes open the shards again, and so
    does a copy that was pickled; neither verifies again what was verified before.
    """

    def __init__(
        self, folder: str | PathLike[str], *, cache_bytes: int = CACHE_BYTES, isolated: bool = False, sensor: str | None = None
    ) -> None:
        self.folder = Path(folder).absolute()
        self.sensor = sensor
        """Name of the sensor whose columns are shown, or None."""
        self._cache_bytes = checked_count("cache_bytes", cache_bytes)
        self._isolated = isolated
        self._shards: Shards | IsolatedShards
        if not isolated:
            hdf5()  # first, so that an error about a file is never one about the package
        reader = _core.DatasetReader(self.folder, isolated)
        self._layout = layout_of(self.folder, reader)
        self.sensors = sensors_of(self._layout.columns)
        """Names of the sensors whose columns are groups, data/NAME/..., in the order of the robot; else empty."""
        if sensor is not None:
            self._layout = of_sensor(self._layout, sensor)
        if isolated:
            self._shards = IsolatedShards(reader)
            return
        self._layout = by_shard(self._layout, reader)
        self._shards = Shards(self._layout, reader, self._cache_bytes)

    def __reduce__(self) -> Any:
        state = self.folder, self._cache_bytes, verified_files(self.folder), self._identity(), self._isolated, self.sensor
        return _reopen, state

    def _identity(self) -> tuple[Any, ...]:
        return self.num_episodes, self.num_frames, *(self._layout.attributes.get(name) for name in ("seed", "scene_sha256", "policy"))

    def __repr__(self) -> str:
        return f"<Dataset {self.folder}: {self.num_episodes} episodes, {self.num_frames} frames, {len(self.columns)} columns>"

    @property
    def num_frames(self) -> int:
        """Frames of all episodes."""
        return int(self._layout.first_frames[-1])

    @property
    def num_episodes(self) -> int:
        """Episodes."""
        return int(self._layout.first_episodes[-1])

    @property
    def episode_ends(self) -> Rows:
        """(num_episodes), index of the frame after each episode."""
        return np.array(self._layout.episode_ends)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns."""
        return tuple(self._layout.columns)

    @property
    def attributes(self) -> dict[str, Any]:
        """format_version, seed, scene_sha256, policy, and the numbers of shards, episodes and frames."""
        return dict(self._layout.attributes)

    def __contains__(self, name: object) -> bool:
        return name in self._layout.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        """Number of columns."""
        return len(self.columns)

    def __getitem__(self, name: str) -> Column:
        """A column; nothing is read yet."""
        info = self._column(name)
        num_rows = self.num_episodes if info.is_per_episode else self.num_frames
        return Column(self.folder, info, num_rows, lambda rows: self._take([info], rows)[0])

    def episode(self, index: int, columns: Sequence[str] | None = None) -> dict[str, Any]:
        """One episode by name of column: arrays (frames of the episode, ...) of columns in data/, one value of columns in meta/.

        columns: names; None for all.
        """
        index = checked_index(f"{self.folder}: episode", index, self.num_episodes)
        first = self._layout.episode_ends[index - 1] if index else 0
        return self._range(self._chosen(columns, self.columns), index, int(first), int(self._layout.episode_ends[index]))

    @overload
    def frames(self, indices: int | np.integer[Any], columns: Sequence[str] | None = None) -> dict[str, Any]: ...
    @overload
    def frames(self, indices: slice | Sequence[int] | NDArray[Any], columns: Sequence[str] | None = None) -> dict[str, NDArray[Any]]: ...
    def frames(self, indices: Any, columns: Sequence[str] | None = None) -> dict[str, Any]:
        """Frames by name of column: arrays (R, ...), of columns in meta/ the values of the episodes that the frames belong to.

        indices: a slice, integers (R), a mask (num_frames), or one integer: arrays without the first axis.
        columns: names; None for all in data/.
        """
        infos = self._chosen(columns, [name for name in self.columns if name.startswith("data/")])
        place = f"{self.folder}: frames"
        is_single = isinstance(indices, int | np.integer)
        rows = np.array([checked_index(place, indices, self.num_frames)]) if is_single else checked_rows(place, indices, self.num_frames)
        values = self._values(infos, rows, lambda: np.searchsorted(self._layout.episode_ends, rows, side="right"))
        return {name: array[0] for name, array in values.items()} if is_single else values

    def windows(self, length: int, stride: int = 1, columns: Sequence[str] | None = None, *, image_unit: str = "counts") -> Windows:
        """All windows of `length` frames inside an episode, which start `stride` frames apart, as a map-style data set of PyTorch.

        columns: names; None for all in data/. Episodes shorter than `length` have no window.
        image_unit: of tactile images, "counts", int32, or "newtons" by the nominal curve of their sensor, float32.
        """
        checked_names("image_unit", image_unit, IMAGE_UNITS)
        names = [name for name in self.columns if name.startswith("data/")]
        chosen = tuple(info.name for info in self._chosen(columns, names))
        return windows_class()(self, checked_count("length", length), checked_count("stride", stride), chosen, image_unit)

    def _column(self, name: str) -> ColumnInfo:
        info = self._layout.columns.get(name) if isinstance(name, str) else None
        if info is None:
            raise InputError(f"{self.folder}: no column {name!r}{_suggestion(str(name), self.columns)}")
        return info

    def _chosen(self, names: Sequence[str] | None, default: Sequence[str]) -> list[ColumnInfo]:
        if isinstance(names, str):
            names = [names]
        return [self._column(name) for name in (default if names is None else names)]

    def _take(self, infos: list[ColumnInfo], rows: Rows) -> list[NDArray[Any]]:
        if infos[0].name == ENDS:  # shards count from their own first frame
            return [self._layout.episode_ends[rows].astype(infos[0].dtype)]
        return self._shards.take(infos, rows, per_episode=infos[0].is_per_episode)

    def _values(self, infos: list[ColumnInfo], frames: Rows, episodes: Any) -> dict[str, Any]:
        """Columns in data/ at `frames`, columns in meta/ at `episodes()`, in the order of `infos`."""
        data = [info for info in infos if not info.is_per_episode]
        values = dict(zip((info.name for info in data), self._take(data, frames), strict=True)) if data else {}
        if len(data) == len(infos):
            return values
        rows = episodes()
        for info in infos:
            if info.is_per_episode:
                values[info.name] = texts_of(self._take([info], rows)[0])
        return {info.name: values[info.name] for info in infos}

    def _range(self, infos: list[ColumnInfo], episode: int, first: int, end: int) -> dict[str, Any]:
        """Frames [first, end) of one episode; columns in meta/ have one value."""
        values = self._values(infos, np.arange(first, end), lambda: np.array([episode]))
        return {info.name: values[info.name][0] if info.is_per_episode else values[info.name] for info in infos}


def dataset_of_one_sensor(folder: str | PathLike[str], sensor: str | None = None) -> Dataset:
    """Opens a data set with the columns of one sensor: the named one, or the first. Reads in child processes. Raises InputError."""
    data = Dataset(folder, isolated=True, sensor=sensor)
    return data if sensor or not data.sensors else Dataset(folder, isolated=True, sensor=data.sensors[0])


def _suggestion(name: str, names: Sequence[str]) -> str:
    tail = name.rsplit("/", 1)[-1]
    near = [other for other in names if other.rsplit("/", 1)[-1] == tail] or difflib.get_close_matches(name, names, n=1)
    if not near:
        near = [
            other
            for other in names
            if other.rsplit("/", 1)[-1] in difflib.get_close_matches(tail, [n.rsplit("/", 1)[-1] for n in names], n=1)
        ]
    return f"; did you mean {' or '.join(map(repr, near[:3]))}?" if near else f"; the columns are {', '.join(names)}"


def _reopen(
    folder: Path, cache_bytes: int, verified: dict[str, Stamp], identity: tuple[Any, ...], isolated: bool, sensor: str | None
) -> Dataset:
    """Unpickles a data set."""
    remember(verified)
    data = Dataset(folder, cache_bytes=cache_bytes, isolated=isolated, sensor=sensor)
    if data._identity() != identity:
        raise InputError(f"{folder}: the data set is another one than when this object was pickled")
    return data
