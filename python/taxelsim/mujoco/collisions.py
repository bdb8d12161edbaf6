"""Collisions of MuJoCo that a two-way coupling would count twice."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import mujoco

from ..errors import InputError
from .geoms import Geom, geom_name
from .mounts import Mount


def refuse_collisions(model: Any, mounts: Iterable[Mount], geoms: Iterable[Geom]) -> None:
    """Raises InputError if MuJoCo computes contacts between one of the geoms and a geom on the body of a sensor."""
    if model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONTACT):
        return
    for mount in mounts:
        own = [i for i in range(model.ngeom) if model.geom_bodyid[i] == mount.body]
        for geom in geoms:
            for other in own:
                if _collide(model, geom.index, other):
                    raise InputError(
                        f"{geom.name} and {geom_name(model, other)}, on the body of {mount.label}, collide in MuJoCo as well: "
                        "exclude their bodies by <contact><exclude body1= body2=/></contact>, or clear contype and conaffinity"
                    )


def _collide(model: Any, a: int, b: int) -> bool:
    if any({int(model.pair_geom1[i]), int(model.pair_geom2[i])} == {a, b} for i in range(model.npair)):
        return True
    if not ((model.geom_contype[a] & model.geom_conaffinity[b]) or (model.geom_contype[b] & model.geom_conaffinity[a])):
        return False
    bodies = sorted((int(model.geom_bodyid[a]), int(model.geom_bodyid[b])))
    if (bodies[0] << 16) + bodies[1] in model.exclude_signature:
        return False
    welds = [int(model.body_weldid[body]) for body in bodies]
    if welds[0] == welds[1]:
        return False
    parents = [int(model.body_weldid[model.body_parentid[weld]]) for weld in welds]
    is_family = 0 not in welds and (welds[0] == parents[1] or welds[1] == parents[0])
    return not is_family or bool(model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT))
