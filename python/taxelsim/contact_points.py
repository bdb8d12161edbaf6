"""Contact points of a physics engine, for Simulator.set_contacts()."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ._arrays import QUATERNION_TOLERANCE, rotation_matrices, to_array
from .errors import InputError


class ContactPoints(NamedTuple):
    """Contact points of a batch, sorted by instance: simulator.set_contacts(*points)."""

    positions: npt.NDArray[np.float64]
    """(C, 3), m, in S."""
    normal_forces: npt.NDArray[np.float64]
    """(C), N, >= 0: the component along -z of S."""
    offsets: npt.NDArray[np.int32]
    """(N + 1): instance i has the points offsets[i] to offsets[i + 1] - 1."""


def contact_points(instances: npt.ArrayLike, positions: npt.ArrayLike, forces: npt.ArrayLike, X_WS: npt.ArrayLike) -> ContactPoints:
    """Contact points in the world, as an engine reports them in flat arrays, in the frames of the sensors.

    instances: (C,), 0 to N - 1, in any order: the simulation of each point. positions: (C, 3), m, in W.
    forces: (C, 3), N, in W, that act on the sensor. X_WS: (N, 7), poses of the sensors: position, m, and quaternion (w, x, y, z).

    Arrays may be NumPy arrays, or of any library on the CPU that NumPy can read; np.from_dlpack() takes the others. Points that pull on
    the skin have a normal force of 0. On a sensor of several patches the force along z of S stands for that along the normal of the patch.
    Raises InputError for other shapes, NaN, an instance out of range, and a rotation that is none.
    """
    poses = to_array("X_WS", X_WS, np.float64, [[(-1, "N"), 7]])
    rows = to_array("instances", instances, np.int64, [[(-1, "C")]], per_instance=False)
    places = to_array("positions", positions, np.float64, [[(len(rows), "C"), 3]], per_instance=False)
    pushes = to_array("forces", forces, np.float64, [[(len(rows), "C"), 3]], per_instance=False)
    outside = (rows < 0) | (rows >= len(poses))
    if outside.any():
        raise InputError(f"instances: {rows[outside.argmax()]} of index {outside.argmax()} is not allowed: 0 to {len(poses) - 1}")
    lengths = np.linalg.norm(poses[:, 3:], axis=1)
    wrong = np.abs(lengths - 1) > QUATERNION_TOLERANCE
    if wrong.any():
        raise InputError(f"X_WS: quaternion of length {lengths[wrong.argmax()]:g} found in instance {wrong.argmax()}, 1 allowed")
    order = np.argsort(rows, kind="stable")
    rows = rows[order]
    rotations = rotation_matrices(poses[:, 3:] / lengths[:, np.newaxis])[rows]
    local = np.einsum("cji,cj->ci", rotations, places[order] - poses[rows, :3])
    along = np.einsum("cj,cj->c", rotations[..., 2], pushes[order])
    offsets = np.searchsorted(rows, np.arange(len(poses) + 1)).astype(np.int32)
    return ContactPoints(local, np.maximum(-along, 0), offsets)
