"""LeRobotDataset v3.0: frames in Parquet files, each with a Parquet file of its episodes and their statistics."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from .. import __version__
from ..errors import InputError
from . import statistics
from .array_video import ArrayVideo
from .features import SUCCESS, Feature, short_name
from .source import Block, Source
from .staging import new_file, staged_folder, write_json
from .touch_features import POINT, WINDOW_TIME, about_touch, points_of, windows_of, wrenches_of

FILE_BYTES = 100 << 20  # of a file with frames, before compression; the format's default limit of a file
CHUNK_FILES = 1000  # files of a folder chunk-NNN
BLOCK_FRAMES = 1 << 14  # frames of a row group, that are in memory at once
VIDEO_FRAMES = 1 << 15  # of a file, with videos: the encoder keeps the index of a video in memory until it is complete
_INDICES = {"timestamp": "float32", "frame_index": "int64", "episode_index": "int64", "index": "int64", "task_index": "int64"}
_NAME = "chunk-{chunk_index:03d}/file-{file_index:03d}"


def write(source: Source, out: Path, plan: dict[str, Any], report: Callable[[int], None]) -> None:
    """Writes the folder `out`. report: called with the number of frames since the last call. Throws InputError."""
    tables = _Tables(source)
    with staged_folder(out, plan) as folder:
        total = {name: statistics.Total() for name in tables.features}
        frames_per_file = max(BLOCK_FRAMES, FILE_BYTES // tables.bytes_per_frame)
        if tables.video:
            frames_per_file = min(frames_per_file, VIDEO_FRAMES)
        for number, (first, end) in enumerate(source.parts(frames_per_file)):
            episodes = folder / "meta/episodes" / _file_name(number)
            if episodes.exists():
                report(int(source.ends[end - 1] - (source.ends[first - 1] if first else 0)))
            else:
                _write_part(tables, folder, number, (first, end), report)
            _add_statistics(total, episodes)
        _write_tasks(folder / "meta/tasks.parquet", tables.tasks)
        write_json(folder / "meta/stats.json", {name: tables.shaped(name, values.result()) for name, values in total.items()})
        write_json(folder / "meta/info.json", tables.info())
        about = {"taxelsim": __version__, **source.identity(), "episodes": plan["options"]["episodes"], **source.success()}
        about |= about_touch(source, source.options.tactile_key, tables.windows, tables.points)
        write_json(folder / "meta/taxelsim.json", about | (tables.video.about() if tables.video else {}))


def _file_name(number: int, suffix: str = ".parquet") -> str:
    return _NAME.format(chunk_index=number // CHUNK_FILES, file_index=number % CHUNK_FILES) + suffix


def _write_part(tables: _Tables, folder: Path, number: int, part: tuple[int, int], report: Callable[[int], None]) -> None:
    """The frames, videos and episodes of a file. That of the episodes gets its name last: where it exists, all are complete."""
    with (
        new_file(folder / "meta/episodes" / _file_name(number)) as episodes_file,
        tables.video.files(folder / "videos", _file_name(number, ".mp4")) if tables.video else nullcontext() as film,
        new_file(folder / "data" / _file_name(number)) as file,
        # Dictionaries make files of measured numbers larger and take most of the time.
        pq.ParquetWriter(file, tables.schema, compression="snappy", use_dictionary=False) as writer,
        ExitStack() as stack,
    ):
        episodes: pq.ParquetWriter | None = None
        begin = int(tables.source.ends[part[0] - 1]) if part[0] else 0
        for first, end in tables.source.parts(max(1, BLOCK_FRAMES // tables.source.window), *part):
            block = tables.block(first, end)
            arrays = tables.arrays(block)
            writer.write_table(tables.frames(arrays))
            measures = {name: statistics.of_episodes(array, block.ends) for name, array in arrays.items()}
            if tables.video and film:
                counts = tables.video.counts(block)
                film(counts)
                measures |= tables.video.statistics(counts, block.ends)
            rows = tables.episodes(block, measures, number, begin)
            if episodes is None:
                episodes = stack.enter_context(pq.ParquetWriter(episodes_file, rows.schema, compression="snappy"))
            episodes.write_table(rows)
            report(block.num_frames)


def _add_statistics(total: dict[str, statistics.Total], file: Path) -> None:
    with pq.ParquetFile(file) as episodes:
        for group in range(episodes.num_row_groups):
            table = episodes.read_row_group(group)
            for name, values in total.items():
                columns = {measure: table[f"stats/{name}/{measure}"].to_pylist() for measure in statistics.MEASURES}
                values.add({measure: np.array(column, np.float64).reshape(len(column), -1) for measure, column in columns.items()})


def _write_tasks(file: Path, tasks: list[str]) -> None:
    """A table as pandas writes it, with the texts as index: the reader looks tasks up by it."""
    index = {"name": None, "field_name": "__index_level_0__", "pandas_type": "unicode", "numpy_type": "object", "metadata": None}
    column = {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": None}
    pandas = {"index_columns": ["__index_level_0__"], "column_indexes": [], "columns": [column, index], "pandas_version": "2.2.0"}
    table = pa.table({"task_index": pa.array(range(len(tasks)), pa.int64()), "__index_level_0__": pa.array(tasks)})
    with new_file(file) as temporary:
        pq.write_table(table.replace_schema_metadata({"pandas": json.dumps(pandas)}), temporary)


class _Tables:
    """Frames and episodes as tables."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.rate = source.frame_rate()
        named = {"observation.state": source.state, "action": source.action}
        named |= {f"observation.{short_name(name)}": feature for name, feature in source.columns.items()}
        named = {**source.named_tactile(_checked_key(source.options.tactile_key, named), "."), **named}
        key, wrenches = source.options.tactile_key, wrenches_of(source)
        self.vectors: dict[str, Feature] = {name: feature for name, feature in named.items() if feature is not None} | wrenches
        self.windows, self.points = windows_of(source, key, wrenches), points_of(source, key)
        wrench_columns = [name for feature in wrenches.values() for name in feature.columns]
        self.columns = tuple(dict.fromkeys((*source.frame_columns(), *wrench_columns, "meta/episode", *source.episode_columns)))
        self.flags = {"next.done": "bool"} | ({"next.reward": "float32", "next.success": "bool"} if source.has_success else {})
        self.tasks, self._task_indices = source.tasks()
        self.video = _video_of(source, self.rate)
        self._numbers = self._features()
        self._videos = {key: self.video.feature() for key in self.video.keys} if self.video else {}
        self.features = self._numbers | self._videos
        self.schema = pa.schema([(name, _arrow_type(feature)) for name, feature in self._numbers.items()])
        self.bytes_per_frame = sum(4 * math.prod(feature["shape"]) for feature in self._numbers.values())

    def _tasks_of(self, block: Block) -> NDArray[np.int32]:
        return self._task_indices[block.first_episode : block.first_episode + block.num_episodes]

    def _features(self) -> dict[str, dict[str, Any]]:
        features = {name: _number_feature((), feature.names) for name, feature in self.vectors.items()}
        features |= {name: _number_feature((self.source.window,), feature.names) for name, feature in self.windows.items()}
        features |= {name: _number_feature((len(points.places),), POINT) for name, points in self.points.items()}
        if self.windows:
            features[WINDOW_TIME] = {"dtype": "float32", "shape": [self.source.window], "names": None}
        return features | {name: {"dtype": dtype, "shape": [1], "names": None} for name, dtype in (self.flags | _INDICES).items()}

    def block(self, first: int, end: int) -> Block:
        """The episodes [first, end), with the frames of the export."""
        block = self.source.block(first, end, self.columns)
        self.source.check_clock(block)
        return self.source.windowed(block, (name for feature in self.windows.values() for name in feature.columns))

    def arrays(self, block: Block) -> dict[str, NDArray[Any]]:
        """(F, D) of each feature."""
        first, lengths = block.first_frame, block.lengths
        frame = np.arange(block.num_frames) - np.repeat(block.ends - lengths, lengths)
        episode = np.repeat(np.arange(block.num_episodes), lengths)
        is_last = np.zeros(block.num_frames, np.bool_)
        is_last[block.ends - 1] = True
        arrays: dict[str, NDArray[Any]] = {name: feature.vectors(block.values) for name, feature in self.vectors.items()}
        arrays |= {name: feature.vectors(block.windows).reshape(block.num_frames, -1) for name, feature in self.windows.items()}
        arrays |= {name: points.values(block) for name, points in self.points.items()}
        arrays["next.done"] = is_last
        if SUCCESS in self.columns:
            arrays["next.success"] = is_last & (block.values[SUCCESS][episode] == 1)
            arrays["next.reward"] = arrays["next.success"].astype(np.float32)
        tasks = self._tasks_of(block)[episode].astype(np.int64)
        arrays |= {"timestamp": (frame / self.rate).astype(np.float32), "frame_index": frame, "task_index": tasks}
        arrays |= {"episode_index": episode + block.first_episode, "index": np.arange(first, first + block.num_frames)}
        return {name: arrays[name].reshape(block.num_frames, -1) for name in self._numbers}

    def frames(self, arrays: dict[str, NDArray[Any]]) -> pa.Table:
        return pa.table([_arrow_array(array, self.schema.field(name).type) for name, array in arrays.items()], schema=self.schema)

    def shaped(self, name: str, measures: dict[str, list[Any]]) -> dict[str, list[Any]]:
        """Statistics of a feature (D) or (k, D), of a video (3, 1, 1); counts as they are."""
        if name not in self._videos:
            shape = self._numbers[name]["shape"]
            if len(shape) == 1:
                return measures
            return {key: numbers if key == "count" else np.reshape(numbers, shape).tolist() for key, numbers in measures.items()}
        return {key: numbers if key == "count" else [[[number]] for number in numbers] for key, numbers in measures.items()}

    def episodes(self, block: Block, measures: dict[str, statistics.Statistics], number: int, begin: int) -> pa.Table:
        """One row per episode: where it is, its task, its statistics. begin: first frame of the file."""
        count, ends = block.num_episodes, block.ends + block.first_frame
        columns: dict[str, Any] = {
            "episode_index": np.arange(block.first_episode, block.first_episode + count),
            "tasks": [[self.tasks[task]] for task in self._tasks_of(block)],
            "length": block.lengths,
            "dataset_from_index": ends - block.lengths,
            "dataset_to_index": ends,
        }
        for place in ("data", "meta/episodes"):
            columns[f"{place}/chunk_index"] = np.full(count, number // CHUNK_FILES)
            columns[f"{place}/file_index"] = np.full(count, number % CHUNK_FILES)
        for key in self._videos:
            columns[f"videos/{key}/chunk_index"], columns[f"videos/{key}/file_index"] = (
                columns["data/chunk_index"],
                columns["data/file_index"],
            )
            columns[f"videos/{key}/from_timestamp"] = (ends - block.lengths - begin) / self.rate
            columns[f"videos/{key}/to_timestamp"] = (ends - begin) / self.rate
        for name, found in measures.items():
            for measure, values in found.items():
                rows = _arrow_array(values, pa.list_(pa.from_numpy_dtype(values.dtype)))
                if name in self._videos and measure != "count":
                    rows = pa.array(values[:, :, None, None].tolist())
                columns[f"stats/{name}/{measure}"] = rows
        return pa.table(columns)

    def info(self) -> dict[str, Any]:
        """meta/info.json."""
        source = self.source
        return {
            "codebase_version": "v3.0",
            "robot_type": source.sensor_name,
            "total_episodes": source.num_episodes,
            "total_frames": source.num_frames,
            "total_tasks": len(self.tasks),
            "chunks_size": CHUNK_FILES,
            "data_files_size_in_mb": FILE_BYTES >> 20,
            "video_files_size_in_mb": 500,
            "fps": self.rate,
            "splits": {"train": f"0:{source.num_episodes}"},
            "data_path": f"data/{_NAME}.parquet",
            "video_path": f"videos/{{video_key}}/{_NAME}.mp4" if self.video else None,
            "features": self.features,
        }


def _video_of(source: Source, rate: float) -> ArrayVideo | None:
    return ArrayVideo(source, rate) if source.options.video else None


def _checked_key(key: str, others: Collection[str]) -> str:
    """The name of the tactile image. The reader takes names with `image` for pictures, and allows no slash."""
    if not key.startswith("observation.") or "/" in key or "image" in key or key in others:
        raise InputError(
            f"tactile_key: {key!r} is not allowed: observation.NAME, without a slash, `image`, and the name of another feature"
        )
    return key


def _number_feature(outer: tuple[int, ...], names: Sequence[str]) -> dict[str, Any]:
    return {"dtype": "float32", "shape": [*outer, len(names)], "names": list(names)}


def _arrow_type(feature: dict[str, Any]) -> pa.DataType:
    number = pa.from_numpy_dtype(np.dtype(feature["dtype"]))
    *outer, size = feature["shape"]
    if outer:
        return pa.list_(pa.list_(number, size), outer[0])
    return number if size == 1 else pa.list_(number, size)


def _arrow_array(array: NDArray[Any], kind: pa.DataType) -> pa.Array:
    """(F, D) as one row per frame."""
    numbers = pa.array(np.ascontiguousarray(array).reshape(-1))
    if pa.types.is_fixed_size_list(kind) and pa.types.is_fixed_size_list(kind.value_type):
        return pa.FixedSizeListArray.from_arrays(pa.FixedSizeListArray.from_arrays(numbers, type=kind.value_type), type=kind)
    if pa.types.is_fixed_size_list(kind):
        return pa.FixedSizeListArray.from_arrays(numbers, type=kind)
    if pa.types.is_list(kind):
        return pa.ListArray.from_arrays(pa.array(np.arange(len(array) + 1) * array.shape[1], pa.int32()), numbers)
    return numbers
