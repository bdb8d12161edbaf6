"""Geoms and sites of an MjModel by name, and shapes of geoms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._core import Box, Capsule, Cylinder, HalfSpace, Mesh, Sphere
from ..errors import InputError

Quaternion = tuple[float, float, float, float]
Shape = Mesh | Sphere | Cylinder | Capsule | Box | HalfSpace

ELLIPSOID_ERROR = 1e-5  # m, largest distance between an ellipsoid and its mesh: the default of load_mesh()
MAX_SUBDIVISIONS = 6  # 81,920 triangles
ALLOWED = "sphere, capsule, cylinder, box, ellipsoid, mesh, sdf and plane are allowed"


@dataclass(frozen=True)
class Geom:
    """A geom that sensors can touch."""

    index: int  #: In the model.
    name: str  #: For messages.
    shape: Shape  #: In O.
    rotation: Quaternion  #: R_GO, (w, x, y, z): rotation of O in the frame G of the geom; their origins coincide.
    radius: float  #: m, of a sphere around the origin of G that contains the geom; infinite for a plane.


def geom_name(model: Any, index: int) -> str:
    """The geom in messages: geom 'cube', or geom number 3 if it has no name."""
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, index)
    return f"geom {name!r}" if name else f"geom number {index}"


def find(model: Any, kind: str, name: str | int) -> int:
    """Index of a site or geom. Raises InputError, with the names that exist."""
    count = {"site": model.nsite, "geom": model.ngeom}[kind]
    if isinstance(name, int | np.integer) and not isinstance(name, bool):
        if not 0 <= name < count:
            raise InputError(f"{kind} number {name} is not in the model, which has {count}")
        return int(name)
    of_kind = {"site": mujoco.mjtObj.mjOBJ_SITE, "geom": mujoco.mjtObj.mjOBJ_GEOM}[kind]
    index = int(mujoco.mj_name2id(model, of_kind, name))
    if index < 0:
        names = [repr(found) for i in range(count) if (found := mujoco.mj_id2name(model, of_kind, i))]
        others = f"it has {', '.join(names)}" if names else f"it has no named {kind}"
        raise InputError(f"{kind} {name!r} is not in the model; {others}")
    return index


def select(model: Any, names: Sequence[str | int] | None, bodies: Iterable[int]) -> list[Geom]:
    """Geoms by name or number; without names all that move against a sensor: those that are not welded to the body of every sensor.

    Raises InputError if there is none, one is named twice, or one has a shape that taxelsim does not have.
    """
    if names is None:
        welded = {int(model.body_weldid[body]) for body in bodies}
        indices = [i for i in range(model.ngeom) if {int(model.body_weldid[model.geom_bodyid[i]])} != welded]
    else:
        indices = [find(model, "geom", name) for name in names]
    if not indices:
        raise InputError("the model has no geoms that a sensor could touch" if names is None else "geoms: at least one is needed")
    twice = [i for k, i in enumerate(indices) if i in indices[:k]]
    if twice:
        raise InputError(f"geoms: {geom_name(model, twice[0])} is listed twice")
    return [Geom(i, geom_name(model, i), *shape_of(model, i), _radius(model, i)) for i in indices]


def _radius(model: Any, index: int) -> float:
    return float("inf") if model.geom_type[index] == mujoco.mjtGeom.mjGEOM_PLANE else float(model.geom_rbound[index])


def shape_of(model: Any, index: int) -> tuple[Shape, Quaternion]:
    """Shape of a geom in O, and rotation (w, x, y, z) of O in the frame of the geom.

    A plane is infinite, as in MuJoCo's collisions. A mesh is taken with all its triangles, while MuJoCo's collisions see its convex hull.
    An ellipsoid becomes a mesh within 10 um. Raises InputError for any other type of geom.
    """
    kind = mujoco.mjtGeom(int(model.geom_type[index])).name.removeprefix("mjGEOM_").lower()
    size = [float(value) for value in model.geom_size[index]]
    upright = (1.0, 0.0, 0.0, 0.0)
    if kind == "plane":
        return HalfSpace(), (0.0, 1.0, 0.0, 0.0)  # MuJoCo's is solid below z = 0, a HalfSpace above
    if kind == "sphere":
        return Sphere(radius=size[0]), upright
    if kind == "capsule":
        return Capsule(radius=size[0], length=2 * size[1]), upright
    if kind == "cylinder":
        return Cylinder(radius=size[0], length=2 * size[1]), upright
    if kind == "box":
        return Box(size=(2 * size[0], 2 * size[1], 2 * size[2])), upright
    if kind == "ellipsoid":
        return _ellipsoid(np.array(size), geom_name(model, index)), upright
    if kind in ("mesh", "sdf") and model.geom_dataid[index] >= 0:
        return _mesh(model, int(model.geom_dataid[index])), upright
    raise InputError(f"{geom_name(model, index)} is of type {kind}, which cannot touch a sensor: {ALLOWED}")


def _mesh(model: Any, index: int) -> Mesh:
    vertices = model.mesh_vert[model.mesh_vertadr[index] :][: model.mesh_vertnum[index]]
    triangles = model.mesh_face[model.mesh_faceadr[index] :][: model.mesh_facenum[index]]
    return Mesh(vertices, triangles)


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
