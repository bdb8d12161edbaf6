"""Products of gradients with the tactile Jacobian of a frame: what an optimiser of poses or of gains needs."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .errors import InputError
from .frame import Frame


class Gradient(NamedTuple):
    """Gradient of a loss, one row per instance: float32 from Simulator.vjp(), float64 from vjp()."""

    twist: npt.NDArray[np.floating[Any]]
    """(N, 6), per m and per rad: by a small twist of the sensor, v of the origin of S, then w, in S. By one of the objects: minus this."""
    gain: npt.NDArray[np.floating[Any]]
    """(N, num_rows, num_cols): by the gain of each taxel; (N, num_taxels) for sensors of several patches."""


def vjp(frame: Frame, cotangent: npt.ArrayLike, gain: npt.ArrayLike = 1.0) -> Gradient:
    """Pulls the gradient of a loss by the forces of taxels, gain * tactile_normal_force, back to the sensor's pose and to the gains.

    `cotangent`: the loss's gradient, in the shape of frame.ground_truth.tactile_normal_force, per N. `gain`: of each taxel, broadcast to
    that shape. The frame needs OutputOptions(taxel_jacobian=True). Forces are smooth in the pose with DepthSampling.AREA; with POINT the
    derivative ignores the samples that come into contact and leave it within a step. Raises InputError for other shapes and for numbers
    that are not finite. Computed on the host in float64 from the frame's arrays; nothing is submitted. Simulator.vjp() computes the same on
    the device.
    """
    truth = frame.ground_truth
    force = np.asarray(truth.tactile_normal_force, dtype=np.float64)
    pulled = np.asarray(cotangent, dtype=np.float64)
    if pulled.shape != force.shape:
        raise InputError(f"cotangent: shape {pulled.shape} is not allowed: {force.shape}, that of tactile_normal_force")
    gains = np.asarray(gain, dtype=np.float64)
    for name, values in (("cotangent", pulled), ("gain", gains)):
        if not np.isfinite(values).all():
            raise InputError(f"{name}: {values[~np.isfinite(values)].flat[0]} is not allowed: finite numbers")
    try:
        weights = np.broadcast_to(gains, force.shape)
    except ValueError:
        raise InputError(f"gain: shape {gains.shape} is not allowed: {force.shape}, or one that broadcasts to it") from None
    jacobian = np.asarray(truth.taxel_jacobian, dtype=np.float64).reshape(len(force), 6, -1)
    twist = np.einsum("nkt,nt->nk", jacobian, (weights * pulled).reshape(len(force), -1))
    return Gradient(twist, pulled * force)
