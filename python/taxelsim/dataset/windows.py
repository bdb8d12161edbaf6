"""Windows over the frames of episodes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._counts import newtons_of_counts
from .provenance import Provenance
from .rows import checked_index

if TYPE_CHECKING:
    from .dataset import Dataset


class Windows:
    """Windows of consecutive frames of one episode, made by Dataset.windows(). Has the methods of a map-style data set of PyTorch, for
    torch.utils.data.DataLoader with any number of workers.

    windows[i] is a dict by name of column: arrays (length, ...) of columns in data/, one value of columns in meta/. Every array is a copy.
    Counts and all other integers that have 16 bits in the file are int32, with which libraries of tensors compute.
    """

    def __init__(self, dataset: Dataset, length: int, stride: int, columns: tuple[str, ...], image_unit: str) -> None:
        self.dataset = dataset
        self.length = length
        self.stride = stride
        self.columns = columns
        self.image_unit = image_unit
        self._infos = dataset._chosen(columns, columns)
        images = [name for name in columns if name.endswith("/tactile_image")] if image_unit == "newtons" else []
        self._newtons = _tables_of(dataset, images) if images else {}
        ends = dataset.episode_ends
        begins = np.concatenate(([0], ends[:-1])) if len(ends) else ends
        counts = np.maximum((ends - begins - length) // stride + 1, 0)
        self.episodes = np.repeat(np.arange(len(ends)), counts)  #: (len(windows)), episode of each window.
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        self.starts = begins[self.episodes] + stride * within  #: (len(windows)), first frame of each window.

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, index: int) -> dict[str, Any]:
        index = checked_index(f"{self.dataset.folder}: windows", index, len(self))
        first = int(self.starts[index])
        values = self.dataset._range(self._infos, int(self.episodes[index]), first, first + self.length)
        return {name: self._converted(name, value) for name, value in values.items()}

    def _converted(self, name: str, value: Any) -> Any:
        if name in self._newtons:
            return self._newtons[name][value]
        return value.astype(np.int32) if value.dtype in (np.uint16, np.int16) else value

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        return f"<Windows {self.dataset.folder}: {len(self)} windows of {self.length} frames, stride {self.stride}>"

    def __reduce__(self) -> Any:
        return _unpickle, (self.dataset, self.length, self.stride, self.columns, self.image_unit)


def _tables_of(dataset: Dataset, columns: list[str]) -> dict[str, NDArray[np.float32]]:
    """Newtons of each count of the tactile images in `columns`, data/tactile_image or data/SENSOR/tactile_image."""
    sensors = Provenance.of(dataset.folder).sensors()
    names = {column: dataset[column].path.removeprefix("data/").removesuffix("tactile_image").rstrip("/") for column in columns}
    return {column: newtons_of_counts(sensors[name].readout) for column, name in names.items()}


@cache
def _torch_class(base: Any) -> type[Windows]:
    return type("Windows", (Windows, base), {"__module__": Windows.__module__, "__doc__": Windows.__doc__})


def windows_class() -> type[Windows]:
    """Windows, also a torch.utils.data.Dataset if the program has imported torch. DataLoader takes either."""
    base = getattr(sys.modules.get("torch.utils.data"), "Dataset", None)
    return Windows if base is None else _torch_class(base)


def _unpickle(dataset: Dataset, length: int, stride: int, columns: tuple[str, ...], image_unit: str) -> Windows:
    return windows_class()(dataset, length, stride, columns, image_unit)
