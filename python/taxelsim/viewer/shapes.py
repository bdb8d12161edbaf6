"""Triangles of objects and of a sensor's taxels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Box, Capsule, Cone, Cylinder, HalfSpace, Mesh, Sensor, Sphere, Torus
from ..pictures import taxel_axes

Triangles = tuple[NDArray[np.float32], NDArray[np.uint32]]
"""Vertices (V, 3), m, and triangles (T, 3), indices of vertices."""

_SEGMENTS = 48  # around an axis of revolution, and along a circle of a profile
TAXEL_SHARE = 0.94  # of the pitch, so that the grid is visible

# Corners of a box of half size 1, by bits x, y, z, and its triangles.
_CORNERS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float64)
_FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


def _quads(corners: NDArray[Any]) -> NDArray[np.uint32]:
    """Two triangles (2 Q, 3) for each quadrilateral (Q, 4)."""
    return np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]).astype(np.uint32)


def _revolved(profile: Sequence[tuple[float, float]] | NDArray[np.float64]) -> Triangles:
    """A profile (P, 2) of distances from the z axis and heights, rotated about that axis."""
    r, z = np.asarray(profile, np.float64).T
    angles = np.linspace(0, 2 * np.pi, _SEGMENTS, endpoint=False)
    rings = np.stack([np.outer(r, np.cos(angles)), np.outer(r, np.sin(angles)), np.repeat(z[:, None], _SEGMENTS, 1)], -1)
    ring, segment = np.meshgrid(np.arange(len(r) - 1), np.arange(_SEGMENTS), indexing="ij")
    first, second = ring * _SEGMENTS + segment, ring * _SEGMENTS + (segment + 1) % _SEGMENTS
    corners = np.stack([first, second, second + _SEGMENTS, first + _SEGMENTS], -1)
    return rings.reshape(-1, 3).astype(np.float32), _quads(corners.reshape(-1, 4))


def _arc(radius: float, first: float, last: float, at: tuple[float, float]) -> NDArray[np.float64]:
    """Profile of an arc from one angle to another, from the direction -z towards +r, about a centre (r, z)."""
    angles = np.linspace(first, last, _SEGMENTS // 2 + 1)
    return np.stack([at[0] + radius * np.sin(angles), at[1] - radius * np.cos(angles)], -1)


def triangles_of(shape: Any, extent: float) -> Triangles:
    """Surface of a shape in its frame O. extent: m, half side of the square that stands for a half-space."""
    match shape:
        case Mesh():
            return np.array(shape.vertices), np.array(shape.triangles)
        case Sphere():
            return _revolved(_arc(shape.radius, 0, np.pi, (0, 0)))
        case Cylinder():
            h = shape.length / 2
            return _revolved([(0, -h), (shape.radius, -h), (shape.radius, h), (0, h)])
        case Capsule():
            h = shape.length / 2
            return _revolved(np.concatenate([_arc(shape.radius, 0, np.pi / 2, (0, -h)), _arc(shape.radius, np.pi / 2, np.pi, (0, h))]))
        case Cone():
            return _revolved([(0, 0), (shape.radius, shape.height), (0, shape.height)])
        case Torus():
            return _revolved(_arc(shape.minor_radius, 0, 2 * np.pi, (shape.major_radius, 0)))
        case Box():
            return (_CORNERS * np.array(shape.size) / 2).astype(np.float32), _quads(_FACES)
        case HalfSpace():
            return (_CORNERS[:4] * [extent, extent, 0]).astype(np.float32), _quads(_FACES[:1])
    raise TypeError(f"shape of type {type(shape).__name__}")


def flat_shaded(vertices: NDArray[np.float32], triangles: NDArray[np.uint32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Three vertices (3 T, 3) of each triangle, and its normal at each (3 T, 3); 0 for a triangle without area."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    unit = normals / np.where(lengths > 0, lengths, 1)
    return corners.reshape(-1, 3), np.repeat(unit, 3, 0).astype(np.float32)


def taxel_pitches(sensor: Sensor) -> NDArray[np.float64]:
    """Distances (num_taxels, 2), m, to the next taxel along x and y of the patch."""
    return np.concatenate([np.repeat([patch.pitch], patch.num_rows * patch.num_cols, 0) for patch in sensor.patches])


def taxel_quads(sensor: Sensor) -> Triangles:
    """A rectangle for each taxel in S: four vertices and two triangles each, vertices in the order of the taxels."""
    pitches = taxel_pitches(sensor)
    halves = taxel_axes(sensor) * pitches[:, :, None] * (TAXEL_SHARE / 2)
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = sensor.taxel_positions[:, None] + np.einsum("cs,tsx->tcx", signs, halves)
    return corners.reshape(-1, 3).astype(np.float32), _quads(np.arange(4 * len(pitches)).reshape(-1, 4))
