"""Recordings in LeRobotDatasets."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .recording import BLOCK_ROWS, Block, Recording, component_names

_EPISODE = "episode_index"
_NOT_NUMBERS = ("video", "image", "string")
_UNITS = {"timestamp": "s"}  # of the format


def read_lerobot(folder: Path, episode: int | None = None, windows: Sequence[str] = ()) -> Recording:
    """The numbers of a LeRobotDataset of version 2 or 3, of one episode or of all. Needs pyarrow.

    windows: features (k, ...) whose first axis is time, all with the same k. Each frame has then k rows; features that are no windows
    repeat in them, and a window's time is such a feature of shape (k). Throws InputError.
    """
    try:
        import pyarrow.parquet
    except ImportError as error:
        raise ImportError("LeRobotDataset needs the package pyarrow: pip install 'taxelsim[export]'") from error
    del pyarrow
    try:
        info = json.loads((folder / "meta/info.json").read_text(encoding="utf-8"))
        features = {name: feature for name, feature in info["features"].items() if feature["dtype"] not in _NOT_NUMBERS}
    except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise InputError(f"{folder}: no LeRobotDataset: meta/info.json: {error}") from error
    length = _window_length(folder, features, windows)
    places = {
        column: (name, index)
        for name, feature in features.items()
        for index, column in enumerate(_columns(name, feature, is_window=name in windows))
    }

    def blocks(chosen: Sequence[str]) -> Iterator[Block]:
        names = list(dict.fromkeys(places[column][0] for column in chosen))
        is_empty = True
        for flat in _flat_rows(folder, names, episode):
            is_empty = False
            rows = {name: _spread(values, length, is_window=name in windows) for name, values in flat.items()}
            yield {column: rows[places[column][0]][:, places[column][1]] for column in chosen}
        if is_empty:
            raise InputError(f"{folder}: no frames{'' if episode is None else f' of episode {episode}'}")

    return Recording(str(folder), tuple(places), blocks, _UNITS | _own_units(folder), "frame {}".format)


def _own_units(folder: Path) -> dict[str, str]:
    """Units of features that an export of taxelsim states."""
    try:
        units = json.loads((folder / "meta/taxelsim.json").read_text(encoding="utf-8"))["units"]
        return {str(name): str(unit) for name, unit in units.items()}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return {}


def _window_length(folder: Path, features: Mapping[str, Any], windows: Sequence[str]) -> int:
    lengths = {}
    for name in windows:
        if name not in features:
            raise InputError(f"{folder}: no feature {name!r}; it has {', '.join(features)}")
        lengths[name] = features[name]["shape"][0]
    if len(set(lengths.values())) > 1:
        raise InputError(f"{folder}: windows: {lengths} is not allowed: one length")
    return int(next(iter(lengths.values()), 1))


def _columns(name: str, feature: Mapping[str, Any], *, is_window: bool) -> list[str]:
    names, shape = feature.get("names"), feature["shape"]
    return component_names(name, shape[1:], names) if is_window else component_names(name, shape, names)


def _flat_rows(folder: Path, names: Sequence[str], episode: int | None) -> Iterator[dict[str, NDArray[np.float64]]]:
    """Features (R, numbers) of blocks of frames."""
    import pyarrow as pa
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    columns = list(names) if episode is None else list(dict.fromkeys((*names, _EPISODE)))
    for file in sorted((folder / "data").glob("*/*.parquet")):
        try:
            with pq.ParquetFile(file) as table:
                for batch in table.iter_batches(BLOCK_ROWS, columns=columns):
                    if episode is not None:
                        batch = batch.filter(pc.equal(batch[_EPISODE], episode))
                    if len(batch):
                        yield {name: _numbers(pa.chunked_array([batch[name]])) for name in names}
        except (OSError, ValueError, LookupError) as error:
            raise InputError(f"{file}: {' '.join(str(error).split())}") from error


def _spread(values: NDArray[np.float64], length: int, *, is_window: bool) -> NDArray[np.float64]:
    """(R, numbers) as rows (R length, numbers), of a window (R length, numbers / length)."""
    return values.reshape(len(values) * length, -1) if is_window else np.repeat(values, length, axis=0)


def _numbers(column: Any) -> NDArray[np.float64]:
    """(R, D) of a column of numbers, lists or lists of lists, all of one size."""
    array = column.combine_chunks()
    while hasattr(array, "flatten") and hasattr(array.type, "value_type"):
        array = array.flatten()
    numbers: NDArray[Any] = array.to_numpy(zero_copy_only=False)
    return numbers.astype(np.float64).reshape(len(column), -1)
