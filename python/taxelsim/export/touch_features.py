"""Touch of a LeRobot data set besides the tactile image: windows at the rate of the data set, points with forces, wrenches."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._counts import newtons_of_counts
from ..dataset.provenance import Provenance
from ..errors import InputError
from ..pictures import TACTILE_IMAGE
from ..viewer.scene_files import scene_of, sensor_of
from .features import Feature, column_of, feature_of, num_sensors, shown_sensors
from .source import Block, Source

IMAGE, POINTS = "image", "points"
LAYOUTS = (IMAGE, POINTS)
POINTS_VERSION = 1
POINT = ("x", "y", "z", "nx", "ny", "nz", "force")
POINT_UNIT = "m in the sensor frame, 1, N"
WINDOW_TIME = "observation.window_time"
WRENCH = "observation.wrench"
_WRENCH_COLUMN = "data/ground_truth/contact_wrench"


@dataclass(frozen=True)
class Points:
    """Taxels of a sensor as points (N, 7): place and outward normal in the sensor frame, and normal force by the nominal curve."""

    column: str
    places: NDArray[np.float32]  #: (N, 6).
    newtons: NDArray[np.float32]  #: Force of each number of counts.

    def values(self, block: Block) -> NDArray[np.float32]:
        """(F, N * 7) of the frames of a block."""
        counts = block.values[self.column].reshape(block.num_frames, -1)
        points = np.empty((*counts.shape, len(POINT)), np.float32)
        points[..., :-1] = self.places
        points[..., -1] = self.newtons[counts]
        return points.reshape(block.num_frames, -1)


def points_of(source: Source, key: str) -> dict[str, Points]:
    """Points by name of feature, empty with another layout. Throws InputError."""
    options, data = source.options, source.data
    if options.layout not in LAYOUTS:
        raise InputError(f"layout: {options.layout!r} is not allowed: {', '.join(LAYOUTS)}")
    if options.layout != POINTS:
        return {}
    if num_sensors(data) > 1:
        raise InputError(f"{data.folder}: layout: {POINTS} is not allowed: several sensors share the column {TACTILE_IMAGE}")
    scene, _ = scene_of(Provenance.of(data.folder).scene, [Path(name) for name in options.assets], data.folder)
    points = {}
    for prefix in shown_sensors(data):
        sensor = sensor_of(scene, prefix or data.sensor)
        places = np.concatenate((sensor.taxel_positions, sensor.taxel_normals), axis=1).astype(np.float32)
        name = f"{key}_points.{prefix}" if prefix else f"{key}_points"
        points[name] = Points(column_of(prefix, TACTILE_IMAGE), places, newtons_of_counts(sensor.readout))
    return points


def wrenches_of(source: Source) -> dict[str, Feature]:
    """Wrenches of contact by name of feature, empty without the option. Throws InputError."""
    if not source.options.wrench:
        return {}
    wrenches = {}
    for prefix in shown_sensors(source.data):
        column = column_of(prefix, _WRENCH_COLUMN)
        if column not in source.data:
            raise InputError(f"{source.data.folder}: wrench: no column {column}: record ground_truth in the scene")
        wrenches[f"{WRENCH}.{prefix}" if prefix else WRENCH] = feature_of(source.data, (column,))
    return wrenches


def windows_of(source: Source, key: str, wrenches: dict[str, Feature]) -> dict[str, Feature]:
    """Features whose windows are exported, by name of the window; empty where the frames are those of the data set."""
    if source.window == 1:
        return {}
    touch = source.named_tactile(f"{key}_window", ".")
    forces = {name.replace(WRENCH, f"{WRENCH}_window", 1): feature for name, feature in wrenches.items()}
    return {**touch, **forces, WINDOW_TIME: Feature(("data/time",), ("time",))}


def about_touch(source: Source, key: str, windows: dict[str, Feature], points: dict[str, Points]) -> dict[str, Any]:
    """Content of meta/taxelsim.json: units, windows and the version of points."""
    units = dict.fromkeys(source.named_tactile(key, "."), "counts")
    units |= {name: "s" if name == WINDOW_TIME else "N, N m" if name.startswith(WRENCH) else "counts" for name in windows}
    about: dict[str, Any] = {"units": units | dict.fromkeys(points, POINT_UNIT)}
    if windows:
        about["windows"] = {"features": list(windows), "frames": source.window, "rate": source.data_rate(), "left_out": source.left_out}
    if points:
        about["points"] = {"version": POINTS_VERSION, "columns": POINT, "unit": POINT_UNIT}
    return about
