"""The part of a data set that is exported, read in pieces."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_positive
from ..dataset import Dataset
from ..dataset.layout import MANIFEST, label_of
from ..errors import InputError
from ..pictures import TAXEL_COUNTS
from .features import ACTION, SUCCESS, Feature, column_of, feature_of, shown_sensors, state_of, tactile_of
from .options import Options

CACHE_BYTES = 64 << 20  # inflated chunks: an export reads each once
_EPISODES_AT_ONCE = 1 << 16
_MAX_CLOCK_ERROR = 1e-4  # s, as LeRobot tolerates
_MAX_RATIO_ERROR = 1e-6  # of the rates of the data set and of the export


@dataclass(frozen=True)
class Block:
    """Consecutive whole episodes. Frames and episodes count from the first one of the export."""

    first_episode: int
    first_frame: int
    ends: NDArray[np.int64]  #: (E), frames of the block up to the end of each episode.
    values: dict[str, NDArray[Any]]  #: Columns in data/ (F, ...), columns in meta/ (E, ...).
    windows: dict[str, NDArray[Any]] = field(
        default_factory=dict
    )  #: Columns in data/ (F, k, ...): the k frames of the data set up to each.

    @property
    def num_episodes(self) -> int:
        return len(self.ends)

    @property
    def num_frames(self) -> int:
        return int(self.ends[-1])

    @property
    def lengths(self) -> NDArray[np.int64]:
        """(E), frames of each episode."""
        return np.diff(self.ends, prepend=0)


class Source:
    """The episodes of a data set that are exported, and the columns by their role."""

    def __init__(self, folder: str | os.PathLike[str], options: Options) -> None:
        self.data = Dataset(folder, cache_bytes=CACHE_BYTES, sensor=options.sensor)
        self.options = options
        first, last = options.episodes or (0, self.data.num_episodes - 1)
        if not 0 <= first <= last < self.data.num_episodes:
            raise InputError(f"{self.data.folder}: episodes {first}..{last} is not allowed: 0..{self.data.num_episodes - 1}")
        ends = self.data.episode_ends
        self._first_episode = first
        self._first_frame = int(ends[first - 1]) if first else 0
        self._data_ends = ends[first : last + 1] - self._first_frame  # (num_episodes), frames of the data set
        self.window = self._window_length()  #: Frames of the data set for each frame of the export.
        lengths = np.diff(self._data_ends, prepend=0) // self.window
        if lengths.min() < 1:
            raise InputError(
                f"{self.data.folder}: episode {int(lengths.argmin()) + first} has less than the {self.window} frames of a window"
            )
        self.left_out = int(
            self._data_ends[-1] - self.window * lengths.sum()
        )  #: Frames of the data set after the last window of an episode.
        self.ends = np.cumsum(lengths)  #: (num_episodes), frames of the export up to the end of each episode.
        self.tactile = {sensor: tactile_of(self.data, sensor) for sensor in shown_sensors(self.data)}  #: By name of the sensor, or "".
        self.state = state_of(self.data, options.state, with_tactile=options.tactile_in_state)
        self.action = feature_of(self.data, (ACTION,)) if ACTION in self.data else None
        common = {"data/time", ACTION, *(feature.columns[0] for feature in self.tactile.values())}
        again = [name for name in options.columns if name in common]
        if again:
            raise InputError(f"columns: {again[0]} is not allowed: every export has it")
        counts = (column_of(sensor, TAXEL_COUNTS) for sensor in self.tactile)
        columns = (*filter(self.data.__contains__, counts), *options.columns)
        self.columns = {name: feature_of(self.data, (name,)) for name in columns}
        self.has_success = SUCCESS in self.data
        self._label = label_of(self.data)
        self.episode_columns = tuple(name for name in (self._label, SUCCESS) if name and name in self.data)
        """Columns in meta/ with the label and the success of each episode, where recorded."""

    @property
    def num_episodes(self) -> int:
        return len(self.ends)

    @property
    def num_frames(self) -> int:
        return int(self.ends[-1])

    def frame_columns(self) -> tuple[str, ...]:
        """Names of the columns in data/ that the features read, and the time."""
        features = [*self.tactile.values(), *filter(None, (self.state, self.action)), *self.columns.values()]
        return tuple(dict.fromkeys(("data/time", *(name for feature in features for name in feature.columns))))

    def labels(self, values: Mapping[str, NDArray[Any]]) -> list[str]:
        """Name of the object, or file of the contact points, of each episode with these columns in meta/; else all objects of the scene."""
        if self._label is not None:
            return [str(name) for name in values[self._label]]
        objects = re.findall(r"^    - name: (.*)$", self._manifest(r"^  objects:\n((?:    .*\n)+)"), re.MULTILINE)
        return [" and ".join(name.strip('"') for name in objects)] * len(values["meta/episode"])

    def tasks(self) -> tuple[list[str], NDArray[np.int32]]:
        """The different texts of the task, sorted, and the index of that of each episode (num_episodes)."""
        columns = ("meta/episode", *self.episode_columns)
        known: dict[str, int] = {}
        found = [known.setdefault(name, len(known)) for values in self.per_episode(columns) for name in self.labels(values)]
        texts = [self.task_of(name) for name in known]
        tasks = sorted(set(texts))
        return tasks, np.array([tasks.index(text) for text in texts], np.int32)[np.array(found, np.int32)]

    def task_of(self, label: str) -> str:
        """Text of the task of an episode with this label."""
        return self.options.task.replace("{scene}", self.scene_name).replace("{object}", label)

    def episode_number(self, episode: int) -> int:
        """Number in the scene of an episode of the export."""
        return int(self.data["meta/episode"][self._first_episode + episode])

    def named_tactile(self, name: str, joint: str) -> dict[str, Feature]:
        """The tactile images under `name`, followed by `joint` and the name of the sensor where each has columns of its own."""
        return {f"{name}{joint}{sensor}" if sensor else name: feature for sensor, feature in self.tactile.items()}

    def identity(self) -> dict[str, Any]:
        """What the data set is: another one has another scene, seed, number of episodes, program or device."""
        attributes = {name: value for name, value in self.data.attributes.items() if name != "num_shards"}
        return attributes | {name: self._manifest(rf"^{name}: (.*)$") for name in ("program_version", "device")}

    def _manifest(self, pattern: str) -> str:
        """The first group of a regular expression in dataset.yaml, "" if it does not match."""
        found = re.search(pattern, (self.data.folder / MANIFEST).read_text(encoding="utf-8"), re.MULTILINE)
        return found[1].strip('"') if found else ""

    @cached_property
    def _data_rate(self) -> float:
        return self.data_rate()

    @cached_property
    def scene_name(self) -> str:
        return self._manifest(r"^scene: \|\n(?:  .*\n)*?  name: (.*)$")

    @cached_property
    def sensor_name(self) -> str:
        return self._manifest(r'^sensor: \{name: ("[^"]*")')

    def per_episode(self, names: Iterable[str]) -> Iterator[dict[str, NDArray[Any]]]:
        """Columns in meta/, some episodes at a time. Opens each shard, which verifies its checksum."""
        for first in range(0, self.num_episodes, _EPISODES_AT_ONCE):
            rows = slice(self._first_episode + first, self._first_episode + min(first + _EPISODES_AT_ONCE, self.num_episodes))
            yield {name: self.data[name][rows] for name in names}

    def frames(self, first: int, end: int, columns: Iterable[str]) -> dict[str, NDArray[Any]]:
        """Columns in data/ of the frames [first, end). Throws InputError for a NaN or an infinite number."""
        place = slice(self._first_frame + first, self._first_frame + end)
        values = self.data.frames(place, tuple(columns))
        for name, array in values.items():
            if array.dtype.kind == "f" and not np.isfinite(array).all():
                wrong = np.argwhere(~np.isfinite(array))[0]
                raise InputError(
                    f"{self.data.folder}: {name}: {array[tuple(wrong)]} found in frame {place.start + wrong[0]}, a finite number needed"
                )
        return values

    def parts(self, max_frames: int, first: int = 0, end: int | None = None) -> Iterator[tuple[int, int]]:
        """The episodes [first, end) in ranges of whole episodes with at most `max_frames` frames, or one longer episode."""
        end = self.num_episodes if end is None else end
        while first < end:
            begin = int(self.ends[first - 1]) if first else 0
            last = int(np.searchsorted(self.ends[first:end], begin + max_frames, side="right")) + first
            last = max(last, first + 1)
            yield first, last
            first = last

    def block(self, first: int, end: int, columns: Iterable[str]) -> Block:
        """The episodes [first, end) with columns in data/ and meta/, with the frames of the data set."""
        begin = int(self._data_ends[first - 1]) if first else 0
        names = tuple(columns)
        values = self.frames(begin, int(self._data_ends[end - 1]), [name for name in names if name.startswith("data/")])
        rows = slice(self._first_episode + first, self._first_episode + end)
        values |= {name: self.data[name][rows] for name in names if name.startswith("meta/")}
        return Block(first, begin, self._data_ends[first:end] - begin, values)

    def windowed(self, block: Block, columns: Iterable[str]) -> Block:
        """The frames of the export of a block: the last of each window of frames of the data set.

        columns: whose windows are kept as well. Frames after the last whole window of an episode are left out.
        """
        if self.window == 1:
            return block
        counts = block.lengths // self.window
        begins = np.repeat(block.ends - block.lengths - self.window * (np.cumsum(counts) - counts), counts)
        rows = (begins + self.window * np.arange(counts.sum()))[:, None] + np.arange(self.window)  # (F, window)
        values = {name: array[rows[:, -1]] if name.startswith("data/") else array for name, array in block.values.items()}
        begin = int(self.ends[block.first_episode - 1]) if block.first_episode else 0
        return Block(block.first_episode, begin, np.cumsum(counts), values, {name: block.values[name][rows] for name in columns})

    def _window_length(self) -> int:
        if self.options.frame_rate is None:
            return 1
        found, wanted = self.data_rate(), checked_positive("frame_rate", self.options.frame_rate)
        length = round(found / wanted)
        if length < 1 or abs(found / wanted - length) > _MAX_RATIO_ERROR:
            examples = ", ".join(f"{found / k:.6g}" for k in (2, 4, 5, 10))
            raise InputError(f"frame_rate: {wanted:g} is not allowed: {found:g} frames/s of the data set by an integer, such as {examples}")
        return length

    def frame_rate(self) -> float:
        """Frames per second of the export. Throws InputError."""
        return self.data_rate() if self.options.frame_rate is None else _rounded(self.options.frame_rate)

    def data_rate(self) -> float:
        """Frames per second of the data set, from the first two frames of the first episode with two. Throws InputError."""
        longer = np.flatnonzero(np.diff(self._data_ends, prepend=0) > 1)
        if not longer.size:
            raise InputError(f"{self.data.folder}: no episode has two frames, so that there is no frame rate")
        first = int(self._data_ends[longer[0] - 1]) if longer[0] else 0
        times = self.frames(first, first + 2, ["data/time"])["data/time"]
        return _rounded(float(1 / (times[1] - times[0])))

    def success(self) -> dict[str, Any]:
        """Number of episodes, of those that met the task of their scene, and the rate; empty where the scene has no task."""
        if not self.has_success:
            return {}
        met = sum(int((part[SUCCESS] == 1).sum()) for part in self.per_episode([SUCCESS]))
        return {"success": {"episodes": self.num_episodes, "successes": met, "rate": met / self.num_episodes}}

    def check_clock(self, block: Block) -> None:
        """Refuses frames of the data set that are not 1 / data_rate() apart."""
        rate = self._data_rate
        indices = np.arange(block.num_frames) - np.repeat(block.ends - block.lengths, block.lengths)
        errors = np.abs(block.values["data/time"] - indices / rate)
        if errors.max() > _MAX_CLOCK_ERROR:
            frame = int(errors.argmax())
            found, expected = block.values["data/time"][frame], indices[frame] / rate
            raise InputError(
                f"{self.data.folder}: data/time: {found} s found in frame {self._first_frame + block.first_frame + frame}, {expected} s "
                f"expected at {rate} frames/s: the format needs a constant rate"
            )


def _rounded(rate: float) -> float:
    """An integer where the rate is close to one."""
    return round(rate) if abs(rate - round(rate)) < rate * 1e-6 else rate
