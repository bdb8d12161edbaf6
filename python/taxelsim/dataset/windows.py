"""Windows over the frames of episodes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from .rows import checked_index

if TYPE_CHECKING:
    from .dataset import Dataset


class Windows:
    """Windows of consecutive frames of one episode, made by Dataset.windows(). Has the methods of a map-style data set of PyTorch, for
    torch.utils.data.DataLoader with any number of workers.

    windows[i] is a dict by name of column: arrays (length, ...) of columns in data/, one value of columns in meta/. Every array is a copy.
    """

    def __init__(self, dataset: Dataset, length: int, stride: int, columns: tuple[str, ...]) -> None:
        self.dataset = dataset
        self.length = length
        self.stride = stride
        self.columns = columns
        self._infos = dataset._chosen(columns, columns)
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
        return self.dataset._range(self._infos, int(self.episodes[index]), first, first + self.length)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        return f"<Windows {self.dataset.folder}: {len(self)} windows of {self.length} frames, stride {self.stride}>"

    def __reduce__(self) -> Any:
        return _unpickle, (self.dataset, self.length, self.stride, self.columns)


@cache
def _torch_class(base: Any) -> type[Windows]:
    return type("Windows", (Windows, base), {"__module__": Windows.__module__, "__doc__": Windows.__doc__})


def windows_class() -> type[Windows]:
    """Windows, also a torch.utils.data.Dataset if the program has imported torch. DataLoader takes either."""
    base = getattr(sys.modules.get("torch.utils.data"), "Dataset", None)
    return Windows if base is None else _torch_class(base)


def _unpickle(dataset: Dataset, length: int, stride: int, columns: tuple[str, ...]) -> Windows:
    return windows_class()(dataset, length, stride, columns)
