"""Taxels on the surface of a shape: flat grids, and covers of curved surfaces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict, TypeVar

import numpy as np
import numpy.typing as npt

from .._arguments import checked_count, checked_positive
from .._arrays import rotation_matrices, to_array
from .._core import GridPatch, Mesh, Pose, Sensor, check_sensor, load_sensor, taxel_patch
from ..errors import InputError
from .surface import Array, Shape, Surface, surface_of
from .taxels import LIKE, MAX_TAXELS, SensorLike, sensor_of

SAMPLES_PER_PITCH = 6
ITERATIONS = 15  # rounds of Lloyd's algorithm
UP = (0, 0, 1)
"""Default direction of a grid."""


class GridOptions(TypedDict, total=False):
    """Optional arguments of grid_on_shape(), which grids on links and geoms take too."""

    direction: npt.ArrayLike
    raised: float
    like: SensorLike
    name: str


class CoverOptions(TypedDict, total=False):
    """Optional arguments of cover_shape(), which covers of links and geoms take too."""

    direction: npt.ArrayLike | None
    half_angle: float
    raised: float
    like: SensorLike
    name: str


Options = TypeVar("Options", GridOptions, CoverOptions)


@dataclass(frozen=True)
class Placed:
    """A sensor on a body."""

    sensor: Sensor
    X_BS: Pose  #: Pose of the sensor frame S in the frame B of the shape, geom or link.


def grid_on_shape(
    shape: Shape,
    rows: int,
    cols: int,
    pitch: float | Sequence[float],
    *,
    direction: npt.ArrayLike = UP,
    raised: float = 0.0,
    like: SensorLike = LIKE,
    name: str = "grid",
) -> Placed:
    """A flat grid of rows x cols taxels on a flat part of a shape. Its tactile image has the shape (rows, cols).

    pitch: m, distance of the taxels, or distances along x and y of S.
    direction: (3), in B. S lies where the ray along it from the middle of the shape (of the bounding box of a mesh) leaves the shape,
        and z of S is the normal of the surface there;
        x and y of S are those of B after the shortest rotation of z of B to it.
    raised: m, height of the outer skin over the surface, at least 0.
    like: as for sensor_of().

    Raises InputError if the middle of a taxel lies more than half a pitch off the surface: cover_shape() follows curved ones.
    """
    given = to_array("pitch", pitch, np.float64, [[], [2]], per_instance=False)
    sides = [checked_positive("pitch", float(side)) for side in np.broadcast_to(given, 2)]
    surface = surface_of(shape, min(sides) / SAMPLES_PER_PITCH)
    grid = GridPatch(name="grid", num_rows=checked_count("rows", rows), num_cols=checked_count("cols", cols), pitch=sides)
    template = like if isinstance(like, Sensor) else load_sensor(like)
    sensor = template.replace(name=name, patches=[grid])
    check_sensor(sensor)
    on_surface = _frame(shape, surface, _unit("direction", direction))
    middles = np.array([on_surface.transform(point) for point in np.asarray(sensor.taxel_positions)])
    gaps = np.array([np.linalg.norm(surface.points - middle, axis=1).min() for middle in middles])
    if gaps.max() > min(sides) / 2:
        raise InputError(
            f"a grid whose taxels are up to {gaps.max():.2g} m off the surface is not allowed: at most half a pitch; cover curved surfaces"
        )
    return Placed(sensor, on_surface * Pose([0, 0, _height(raised)]))


def cover_shape(
    shape: Shape,
    pitch: float,
    *,
    direction: npt.ArrayLike | None = None,
    half_angle: float = math.pi / 2,
    region: npt.ArrayLike | None = None,
    raised: float = 0.0,
    like: SensorLike = LIKE,
    name: str = "cover",
) -> Placed:
    """Square taxels over the curved surface of a shape, as many as have an area of pitch^2 each, evenly spaced by Lloyd's algorithm.

    direction: (3), in B; only those parts are covered whose normals are within half_angle, rad, of it. S lies where the ray
        along it from the middle of the shape leaves the shape, with z along it. None: the whole surface, and S is B.
    region: ((x, y, z), (x, y, z)), m, opposite corners of a box in B, outside of which there are no taxels.
    pitch, raised, like: as for grid_on_shape(). The order of the taxels is from the largest z of S down.

    Raises InputError for no taxel, more than 4096, and as sensor_of().
    """
    spacing = checked_positive("pitch", pitch) / SAMPLES_PER_PITCH
    surface = surface_of(shape, spacing)
    frame = Pose()
    mask = np.ones(len(surface.points), np.bool_)
    if direction is not None:
        axis = _unit("direction", direction)
        frame = Pose(_frame(shape, surface, axis).position, _rotation(axis))
        if not 0 < half_angle <= math.pi:
            raise InputError(f"half_angle: {half_angle} is not allowed: above 0, at most pi rad")
        mask &= surface.normals @ axis >= math.cos(half_angle) - 1e-9
    if region is not None:
        low, high = np.sort(to_array("region", region, np.float64, [[2, 3]], per_instance=False), axis=0)
        mask &= ((surface.points >= low) & (surface.points <= high)).all(axis=1)
    part = surface.part(mask)
    count = round(float(part.areas.sum()) / pitch**2)
    if not 1 <= count <= MAX_TAXELS:
        raise InputError(f"pitch: {pitch:g} m is not allowed: it makes {count} taxels, 1 to {MAX_TAXELS} are possible")
    places, normals = _spread(part, count, pitch)
    to_S = frame.inverse()
    rotation = rotation_matrices(np.array([to_S.rotation]))[0]
    in_S = np.array([to_S.transform(point) for point in places + _height(raised) * normals])
    order = np.lexsort((in_S[:, 0], in_S[:, 1], -in_S[:, 2].round(9)))
    side = math.sqrt(float(part.areas.sum()) / count)
    return Placed(sensor_of(in_S[order], (normals @ rotation.T)[order], side, name=name, like=like), frame)


def _height(raised: float) -> float:
    if not (math.isfinite(raised) and raised >= 0):
        raise InputError(f"raised: {raised} is not allowed: a finite number of at least 0 m")
    return float(raised)


def _unit(name: str, direction: npt.ArrayLike) -> Array:
    vector = to_array(name, direction, np.float64, [[3]], per_instance=False)
    length = float(np.linalg.norm(vector))
    if length == 0:
        raise InputError(f"{name}: a vector of length 0 is not allowed: a direction")
    return np.asarray(vector / length)


def turned(X_BO: Pose, options: Options) -> Options:
    """Options with the direction in the frame O of a shape, given in the frame B of its body. Raises InputError."""
    direction = options.get("direction")
    if direction is None:
        return options
    vector = to_array("direction", direction, np.float64, [[3]], per_instance=False)
    return {**options, "direction": Pose(rotation=X_BO.rotation).inverse().transform(list(vector))}


def _rotation(normal: Array) -> list[float]:
    """The shortest rotation from z to a unit vector, as that of a taxel."""
    return taxel_patch("", [0, 0, 0], list(normal), 1.0).X_SP.rotation


def _frame(shape: Shape, surface: Surface, axis: Array) -> Pose:
    """Where the ray along `axis` from the middle leaves the shape, with z along the normal there. Raises InputError if it misses."""
    points, normals = surface.points, surface.normals
    middle = (points.min(axis=0) + points.max(axis=0)) / 2 if isinstance(shape, Mesh) else np.zeros(3)
    along = (points - middle) @ axis
    aside = np.linalg.norm(points - middle - along[:, np.newaxis] * axis, axis=1)
    reach = 2 * math.sqrt(surface.areas.max())
    near = (normals @ axis > 0) & (along > 0) & (aside <= reach)
    if not near.any():
        raise InputError(f"direction: {axis.tolist()} is not allowed: the ray along it from the middle of the shape misses the surface")
    outermost = np.flatnonzero(near & (along >= along[near].max() - reach))
    best = outermost[aside[outermost].argmin()]
    # The ray meets the tangent plane of the sample nearest to it.
    distance = ((points[best] - middle) @ normals[best]) / (axis @ normals[best])
    return Pose(list(middle + distance * axis), _rotation(normals[best]))


def _spread(surface: Surface, count: int, pitch: float) -> tuple[Array, Array]:
    """Places (count, 3) and normals (count, 3): samples that divide the surface into cells of about equal area.

    The distance includes the angle between normals, so that cells do not reach through a thin body or around an edge.
    """
    features = np.concatenate((surface.points, pitch / 2 * surface.normals), axis=1)
    chosen = [int(np.lexsort(features.T)[0])]
    distances = ((features - features[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < count:  # the farthest sample next
        chosen.append(int(distances.argmax()))
        distances = np.minimum(distances, ((features - features[chosen[-1]]) ** 2).sum(axis=1))
    centers = features[chosen]
    for _ in range(ITERATIONS):
        cell = _nearest(features, centers)
        weights = np.bincount(cell, surface.areas, count)[:, np.newaxis]
        sums = np.stack([np.bincount(cell, surface.areas * column, count) for column in features.T], axis=1)
        centers = np.where(weights > 0, sums / np.maximum(weights, 1e-300), centers)
    index = _nearest(centers, features)
    points, normals = surface.points[index], surface.normals[index]
    heights = ((centers[:, :3] - points) * normals).sum(axis=1, keepdims=True)
    return centers[:, :3] - heights * normals, normals  # in the tangent plane of the nearest sample


def _nearest(points: Array, centers: Array) -> npt.NDArray[np.intp]:
    """Index (P) of the nearest of the centers, in blocks that bound the memory."""
    squares = (centers**2).sum(axis=1)
    block = max(1, 4_000_000 // len(centers))
    return np.concatenate([(squares - 2 * points[i : i + block] @ centers.T).argmin(axis=1) for i in range(0, len(points), block)])
