"""Time series of an episode: features, ground truth, actions, and errors of the measured features."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .source import Episode

MAX_VALUES = 16  # per frame; a column with more is no time series

_TWIST = ("v_x", "v_y", "v_z", "w_x", "w_y", "w_z")
_NAMES = {
    "center_of_pressure": ("x", "y", "z"),
    "second_moments": ("xx", "xy", "yy"),
    "eigenvalues": ("larger", "smaller"),
    "contact_wrench": ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z"),
    "tilt": ("x", "y"),
    "action": _TWIST,
    "controller_action": _TWIST,
}
_ARRAYS = (
    "tactile_image",
    "taxel_counts",
    "tactile_normal_force",
    "tactile_shear_force",
    "penetration_depth",
    "pose",
    "sensor_pose",
    "time",
)
_NOT_PER_SENSOR = ("data/action", "data/controller_action", "data/robot/")
_ERRORS = ("total_force", "peak_force", "center_of_pressure", "edge_angle", "contact_area")


@dataclass(frozen=True)
class Series:
    """Values over time."""

    path: str  #: Below the episode, such as `features/total_force`.
    frames: NDArray[np.intp]  #: (K,), frames that have values.
    values: NDArray[np.float64]  #: (K, number of names).
    names: tuple[str, ...]


def _series(path: str, values: NDArray[Any], frames: NDArray[np.intp] | None = None) -> Series:
    table = np.asarray(values, np.float64).reshape(len(values), -1)
    last = path.rsplit("/", 1)[-1]
    parts = _NAMES.get(last, ())
    if len(parts) != table.shape[1]:
        parts = ("",) if table.shape[1] == 1 else tuple(map(str, range(table.shape[1])))
    group = {"ground_truth": "true ", "errors": "error of "}.get(path.split("/")[-2], "")
    names = tuple(f"{group}{last} {part}".rstrip() for part in parts)
    return Series(path, np.arange(len(table)) if frames is None else frames, table, names)


def _per_sensor(episode: Episode, name: str, path: str) -> list[tuple[str, NDArray[Any]]]:
    """Values (F, ...) of the whole sensor, of each sensor of the robot under a path of its own."""
    values = np.asarray(episode.columns[name])
    split = episode.num_sensors > 1 and not name.startswith(_NOT_PER_SENSOR) and values.shape[1:2] == (episode.num_sensors,)
    parts = [(f"sensor_{k}/{path}", values[:, k]) for k in range(episode.num_sensors)] if split else [(path, values)]
    if "contact/" in name and values.ndim > 1:  # the first row is that of the whole sensor
        parts = [(where, part[:, 0]) for where, part in parts]
    return parts


def _path_of(name: str) -> str:
    path = name.removeprefix("data/")
    group = path.partition("/")[0]
    return path if group in ("ground_truth", "contact", "robot") else f"actions/{path}" if "action" in path else f"features/{path}"


def _errors(episode: Episode) -> list[Series]:
    """Measured minus true; angles modulo pi."""
    columns, result = episode.columns, []
    for name in _ERRORS:
        measured, true = columns.get(f"data/{name}"), columns.get(f"data/ground_truth/{name}")
        if measured is None or true is None:
            continue
        error = np.subtract(measured, true, dtype=np.float64)
        result.append(_series(f"errors/{name}", _wrapped(error) if name == "edge_angle" else error))
    exact, known = columns.get("data/ground_truth/exact_edge_angle"), columns.get("data/ground_truth/exact_edge_known")
    measured = columns.get("data/edge_angle")
    if exact is not None and measured is not None and known is not None and np.ndim(exact) == 1 == np.ndim(measured):
        frames = np.flatnonzero(known)
        if len(frames):
            error = _wrapped(np.subtract(measured, exact, dtype=np.float64))
            result.append(_series("errors/exact_edge_angle", error[frames], frames))
    return result


def _wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles in [-pi/2, pi/2), of lines without direction."""
    return np.mod(angles + np.pi / 2, np.pi) - np.pi / 2


def series_of(episode: Episode) -> list[Series]:
    """All time series of an episode."""
    result = []
    for name in episode.columns:
        if not name.startswith("data/") or name.rsplit("/", 1)[-1] in _ARRAYS:
            continue
        for path, values in _per_sensor(episode, name, _path_of(name)):
            if values.dtype.kind in "iuf" and values.size <= MAX_VALUES * len(values):
                result.append(_series(path, values))
    result += _errors(episode)
    if not episode.name:
        return result
    return [replace(series, path=f"{episode.name}/{series.path}") for series in result if not series.path.startswith("robot/")]
