"""Where sensors sit on a model: at a site, or on the surface of a geom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import mujoco

from .._core import HalfSpace, Pose, Sensor, load_sensor
from .._engine_shapes import Shape
from ..errors import InputError
from ..patterns.placement import UP, CoverOptions, GridOptions, cover_shape, grid_on_shape, turned
from .geoms import find, geom_name, shape_of

if TYPE_CHECKING:
    from typing_extensions import Unpack


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
    model: Any, geom: str | int, rows: int, cols: int, pitch: float | Sequence[float], **options: Unpack[GridOptions]
) -> GeomSensor:
    """A flat grid of rows x cols taxels on a flat part of a geom.

    geom: name, number, or the name of a body, or link of a URDF, that has one geom.
    options: as for taxelsim.patterns.grid_on_shape(), with the direction in the frame of the body.

    Raises InputError for a geom that is not in the model, a plane, and a grid that does not fit.
    """
    index, shape, X_GO, X_BO = _surface(model, geom)
    placed = grid_on_shape(shape, rows, cols, pitch, **turned(X_BO, GridOptions(direction=UP) | options))
    return GeomSensor(placed.sensor, index, X_GO * placed.X_BS)


def cover_geom(model: Any, geom: str | int, pitch: float, **options: Unpack[CoverOptions]) -> GeomSensor:
    """Square taxels of pitch^2 over the curved surface of a geom.

    geom: as for grid_on_geom(). Geoms of one shape that are covered alike get equal sensors, which share one Model.
    options: as for taxelsim.patterns.cover_shape(), with the direction in the frame of the body.

    Raises InputError for a geom that is not in the model, a plane, and a pitch that makes no taxel or too many.
    """
    index, shape, X_GO, X_BO = _surface(model, geom)
    placed = cover_shape(shape, pitch, **turned(X_BO, options))
    return GeomSensor(placed.sensor, index, X_GO * placed.X_BS)


def _surface(model: Any, geom: str | int) -> tuple[int, Any, Pose, Pose]:
    """Index of the geom, its shape in O, and the rotation of O in the frames G of the geom and B of the body."""
    index = _geom_of(model, geom)
    shape: Shape
    shape, turn = shape_of(model, index)
    if isinstance(shape, HalfSpace):
        raise InputError(f"{geom_name(model, index)} is a plane, which is not allowed: its surface is infinite")
    X_GO = Pose(rotation=list(turn))
    return index, shape, X_GO, Pose(rotation=list(model.geom_quat[index])) * X_GO


def _geom_of(model: Any, name: str | int) -> int:
    if isinstance(name, str) and mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name) < 0:
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        if body >= 0:
            if model.body_geomnum[body] != 1:
                raise InputError(f"body {name!r} has {model.body_geomnum[body]} geoms, 1 allowed: give the name or number of a geom")
            return int(model.body_geomadr[body])
    return find(model, "geom", name)
