"""Arrays data/NAME of a Zarr folder, written in pieces of whole files, so that an interrupted export continues to the same bytes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numcodecs
import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.codecs import BloscCodec, BloscShuffle

from .. import __version__
from .features import SUCCESS
from .source import Source
from .staging import new_file, sync

_DONE = "done"  # in an incomplete folder: frames that are complete


@dataclass(frozen=True)
class Row:
    """One frame of an array."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    chunk: int  #: Frames of a chunk; a piece has a multiple of it.
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def num_bytes(self) -> int:
        return self.dtype.itemsize * int(np.prod(self.shape))


class ZarrStore:
    """The arrays data/NAME and meta/NAME of a folder.

    rows: arrays of data/ by name. piece: frames that are written at once. version: of the format, 2 or 3; with 3 a piece is one file.
    """

    def __init__(self, folder: Path, source: Source, rows: Mapping[str, Row], piece: int, version: int = 2) -> None:
        self._folder, self._source, self._rows, self._piece, self._version = folder, source, rows, piece, version
        self._done = int((folder / _DONE).read_text()) if (folder / _DONE).exists() else 0
        # Chunks of zeros are written as well: to compare them with zero would take a third of the time.
        with zarr.config.set({"array.write_empty_chunks": True}):
            self._root = zarr.open_group(folder, mode="a", zarr_format=2 if version == 2 else 3)
            data = self._root.require_group("data")
            if not self._done:
                for name, row in rows.items():
                    self._create(data, name, row)
            self._arrays = {name: data[name] for name in rows}

    def _create(self, data: Any, name: str, row: Row) -> None:
        storage: dict[str, Any] = {"compressors": numcodecs.Blosc("lz4", clevel=5, shuffle=numcodecs.Blosc.SHUFFLE)}
        if self._version == 3:
            codec = BloscCodec(cname="lz4", clevel=5, shuffle=BloscShuffle.shuffle)
            storage = {"compressors": codec, "shards": (self._piece, *row.shape)}
        storage |= {"shape": (self._source.num_frames, *row.shape), "chunks": (row.chunk, *row.shape), "dtype": row.dtype}
        array = data.create_array(name, overwrite=True, **storage)
        array.attrs.update(row.attributes)

    def write(self, values_of: Callable[[int, int], Mapping[str, NDArray[Any]]], report: Callable[[int], None]) -> None:
        """Writes all frames that are not there yet.

        values_of: arrays (end - first, ...) by name of the frames [first, end).
        report: called with the number of frames since its last call.
        """
        report(self._done)
        for first in range(self._done, self._source.num_frames, self._piece):
            end = min(first + self._piece, self._source.num_frames)
            for name, values in values_of(first, end).items():
                self._write(name, values, first, end)
            with new_file(self._folder / _DONE) as file:
                file.write_text(str(end))
            report(end - first)

    def _write(self, name: str, values: NDArray[Any], first: int, end: int) -> None:
        """The frames [first, end) of an array, flushed. first: a multiple of the piece."""
        files = self._files(name, first, end)
        for file in files:
            file.unlink(missing_ok=True)  # of an interrupted export, which Zarr would read to change it
        self._arrays[name][first:end] = values
        for file in files:
            sync(file)
        for folder in {file.parent for file in files}:
            sync(folder)

    def _files(self, name: str, first: int, end: int) -> list[Path]:
        """The files of the frames [first, end) of an array."""
        folder, row = self._folder / "data" / name, self._rows[name]
        if self._version == 3:
            return [folder / f"c/{first // self._piece}{'/0' * len(row.shape)}"]
        return [folder / f"{number}{'.0' * len(row.shape)}" for number in range(first // row.chunk, -(-end // row.chunk))]

    def finish(self, plan: Mapping[str, Any], attributes: Mapping[str, Any] | None = None) -> None:
        """Writes the arrays meta/NAME, with one value per episode, and attributes that say what was exported."""
        meta = self._root.require_group("meta")
        values: dict[str, NDArray[Any]] = {"episode_ends": self._source.ends}
        for name in filter(self._source.data.__contains__, (SUCCESS, "meta/object")):
            values[name.removeprefix("meta/")] = np.concatenate([part[name] for part in self._source.per_episode([name])])
        for name, array in values.items():
            meta.create_array(name, data=array, chunks=array.shape, overwrite=True)
        about = {"taxelsim": __version__, "data_set": self._source.identity(), "episodes": plan["options"]["episodes"]}
        self._root.attrs.update(about | dict(attributes or {}))
        (self._folder / _DONE).unlink()
