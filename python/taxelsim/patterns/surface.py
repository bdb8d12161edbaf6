"""Samples of the surface of a shape: points, outward normals and areas."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Box, Capsule, Cylinder, Mesh, Sphere
from ..errors import InputError

Array = NDArray[np.float64]
Shape = Mesh | Sphere | Cylinder | Capsule | Box

MAX_SAMPLES = 1_000_000
_GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))
# Steps of the R2 sequence (M. Roberts, 2018), whose points fill the unit square evenly for any count.
_R2 = np.array([0.7548776662466927, 0.5698402909980532])


@dataclass(frozen=True)
class Surface:
    """Samples in the frame of the shape."""

    points: Array  #: (M, 3), m.
    normals: Array  #: (M, 3), unit vectors out of the shape.
    areas: Array  #: (M), m^2, parts of the surface that the samples stand for.

    def part(self, mask: NDArray[np.bool_]) -> Surface:
        """The samples of a mask (M)."""
        return Surface(self.points[mask], self.normals[mask], self.areas[mask])


def surface_of(shape: Any, spacing: float) -> Surface:
    """Samples that are about `spacing`, m, apart. Raises InputError for another shape, and for more than a million samples."""
    kinds: dict[type, Callable[[Any, float], Surface]] = {Sphere: _sphere, Cylinder: _cylinder, Capsule: _capsule, Box: _box, Mesh: _mesh}
    sample = kinds.get(type(shape))
    if sample is None:
        raise InputError(f"{type(shape).__name__} is not allowed: Sphere, Cylinder, Capsule, Box or Mesh")
    return sample(shape, spacing)


def _count(area: float, spacing: float) -> int:
    count = max(16, math.ceil(area / spacing**2))
    if count > MAX_SAMPLES:
        raise InputError(f"a surface of {area:.3g} m^2 is not allowed at this pitch: at most {MAX_SAMPLES * spacing**2:.3g} m^2")
    return count


def _joined(parts: list[Surface]) -> Surface:
    return Surface(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.areas for part in parts]),
    )


def _directions(count: int) -> Array:
    """Unit vectors (count, 3) on a Fibonacci spiral, which is even on the sphere."""
    k = np.arange(count)
    z = 1 - (2 * k + 1) / count
    radius, angle = np.sqrt(1 - z * z), _GOLDEN_ANGLE * k
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), z), axis=1)


def _sphere(shape: Sphere, spacing: float) -> Surface:
    area = 4 * math.pi * shape.radius**2
    normals = _directions(_count(area, spacing))
    return Surface(shape.radius * normals, normals, np.full(len(normals), area / len(normals)))


def _side(radius: float, length: float, spacing: float) -> Surface:
    """The curved side of a cylinder along z."""
    _count(2 * math.pi * radius * length, spacing)
    around, along = max(16, math.ceil(2 * math.pi * radius / spacing)), max(1, math.ceil(length / spacing))
    angles, z = 2 * math.pi * np.arange(around) / around, ((np.arange(along) + 0.5) / along - 0.5) * length
    normals = np.tile(np.stack((np.cos(angles), np.sin(angles), 0 * angles), axis=1), (along, 1))
    points = radius * normals + np.repeat(z, around)[:, np.newaxis] * (0, 0, 1)
    return Surface(points, normals, np.full(len(points), 2 * math.pi * radius * length / len(points)))


def _cylinder(shape: Cylinder, spacing: float) -> Surface:
    area = math.pi * shape.radius**2
    k = np.arange(_count(area, spacing))
    radius, angle = shape.radius * np.sqrt((k + 0.5) / len(k)), _GOLDEN_ANGLE * k
    disc = np.stack((radius * np.cos(angle), radius * np.sin(angle), np.full(len(k), shape.length / 2)), axis=1)
    top = Surface(disc, np.tile([0.0, 0, 1], (len(k), 1)), np.full(len(k), area / len(k)))
    return _joined([_side(shape.radius, shape.length, spacing), top, Surface(-top.points, -top.normals, top.areas)])


def _capsule(shape: Capsule, spacing: float) -> Surface:
    ends = _sphere(Sphere(shape.radius), spacing)
    up = np.where(ends.normals[:, 2] < 0, -0.5, 0.5) * shape.length
    caps = Surface(ends.points + up[:, np.newaxis] * (0, 0, 1), ends.normals, ends.areas)
    return _joined([caps, _side(shape.radius, shape.length, spacing)]) if shape.length > 0 else caps


def _box(shape: Box, spacing: float) -> Surface:
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        _count(shape.size[u] * shape.size[v], spacing)
        counts = [max(1, math.ceil(shape.size[side] / spacing)) for side in (u, v)]
        at = [((np.arange(count) + 0.5) / count - 0.5) * shape.size[side] for count, side in zip(counts, (u, v), strict=True)]
        points = np.empty((counts[0] * counts[1], 3))
        points[:, u], points[:, v] = np.repeat(at[0], counts[1]), np.tile(at[1], counts[0])
        points[:, axis] = shape.size[axis] / 2
        normals = np.tile(np.eye(3)[axis], (len(points), 1))
        areas = np.full(len(points), shape.size[u] * shape.size[v] / len(points))
        faces += [Surface(points, normals, areas), Surface(-points, -normals, areas)]
    return _joined(faces)


def _mesh(shape: Mesh, spacing: float) -> Surface:
    """Triangles run counter-clockwise seen from outside; a closed mesh may also run the other way."""
    corners = np.asarray(shape.vertices, np.float64)[np.asarray(shape.triangles)]
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    if (corners.mean(axis=1) * vectors).sum() < 0 and np.linalg.norm(vectors.sum(axis=0)) < 1e-6 * np.linalg.norm(vectors, axis=1).sum():
        vectors = -vectors  # the enclosed volume is negative
    areas = np.linalg.norm(vectors, axis=1)
    count = _count(float(areas.sum()), spacing)
    # Equal steps of the sum of the areas: a triangle has samples in proportion to its area.
    ends = np.cumsum(areas)
    of = np.minimum(np.searchsorted(ends, (np.arange(count) + 0.5) / count * ends[-1]), len(areas) - 1)
    u, v = (np.arange(count)[:, np.newaxis] * _R2 % 1).T
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    a, b, c = np.moveaxis(corners[of], 1, 0)
    points = a + u[:, np.newaxis] * (b - a) + v[:, np.newaxis] * (c - a)
    normals = vectors[of] / np.maximum(areas[of], 1e-300)[:, np.newaxis]
    return Surface(points, normals, np.full(count, ends[-1] / count))
