"""Zarr, in the layout of the replay buffers of Diffusion Policy: data/NAME with the frames of all episodes, meta/episode_ends."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numcodecs
import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.codecs import BloscCodec, BloscShuffle

from .. import __version__
from .features import SUCCESS, Feature, short_name
from .source import Source
from .staging import new_file, staged_folder, sync

CHUNK_BYTES = 1 << 20  # of the array with the longest rows, before compression
CHUNKS_PER_SHARD = 16  # of version 3, where a shard is a file
_DONE = "done"  # in an incomplete folder: frames that are complete


def write(source: Source, out: Path, plan: dict[str, Any], report: Callable[[int], None]) -> None:
    """Writes the folder `out`. report: called with the number of frames since the last call. Throws InputError."""
    with staged_folder(out, plan) as folder:
        done = int((folder / _DONE).read_text()) if (folder / _DONE).exists() else 0
        store = _Store(source, folder, is_new=done == 0)
        report(done)
        for first in range(done, source.num_frames, store.piece):
            end = min(first + store.piece, source.num_frames)
            store.write(first, end)
            with new_file(folder / _DONE) as file:
                file.write_text(str(end))
            report(end - first)
        store.write_meta(plan)
        (folder / _DONE).unlink()


class _Store:
    """The arrays data/NAME. A piece is written as whole files, so that it can be written again."""

    def __init__(self, source: Source, folder: Path, *, is_new: bool) -> None:
        self._source, self._folder = source, folder
        self._version = source.options.zarr_format
        named = {"state": source.state, "action": source.action}
        named |= {short_name(name).replace(".", "_"): feature for name, feature in source.columns.items()}
        self._vectors: dict[str, Feature] = {name: feature for name, feature in named.items() if feature is not None}
        time = source.data["data/time"]
        self._tactile = source.named_tactile("tactile", "_")
        images = {name: source.data[feature.columns[0]] for name, feature in self._tactile.items()}
        rows = {**{name: (image.dtype, image.shape[1:]) for name, image in images.items()}, "timestamp": (time.dtype, time.shape[1:])}
        rows |= {name: (np.dtype(np.float32), (len(feature.names),)) for name, feature in self._vectors.items()}
        longest = max(dtype.itemsize * int(np.prod(shape)) for dtype, shape in rows.values())
        self._chunk = max(1, CHUNK_BYTES // longest)
        self.piece = self._chunk * CHUNKS_PER_SHARD
        self._root = zarr.open_group(folder, mode="a", zarr_format=self._version)
        data = self._root.require_group("data")
        if is_new:
            for name, (dtype, shape) in rows.items():
                self._create(data, name, dtype, shape)
        self._arrays = {name: data[name] for name in rows}

    def _create(self, data: Any, name: str, dtype: np.dtype[Any], shape: tuple[int, ...]) -> None:
        storage: dict[str, Any] = {"compressors": numcodecs.Blosc("lz4", clevel=5, shuffle=numcodecs.Blosc.SHUFFLE)}
        if self._version == 3:
            storage = {"compressors": BloscCodec(cname="lz4", clevel=5, shuffle=BloscShuffle.shuffle), "shards": (self.piece, *shape)}
        array = data.create_array(
            name, shape=(self._source.num_frames, *shape), chunks=(self._chunk, *shape), dtype=dtype, overwrite=True, **storage
        )
        array.attrs["names"] = list({**self._vectors, **self._tactile}[name].names) if name != "timestamp" else ["timestamp"]

    def write(self, first: int, end: int) -> None:
        """The frames [first, end), flushed. first: a multiple of `piece`."""
        columns = self._source.frames(first, end, self._source.frame_columns())
        values: dict[str, NDArray[Any]] = {name: columns[feature.columns[0]] for name, feature in self._tactile.items()}
        values["timestamp"] = columns["data/time"]
        values |= {name: feature.vectors(columns) for name, feature in self._vectors.items()}
        for name, array in values.items():
            files = self._files(name, array.ndim, first, end)
            for file in files:
                file.unlink(missing_ok=True)  # of an interrupted export, which Zarr would read to change it
            self._arrays[name][first:end] = array
            for file in filter(Path.exists, files):  # those of zeros only are not written
                sync(file)
                sync(file.parent)

    def _files(self, name: str, dimensions: int, first: int, end: int) -> list[Path]:
        """The files of [first, end) of an array."""
        folder, rest = self._folder / "data" / name, dimensions - 1
        if self._version == 3:
            return [folder / f"c/{first // self.piece}{'/0' * rest}"]
        return [folder / f"{number}{'.0' * rest}" for number in range(first // self._chunk, -(-end // self._chunk))]

    def write_meta(self, plan: dict[str, Any]) -> None:
        """The arrays meta/NAME, with one value per episode, and attributes that say what was exported."""
        meta = self._root.require_group("meta")
        values: dict[str, NDArray[Any]] = {"episode_ends": self._source.ends}
        for name in filter(self._source.data.__contains__, (SUCCESS, "meta/object")):
            values[name.removeprefix("meta/")] = np.concatenate([part[name] for part in self._source.per_episode([name])])
        for name, array in values.items():
            meta.create_array(name, data=array, chunks=array.shape, overwrite=True)
        self._root.attrs.update({"taxelsim": __version__, "data_set": self._source.identity(), "episodes": plan["options"]["episodes"]})
