"""Objects that are the shapes of a Newton model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import newton
import numpy as np

from .._core import Mesh, Object
from .._engine_shapes import UPRIGHT, Quaternion, Shape, solid_of
from ..errors import InputError
from .labels import Indices

ALLOWED = "sphere, capsule, cylinder, box, ellipsoid, mesh, convex_mesh and an infinite plane are allowed"


def shape_of(model: Any, index: int) -> tuple[Shape, Quaternion]:
    """Shape in O of a shape of the model, and rotation (w, x, y, z) of O in its frame.

    A mesh is taken with all its triangles, a convex_mesh with its convex hull, which needs SciPy. An ellipsoid becomes a mesh within 10 um.
    Raises InputError for another type, a finite plane, and a barrel.
    """
    kind = newton.GeoType(int(model.shape_type.numpy()[index])).name.lower()
    size = [float(value) for value in model.shape_scale.numpy()[index]]
    name = f"shape {model.shape_label[index]!r}"
    if kind in ("mesh", "convex_mesh"):
        source = model.shape_source[index]
        mesh = source.compute_convex_hull() if kind == "convex_mesh" else source
        triangles = np.reshape(mesh.indices, (-1, 3))
        return Mesh(mesh.vertices * size, triangles if np.prod(size) > 0 else triangles[:, ::-1]), UPRIGHT
    if kind == "plane" and any(size[:2]):
        raise InputError(f"{name} is a plane of {size[0]:g} m by {size[1]:g} m, which cannot touch a sensor: {ALLOWED}")
    if kind == "cylinder" and size[2] != 0:
        raise InputError(f"{name} is a barrel, a cylinder with a barrel radius of {size[2]:g} m, which cannot touch a sensor: {ALLOWED}")
    found = solid_of(kind, size, name)
    if found is None:
        raise InputError(f"{name} is of type {kind}, which cannot touch a sensor: {ALLOWED}")
    return found


def objects_of(model: Any, labels: Sequence[str], indices: Indices) -> tuple[list[Object], list[Quaternion]]:
    """Objects of the shapes (N, S), and R_GO of each. Raises InputError as shape_of(), and for a shape that differs between worlds."""
    types, scales = model.shape_type.numpy(), model.shape_scale.numpy()
    objects, rotations = [], []
    for label, column in zip(labels, indices.T, strict=True):
        sources = np.array([hash(model.shape_source[index]) for index in column])
        equal = (types[column] == types[column[0]]) & (scales[column] == scales[column[0]]).all(axis=1) & (sources == sources[0])
        if not equal.all():
            raise InputError(f"shape {label!r} of world {np.argmin(equal)} differs from that of world 0: type, size and mesh must be equal")
        shape, rotation = shape_of(model, int(column[0]))
        objects.append(Object(shape, label))
        rotations.append(rotation)
    return objects, rotations
