"""Zarr, in the layout of the replay buffers of Diffusion Policy: data/NAME with the frames of all episodes, meta/episode_ends."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .features import Feature, short_name
from .source import Source
from .staging import staged_folder
from .zarr_store import Row, ZarrStore

CHUNK_BYTES = 1 << 20  # of the array with the longest rows, before compression
CHUNKS_PER_SHARD = 16  # of version 3, where a shard is a file


def write(source: Source, out: Path, plan: dict[str, Any], report: Callable[[int], None]) -> None:
    """Writes the folder `out`. report: called with the number of frames since the last call. Throws InputError."""
    named = {"state": source.state, "action": source.action}
    named |= {short_name(name).replace(".", "_"): feature for name, feature in source.columns.items()}
    vectors: dict[str, Feature] = {name: feature for name, feature in named.items() if feature is not None}
    tactile = source.named_tactile("tactile", "_")
    names = {name: list(feature.names) for name, feature in {**vectors, **tactile}.items()} | {"timestamp": ["timestamp"]}
    stored = {**{name: source.data[feature.columns[0]] for name, feature in tactile.items()}, "timestamp": source.data["data/time"]}
    shapes = {name: (column.dtype, column.shape[1:]) for name, column in stored.items()}
    shapes |= {name: (np.dtype(np.float32), (len(feature.names),)) for name, feature in vectors.items()}
    chunk = max(1, CHUNK_BYTES // max(dtype.itemsize * int(np.prod(shape)) for dtype, shape in shapes.values()))
    rows = {name: Row(dtype, shape, chunk, {"names": names[name]}) for name, (dtype, shape) in shapes.items()}
    columns = source.frame_columns()

    def values_of(first: int, end: int) -> dict[str, NDArray[Any]]:
        found = source.frames(first, end, columns)
        values: dict[str, NDArray[Any]] = {name: found[feature.columns[0]] for name, feature in tactile.items()}
        return {**values, "timestamp": found["data/time"], **{name: feature.vectors(found) for name, feature in vectors.items()}}

    with staged_folder(out, plan) as folder:
        store = ZarrStore(folder, source, rows, chunk * CHUNKS_PER_SHARD, source.options.zarr_format)
        store.write(values_of, report)
        store.finish(plan)
