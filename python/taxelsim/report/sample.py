"""Frames that a report is computed from: all of them, or blocks that are evenly spaced over a large data set."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..dataset import Dataset

NUM_BLOCKS = 64  # of a sample
BLOCK_FRAMES = 16384  # read at once


def blocks_of(num_frames: int, max_frames: int) -> list[tuple[int, int]]:
    """Ranges [first, end) of frames: everything in steps of BLOCK_FRAMES, or NUM_BLOCKS ranges with max_frames frames in all."""
    if num_frames <= max_frames:
        return [(first, min(first + BLOCK_FRAMES, num_frames)) for first in range(0, num_frames, BLOCK_FRAMES)]
    count = min(NUM_BLOCKS, max_frames)
    edges = [k * max_frames // count for k in range(count + 1)]  # without the frames that are left out
    skipped = [k * (num_frames - max_frames) // max(1, count - 1) for k in range(count)]  # before each block
    return [(first + gap, end + gap) for first, end, gap in zip(edges, edges[1:], skipped, strict=False)]


class Sample:
    """Columns of the sampled frames, and of the episodes that these belong to."""

    def __init__(self, data: Dataset, max_frames: int) -> None:
        self.data = data
        self.blocks = blocks_of(data.num_frames, max_frames)
        self.num_frames = sum(end - first for first, end in self.blocks)
        ends = data.episode_ends
        spans = [(np.searchsorted(ends, first, "right"), np.searchsorted(ends, end - 1, "right") + 1) for first, end in self.blocks]
        rows = [np.arange(first, end) for first, end in spans]
        self.episodes: NDArray[np.int64] = np.unique(np.concatenate(rows)) if rows else np.empty(0, np.int64)
        """(E,), rows of the episodes."""

    def frames(self, name: str) -> Iterator[NDArray[np.float64]]:
        """Values of a column in data/, one block (B, ...) after the other."""
        for first, end in self.blocks:
            yield np.asarray(self.data[name][first:end])

    def column(self, name: str) -> NDArray[np.float64]:
        """(K, ...) values of all sampled frames, or of all sampled episodes for a column in meta/."""
        if name.startswith("meta/"):
            return np.asarray(self.data[name][self.episodes])
        return np.concatenate(list(self.frames(name)))
