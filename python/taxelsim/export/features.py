"""Columns of a data set as vectors with named components."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..dataset import Column, Dataset
from ..errors import InputError
from ..pictures import TACTILE_IMAGE, TAXEL_COUNTS

ACTION = "data/action"
SUCCESS = "meta/success"
POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
TWIST = ("v_x", "v_y", "v_z", "w_x", "w_y", "w_z")
WRENCH = ("f_x", "f_y", "f_z", "t_x", "t_y", "t_z")
_COMPONENTS = {
    "data/pose": POSE,
    "data/object_pose": POSE,
    "data/sensor_pose": POSE,
    ACTION: TWIST,
    "data/controller_action": TWIST,
    "data/ground_truth/contact_wrench": WRENCH,
}
_STATE = ("data/robot/joint_position", "data/sensor_pose")  # of these, the recorded ones are the default state


@dataclass(frozen=True)
class Feature:
    """Columns of a data set, flattened and concatenated to one vector per frame."""

    columns: tuple[str, ...]
    names: tuple[str, ...]  #: (D), of the components.

    def vectors(self, values: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """(F, D) from the columns of F frames."""
        parts = [values[name].reshape(len(values[name]), -1).astype(np.float32) for name in self.columns]
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)


def num_sensors(data: Dataset) -> int:
    """Sensors of the robot: with several, columns of a sensor have one more axis."""
    for name, dimensions in (("data/sensor_pose", 1), ("data/pose", 1), ("data/total_force", 0), ("data/ground_truth/total_force", 0)):
        if name in data:
            shape = data[name].shape[1:]
            return shape[0] if len(shape) > dimensions else 1
    return 1


def image_shape(data: Dataset, column: str = TACTILE_IMAGE) -> tuple[int, ...]:
    """(num_sensors, num_rows, num_cols) of one grid, or (num_sensors, num_taxels)."""
    shape, sensors = data[column].shape[1:], num_sensors(data)
    return shape if sensors > 1 else (1, *shape)


def shown_sensors(data: Dataset) -> tuple[str, ...]:
    """Names of the sensors with columns of their own; one, "", where the columns are those of one sensor or have an axis of sensors."""
    return data.sensors if data.sensor is None and data.sensors else ("",)


def column_of(sensor: str, column: str) -> str:
    """data/NAME of a sensor of shown_sensors()."""
    return f"data/{sensor}/{column.removeprefix('data/')}" if sensor else column


def tactile_of(data: Dataset, sensor: str = "") -> Feature:
    """The tactile image: r0_c0, r0_c1, ... of a grid, t0, t1, ... of taxels without one; with several sensors after s0_, s1_, ..."""
    column = column_of(sensor, TACTILE_IMAGE)
    if column not in data:
        raise InputError(f"{data.folder}: no column {column}: record tactile_image in the scene")
    sensors, *taxels = image_shape(data, column)
    axes = [range(count) for count in taxels]
    patterns = ("r{}_c{}" if len(taxels) == 2 else "t{}").format
    names = [patterns(*index) for index in itertools.product(*axes)]
    prefixes = [f"s{sensor}_" for sensor in range(sensors)] if sensors > 1 else [""]
    return Feature((column,), tuple(prefix + name for prefix in prefixes for name in names))


def feature_of(data: Dataset, columns: tuple[str, ...]) -> Feature:
    """Numbers of columns in data/ as one vector; its names begin with the names of the columns if there are several. Throws InputError."""
    if columns == (TAXEL_COUNTS,):
        return Feature(columns, tuple(f"{name}_{axis}" for name in tactile_of(data).names for axis in ("x", "y", "normal")))
    names: list[str] = []
    for name in columns:
        column = data[name]
        if not name.startswith("data/"):
            raise InputError(f"{data.folder}: {name!r} is not allowed: a column in data/")
        prefix = f"{short_name(name)}." if len(columns) > 1 or _component_names(name) is None else ""
        names += [prefix.rstrip(".") if part == "" else prefix + part for part in _components(column)]
    return Feature(columns, tuple(names))


def state_of(data: Dataset, columns: tuple[str, ...], *, with_tactile: bool) -> Feature | None:
    """The state: `columns`, by default joint positions and the pose of the sensor, as far as recorded."""
    chosen = columns or tuple(name for name in _STATE if name in data)
    state = feature_of(data, chosen) if chosen else None
    if not with_tactile:
        return state
    parts = [state] if state else []
    for sensor in shown_sensors(data):
        tactile = tactile_of(data, sensor)
        parts.append(Feature(tactile.columns, tuple(f"{sensor}.{name}" if sensor else name for name in tactile.names)))
    return Feature(tuple(name for part in parts for name in part.columns), tuple(name for part in parts for name in part.names))


def short_name(column: str) -> str:
    """data/ground_truth/total_force as ground_truth.total_force."""
    return column.removeprefix("data/").replace("/", ".")


def _component_names(column: str) -> tuple[str, ...] | None:
    """Of a column, also of one sensor: data/thumb/sensor_pose as data/sensor_pose."""
    ends = (names for name, names in _COMPONENTS.items() if column == name or column.endswith(name.removeprefix("data")))
    return next(ends, None)


def _components(column: Column) -> list[str]:
    shape = column.shape[1:]
    last = _component_names(column.name)
    axes = [[str(index) for index in range(count)] for count in shape]
    if last and shape and shape[-1] == len(last):
        axes[-1] = list(last)
    return ["_".join(index) for index in itertools.product(*axes)]
