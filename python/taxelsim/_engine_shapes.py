"""Shapes that physics engines describe by a kind and half lengths, as objects of taxelsim."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ._core import Box, Capsule, Cylinder, HalfSpace, Mesh, Sphere
from .errors import InputError

Quaternion = tuple[float, float, float, float]
Shape = Mesh | Sphere | Cylinder | Capsule | Box | HalfSpace

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
ELLIPSOID_ERROR = 1e-5  # m, largest distance between an ellipsoid and its mesh: the default of load_mesh()
MAX_SUBDIVISIONS = 6  # 81,920 triangles


def solid_of(kind: str, size: Sequence[float], name: str) -> tuple[Shape, Quaternion] | None:
    """Shape in O of a solid that MuJoCo and Newton describe alike, and rotation (w, x, y, z) of O in the frame of the engine's shape.

    kind: "plane", "sphere", "capsule", "cylinder", "box" or "ellipsoid"; None is returned for another one. A plane is infinite.
    size: (3), m: radius and half length along z, half lengths, or semi-axes. name: in messages.

    Raises InputError for an ellipsoid that is too large for a mesh within 10 um.
    """
    if kind == "plane":
        return HalfSpace(), (0.0, 1.0, 0.0, 0.0)  # an engine's plane is solid below z = 0, a HalfSpace above
    if kind == "sphere":
        return Sphere(radius=size[0]), UPRIGHT
    if kind == "capsule":
        return Capsule(radius=size[0], length=2 * size[1]), UPRIGHT
    if kind == "cylinder":
        return Cylinder(radius=size[0], length=2 * size[1]), UPRIGHT
    if kind == "box":
        return Box(size=(2 * size[0], 2 * size[1], 2 * size[2])), UPRIGHT
    if kind == "ellipsoid":
        return _ellipsoid(np.array(size), name), UPRIGHT
    return None


def _ellipsoid(semi_axes: NDArray[np.float64], name: str) -> Mesh:
    """An icosphere, scaled: no point is farther from the ellipsoid than the largest semi-axis times the distance of the unit spheres."""
    vertices, triangles = _icosahedron()
    for _ in range(MAX_SUBDIVISIONS + 1):
        corners = vertices[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        heights = (normals * corners[:, 0]).sum(axis=1) / np.linalg.norm(normals, axis=1)
        if semi_axes.max() * (1 - heights.min()) <= ELLIPSOID_ERROR:
            return Mesh((vertices * semi_axes).astype(np.float32), triangles)
        vertices, triangles = _subdivide(vertices, triangles)
    raise InputError(f"{name} is an ellipsoid with a semi-axis of {semi_axes.max():g} m, too large for a mesh within 10 um: use a mesh")


def _icosahedron() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    golden = (1 + 5**0.5) / 2
    signs = [(a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array([np.roll((0, a, b), k) for k in range(3) for a, b in signs]) / np.hypot(1, golden)
    # Triangles of mutual neighbours, counter-clockwise from outside.
    near = np.linalg.norm(vertices[:, np.newaxis] - vertices, axis=2) < 1.1
    faces = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]]
    outward = [np.linalg.det(vertices[list(face)]) > 0 for face in faces]
    return vertices, np.array([face if out else face[::-1] for face, out in zip(faces, outward, strict=True)])


def _subdivide(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Splits every triangle into four, with new vertices on the unit sphere."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[unique].sum(axis=1)
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    (a, b, c), (ab, bc, ca) = triangles.T, len(vertices) + index.reshape(-1, 3).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.vstack((vertices, middles)), np.concatenate([np.stack(part, axis=1) for part in parts])
