"""Recordings in bags of ROS: MCAP, rosbag2 and rosbag of ROS 1, by the package rosbags, without an installation of ROS."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import Error, InputError
from .recording import BLOCK_ROWS, Block, Recording, component_names

STAMP = "stamp"  # column with the times of the messages of a topic
_IMAGE = "sensor_msgs/msg/Image"
_NAMED_ENCODINGS = {"mono8": "8UC1", "mono16": "16UC1", "rgb8": "8UC3", "bgr8": "8UC3", "rgba8": "8UC4", "bgra8": "8UC4"}
_KINDS = {"U": "u", "S": "i", "F": "f"}

_Fields = list[tuple[str, NDArray[Any]]]  # path below the message, numbers


@dataclass(frozen=True)
class _Topic:
    """A topic, with the numbers of its first message."""

    name: str
    columns: tuple[str, ...]
    shapes: tuple[tuple[str, tuple[int, ...]], ...]


def read_bag(path: Path, topics: Sequence[str] = ()) -> Recording:
    """Messages of topics, as numbers. Needs rosbags.

    path: .mcap or .bag, or the folder of a rosbag2.
    topics: each message of the first one is a row, with the last values of the others up to it; rows before their first message are left
        out. Empty: the only topic with numbers.

    Columns are called TOPIC.r0_c1 for images and arrays with two dimensions, TOPIC.wrench.force.x for fields, TOPIC.data.0 for lists, and
    TOPIC.stamp (s since the first row: the stamp of the header, else the time of recording). Lists must keep their length.
    Throws InputError.
    """
    with _opened(path) as reader:
        chosen = tuple(_topics(path, reader, topics))
    columns = {column: (topic.name, index) for topic in chosen for index, column in enumerate(topic.columns)}
    stamp = f"{chosen[0].name}.{STAMP}"

    def blocks(names: Sequence[str]) -> Iterator[Block]:
        rows: list[NDArray[np.float64]] = []
        for row in _rows(path, chosen, [columns.get(name) for name in names]):
            rows.append(row)
            if len(rows) == BLOCK_ROWS:
                yield dict(zip(names, np.stack(rows, axis=1), strict=True))
                rows = []
        if rows:
            yield dict(zip(names, np.stack(rows, axis=1), strict=True))

    return Recording(str(path), (*columns, stamp), blocks, {stamp: "s"}, "message {}".format)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """A reader of the package rosbags. Gives its errors in one line, as InputError."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise ImportError("bags of ROS need the package rosbags: pip install 'taxelsim[bags]'") from error
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
            yield reader
    except (Error, GeneratorExit):
        raise
    except Exception as error:  # damaged files raise errors of many kinds
        raise InputError(f"{path}: no bag of ROS: {' '.join(str(error).split()) or type(error).__name__}") from error


def _topics(path: Path, reader: Any, names: Sequence[str]) -> Iterator[_Topic]:
    known = reader.topics
    for name in names:
        if name not in known:
            raise InputError(f"{path}: no topic {name!r}; it has {', '.join(sorted(known))}")
    found = {topic.name: topic for topic in (_first_of(path, reader, name) for name in names or sorted(known)) if topic.columns}
    if names:
        empty = [name for name in names if name not in found]
        if empty:
            raise InputError(f"{path}: topic {empty[0]!r} has no messages with numbers")
        yield from (found[name] for name in dict.fromkeys(names))
        return
    if len(found) != 1:
        raise InputError(f"{path}: --topic is needed, one of {', '.join(found) or 'none: no topic has numbers'}")
    yield from found.values()


def _first_of(path: Path, reader: Any, name: str) -> _Topic:
    connections = [connection for connection in reader.connections if connection.topic == name]
    for connection, _, raw in reader.messages(connections):
        fields = _numbers(path, reader.deserialize(raw, connection.msgtype))
        columns = [column for part, values in fields for column in component_names(f"{name}.{part}" if part else name, values.shape)]
        return _Topic(name, tuple(columns), tuple((part, values.shape) for part, values in fields))
    return _Topic(name, (), ())


def _rows(path: Path, topics: Sequence[_Topic], places: Sequence[tuple[str, int] | None]) -> Iterator[NDArray[np.float64]]:
    """Values of columns, by topic and index; None is the time. One row for each message of the first topic."""
    by_name = {topic.name: topic for topic in topics}
    latest: dict[str, NDArray[np.float64]] = {}
    begin: int | None = None
    counts = dict.fromkeys(by_name, 0)
    with _opened(path) as reader:
        for connection, time, raw in reader.messages([item for item in reader.connections if item.topic in by_name]):
            message = reader.deserialize(raw, connection.msgtype)
            topic, fields = by_name[connection.topic], _numbers(path, message)
            if tuple((part, values.shape) for part, values in fields) != topic.shapes:
                raise InputError(f"{path}: {topic.name}: message {counts[topic.name]} has other sizes than the first one")
            counts[topic.name] += 1
            latest[topic.name] = np.concatenate([np.ravel(values).astype(np.float64) for _, values in fields])
            if topic is topics[0] and len(latest) == len(topics):
                stamp = _stamp_of(message) or time  # ns
                begin = stamp if begin is None else begin
                seconds = (stamp - begin) * 1e-9
                yield np.array([seconds if place is None else latest[place[0]][place[1]] for place in places])


def _stamp_of(message: Any) -> int:
    """ns, of the header; 0 without one."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return int(stamp.sec) * 10**9 + int(stamp.nanosec) if stamp is not None else 0


def _numbers(path: Path, message: Any) -> _Fields:
    """All numbers of a message, without headers and texts."""
    kind = message.__msgtype__
    if kind == _IMAGE:
        return [("", _pixels(path, message))]
    if kind.endswith("MultiArray"):
        sizes = [dimension.size for dimension in message.layout.dim]
        values = np.asarray(message.data)
        return [("", values.reshape(sizes) if len(sizes) > 1 and np.prod(sizes) == values.size else values)]
    return list(_fields(message, ""))


def _fields(value: Any, part: str) -> Iterator[tuple[str, NDArray[Any]]]:
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            if field.name != "header":
                yield from _fields(getattr(value, field.name), f"{part}.{field.name}" if part else field.name)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _fields(item, f"{part}.{index}")
    elif not isinstance(value, str):
        array = np.asarray(value)
        if array.dtype.kind in "biuf" and array.size:
            yield part, array


def _pixels(path: Path, image: Any) -> NDArray[Any]:
    """(height, width), of several channels (height, width, channels)."""
    encoding = _NAMED_ENCODINGS.get(image.encoding, image.encoding)
    found = re.fullmatch(r"(8|16|32|64)([USF])C([1-4])", encoding)
    if not found:
        raise InputError(f"{path}: encoding {image.encoding!r} of an image is not allowed: mono8, mono16, or such as 32FC1")
    bits, kind, channels = int(found[1]), _KINDS[found[2]], int(found[3])
    dtype = np.dtype(f"{kind}{bits // 8}").newbyteorder(">" if image.is_bigendian else "<")
    width = image.width * channels
    try:
        rows = np.asarray(image.data, np.uint8)[: image.height * image.step].reshape(image.height, image.step)
        pixels: NDArray[Any] = (
            np.ascontiguousarray(rows[:, : width * dtype.itemsize]).view(dtype).reshape(image.height, image.width, channels)
        )
    except ValueError as error:
        raise InputError(f"{path}: an image of {image.height} x {image.step} bytes has {len(image.data)}") from error
    return pixels[..., 0] if channels == 1 else pixels
