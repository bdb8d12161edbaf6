"""MuJoCo's own contacts as contact points on a sensor, without shapes: for engines and scenes where only contacts are of interest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ..contact_points import ContactPoints, contact_points
from ..errors import InputError
from .batch import Batch
from .geoms import find
from .poses import Array


def points_of(model: Any, source: Any, site: str) -> ContactPoints:
    """MuJoCo's contacts with the body of a site, in the frame of the site: simulator.set_contacts(*points_of(...)).

    source: an MjData, a sequence of MjData, or a mujoco.batch.Batch. The contacts of an MjData are those that it holds: after mj_step() of
    the start of that step. Those of a Batch are computed at its present state by mj_forward(), one simulation after the other, because a
    batch does not keep contacts.

    Raises InputError for a site that is not in the model, another model, or another type.
    """
    index = find(model, "site", site)
    datas = _datas(model, source)
    sets = [_contacts(data, index) for data in datas]
    rows = np.repeat(np.arange(len(sets)), [len(positions) for positions, _ in sets])
    poses = np.empty((len(datas), 7))
    for pose, data in zip(poses, datas, strict=True):
        pose[:3] = data.site_xpos[index]
        mujoco.mju_mat2Quat(pose[3:], data.site_xmat[index])
    positions, forces = (np.concatenate(parts) for parts in zip(*sets, strict=True))
    return contact_points(rows, positions, forces, poses)


def _datas(model: Any, source: Any) -> list[Any]:
    if isinstance(source, Batch):
        datas = []
        for i in range(source.nsim):
            data = source.get_data(i)
            mujoco.mj_forward(source.get_model(i), data)
            datas.append(data)
        return datas
    datas = list(source) if isinstance(source, Sequence) else [source]
    for data in datas:
        if not isinstance(data, mujoco.MjData):
            raise InputError(f"{type(data).__name__} is not allowed: MjData, a sequence of MjData, or mujoco.batch.Batch")
        if data.model.nsite != model.nsite or data.model.ngeom != model.ngeom:
            raise InputError(f"MjData of another model: {data.model.nsite} sites and {data.model.ngeom} geoms found")
    return datas


def _contacts(data: Any, site: int) -> tuple[Array, Array]:
    """Positions (C, 3) and forces on the body of the site (C, 3), in the world."""
    model, contact = data.model, data.contact
    body = model.site_bodyid[site]
    first = model.geom_bodyid[contact.geom1] == body
    touching = np.flatnonzero(first ^ (model.geom_bodyid[contact.geom2] == body))
    forces = np.empty((len(touching), 3))
    wrench: NDArray[np.float64] = np.empty(6)
    for row, k in enumerate(touching):
        mujoco.mj_contactForce(model, data, k, wrench)
        # The rows of the frame are the normal, from geom1 to geom2, and two tangents; the force is that on geom2.
        forces[row] = (-1 if first[k] else 1) * (wrench[:3] @ contact.frame[k].reshape(3, 3))
    return np.array(contact.pos[touching], np.float64).reshape(-1, 3), forces
