"""Where sensors sit on a model: at a site, or on the surface of a geom."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import mujoco
import numpy.typing as npt

from .._core import HalfSpace, Pose, Sensor, load_sensor
from ..errors import InputError
from ..patterns.placement import Placed, cover_shape, grid_on_shape, turned
from ..patterns.taxels import LIKE, SensorLike
from .geoms import Quaternion, Shape, find, geom_name, shape_of


@dataclass(frozen=True)
class GeomSensor:
    """A sensor on a geom, made by grid_on_geom() or cover_geom(): a value of the `sensors` of attach() and couple()."""

    sensor: Sensor
    geom: int  #: Index in the model.
    X_GS: Pose  #: Pose of the sensor frame S in the frame of the geom.


SensorSource = str | PathLike[str] | Sensor | GeomSensor


@dataclass(frozen=True)
class Mount:
    """The frame of a sensor in a model."""

    label: str  #: Name in messages.
    kind: str  #: "site" or "geom".
    index: int  #: Number of the site or geom.
    body: int  #: Number of the body that has it.
    X: Pose  #: Pose of S in the frame of the site or geom.


def mount_of(model: Any, name: str, source: SensorSource) -> tuple[Mount, Sensor]:
    """Mount and sensor of an item of `sensors`. Raises InputError for a site that is not in the model, or a geom of another model."""
    if isinstance(source, GeomSensor):
        if not 0 <= source.geom < model.ngeom:
            raise InputError(f"geom number {source.geom} of sensor {name!r} is not in the model, which has {model.ngeom}")
        return Mount(geom_name(model, source.geom), "geom", source.geom, int(model.geom_bodyid[source.geom]), source.X_GS), source.sensor
    site = find(model, "site", name)
    sensor = source if isinstance(source, Sensor) else load_sensor(source)
    return Mount(f"site {name!r}", "site", site, int(model.site_bodyid[site]), Pose()), sensor


def grid_on_geom(
    model: Any,
    geom: str | int,
    rows: int,
    cols: int,
    pitch: float | Sequence[float],
    *,
    direction: npt.ArrayLike = (0, 0, 1),
    raised: float = 0.0,
    like: SensorLike = LIKE,
) -> GeomSensor:
    """A flat grid of rows x cols taxels on a flat part of a geom; see taxelsim.patterns.grid_on_shape().

    geom: name, number, or the name of a body, or link of a URDF, that has one geom. direction: (3), in the frame of the body.
    Raises InputError for a geom that is not in the model, a plane, and a grid that does not fit.
    """
    index, shape, turn, axis = _surface(model, geom, direction)
    placed = grid_on_shape(shape, rows, cols, pitch, direction=axis, raised=raised, like=like)
    return _on_geom(index, turn, placed)


def cover_geom(
    model: Any,
    geom: str | int,
    pitch: float,
    *,
    direction: npt.ArrayLike | None = None,
    half_angle: float = math.pi / 2,
    raised: float = 0.0,
    like: SensorLike = LIKE,
) -> GeomSensor:
    """Square taxels of pitch^2 over the curved surface of a geom; see taxelsim.patterns.cover_shape().

    geom, direction: as for grid_on_geom(). Geoms of one shape that are covered alike get equal sensors, which share one Model.
    Raises InputError for a geom that is not in the model, a plane, and a pitch that makes no taxel or too many.
    """
    index, shape, turn, axis = _surface(model, geom, direction)
    placed = cover_shape(shape, pitch, direction=axis, half_angle=half_angle, raised=raised, like=like)
    return _on_geom(index, turn, placed)


def _surface(model: Any, geom: str | int, direction: npt.ArrayLike | None) -> tuple[int, Any, Quaternion, Any]:
    """Index of the geom, its shape in O, R_GO, and the direction in O."""
    index = _geom_of(model, geom)
    shape: Shape
    shape, turn = shape_of(model, index)
    if isinstance(shape, HalfSpace):
        raise InputError(f"{geom_name(model, index)} is a plane, which is not allowed: its surface is infinite")
    if direction is None:
        return index, shape, turn, None
    X_BO = Pose(rotation=list(model.geom_quat[index])) * Pose(rotation=list(turn))
    return index, shape, turn, turned(X_BO, direction)


def _geom_of(model: Any, name: str | int) -> int:
    if isinstance(name, str) and mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name) < 0:
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        if body >= 0:
            if model.body_geomnum[body] != 1:
                raise InputError(f"body {name!r} has {model.body_geomnum[body]} geoms, 1 allowed: give the name or number of a geom")
            return int(model.body_geomadr[body])
    return find(model, "geom", name)


def _on_geom(index: int, turn: Quaternion, placed: Placed) -> GeomSensor:
    return GeomSensor(placed.sensor, index, Pose(rotation=list(turn)) * placed.X_BS)
