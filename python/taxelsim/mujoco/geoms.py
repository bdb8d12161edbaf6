"""Geoms and sites of an MjModel by name, and shapes of geoms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from .._core import Mesh
from .._engine_shapes import UPRIGHT, Quaternion, Shape, solid_of
from ..errors import InputError

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
    if kind in ("mesh", "sdf") and model.geom_dataid[index] >= 0:
        return _mesh(model, int(model.geom_dataid[index])), UPRIGHT
    found = solid_of(kind, [float(value) for value in model.geom_size[index]], geom_name(model, index))
    if found is None:
        raise InputError(f"{geom_name(model, index)} is of type {kind}, which cannot touch a sensor: {ALLOWED}")
    return found


def _mesh(model: Any, index: int) -> Mesh:
    vertices = model.mesh_vert[model.mesh_vertadr[index] :][: model.mesh_vertnum[index]]
    triangles = model.mesh_face[model.mesh_faceadr[index] :][: model.mesh_facenum[index]]
    return Mesh(vertices, triangles)
