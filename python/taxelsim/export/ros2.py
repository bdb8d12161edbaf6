"""MCAP with ROS 2 messages: one file for each episode."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from mcap_ros2.writer import Writer
from numpy.typing import NDArray

from .. import __version__
from ..pictures import TACTILE_IMAGE, TAXEL_COUNTS
from ..ros2.messages import definition_of, image, pixels, pose, twist, wrench
from .features import ACTION, column_of, num_sensors, shown_sensors
from .source import Block, Source
from .staging import new_file, staged_folder, write_json

BLOCK_FRAMES = 1 << 14  # that are in memory at once
_WRENCH = "data/ground_truth/contact_wrench"


@dataclass(frozen=True)
class _Topic:
    """A column as messages. Each of several sensors has its own topic."""

    name: str
    column: str
    schema: str
    frame: str  #: Of the header: S is called sensor, W world.
    content: Callable[[NDArray[Any]], dict[str, Any]]
    sensor: str = ""  #: Sensor that has the column; empty in data sets of one kind of sensor.


_TOPICS = (
    _Topic("image", TACTILE_IMAGE, "sensor_msgs/Image", "sensor", image),
    _Topic("taxel_counts", TAXEL_COUNTS, "sensor_msgs/Image", "sensor", pixels),
    _Topic("contact_wrench", _WRENCH, "geometry_msgs/WrenchStamped", "sensor", wrench),
    _Topic("object_pose", "data/pose", "geometry_msgs/PoseStamped", "sensor", pose),
    _Topic("sensor_pose", "data/sensor_pose", "geometry_msgs/PoseStamped", "world", pose),
    _Topic("action", ACTION, "geometry_msgs/TwistStamped", "sensor", twist),
)


def write(source: Source, out: Path, plan: dict[str, Any], report: Callable[[int], None]) -> None:
    """Writes the folder `out`. report: called with the number of frames since the last call. Throws InputError."""
    topics = [
        replace(topic, column=column, sensor=sensor)
        for topic in _TOPICS
        for sensor in shown_sensors(source.data)
        if (column := column_of(sensor, topic.column)) in source.data
    ]
    with staged_folder(out, plan) as folder:
        done = next(number for number in range(source.num_episodes + 1) if not (folder / _name(number)).exists())
        report(int(source.ends[done - 1]) if done else 0)
        for first, end in source.parts(BLOCK_FRAMES, done):
            block = source.block(first, end, ("data/time", *(topic.column for topic in topics), *source.episode_columns))
            for episode in range(block.num_episodes):
                with new_file(folder / _name(block.first_episode + episode)) as file:
                    _write_episode(file, source, block, episode, topics)
                report(int(block.lengths[episode]))
        write_json(folder / "taxelsim.json", {"taxelsim": __version__, **source.identity(), "episodes": plan["options"]["episodes"]})


def _name(episode: int) -> str:
    return f"episode-{episode:06d}.mcap"


def _write_episode(file: Path, source: Source, block: Block, episode: int, topics: list[_Topic]) -> None:
    end = int(block.ends[episode])
    first = end - int(block.lengths[episode])
    with file.open("wb") as stream, Writer(stream) as writer:
        channels = list(_channels(source, writer, topics))
        for frame in range(first, end):
            time = round(float(block.values["data/time"][frame]) * 1e9)
            stamp = {"sec": time // 10**9, "nanosec": time % 10**9}
            for topic, name, frame_id, schema, sensor in channels:
                values = block.values[topic.column][frame]
                message = {"header": {"stamp": stamp, "frame_id": frame_id}, **topic.content(values if sensor is None else values[sensor])}
                writer.write_message(name, schema, message, time, time, frame - first)
        labels = {name: np.asarray(values[episode]).item() for name, values in block.values.items() if name.startswith("meta/")}
        writer.add_metadata("taxelsim", {"scene": source.scene_name, **{name: json.dumps(value) for name, value in labels.items()}})


def _channels(source: Source, writer: Any, topics: list[_Topic]) -> Iterator[tuple[_Topic, str, str, Any, int | None]]:
    """Topic, its name, its frame, its schema, and which of several sensors."""
    schemas = {topic.schema: writer.register_msgdef(topic.schema.replace("/", "/msg/"), definition_of(topic.schema)) for topic in topics}
    sensors = num_sensors(source.data)
    for topic in topics:
        for sensor in [None] if sensors == 1 or topic.column == ACTION else range(sensors):
            prefix = "" if sensor is None else f"_{sensor}"
            frame = "world" if topic.frame == "world" else topic.sensor or f"sensor{prefix}"
            group = f"/tactile/{topic.sensor}" if topic.sensor else f"/tactile{prefix}"
            yield topic, f"{group}/{topic.name}", frame, schemas[topic.schema], sensor
