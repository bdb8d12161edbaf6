"""Wrenches between the sensors and the geoms of a coupling, and how they change with the poses."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .._core import OutputOptions
from ..frame import GroundTruth
from ..inputs import NO_OBJECT
from ..simulator import Simulator
from .poses import Array
from .slots import touch_sphere
from .stiffness import Probe, Shear, damping_factor, has_device_jacobian, restoring


class Contacts:
    """Wrenches of the pairs of one sensor and each geom, (N, G), and their stiffness.

    Each pair has an instance of its own, because the wrench of an instance with several objects is their sum. Objects that press on the
    same sample therefore both feel the skin.
    """

    def __init__(self, frames: Simulator, geoms: int, seed: int) -> None:
        sensor = frames.model.sensor
        self.shape = (frames.num_instances, geoms)
        self.sensor = sensor
        self.shear = Shear(sensor) if Shear.needed(sensor) else None
        jacobian = has_device_jacobian(frames.model)
        outputs = OutputOptions(
            tactile_normal_force=self.shear is not None,
            tactile_shear_force=False,
            penetration_depth=not jacobian,
            clean_tactile_jacobian=jacobian,
        )
        count = self.shape[0] * geoms
        self.simulator = Simulator(frames.model, count, seed=seed, outputs=outputs)
        self.lever = touch_sphere(sensor)[1]
        self.probe = None if jacobian else Probe(frames.model, count, self.lever)
        self.truth: GroundTruth
        self.wrench: Array = np.zeros((*self.shape, 6))
        self.normal_stiffness: Array = np.zeros((*self.shape, 6, 6))
        self.shear_stiffness: Array = np.zeros((*self.shape, 6, 6))

    def update(self, near: npt.NDArray[np.bool_], poses: Array, dt: float, instances: npt.ArrayLike | None) -> None:
        """Computes wrench and stiffness at poses X_SO (N, G, 7) of the objects that are near (N, G)."""
        ids = np.where(near, np.arange(self.shape[1]), NO_OBJECT).astype(np.int32).reshape(-1)
        rows = poses.reshape(-1, 7)
        self.simulator.set_objects(ids, rows)
        self.simulator.step(dt, None if instances is None else self.pairs(instances))
        self.truth = self.simulator.read().ground_truth
        self.wrench = self.truth.contact_wrench.astype(np.float64).reshape(*self.shape, 6)
        if self.probe:
            depths = self.truth.penetration_depth.reshape(len(ids), -1).max(axis=1).astype(np.float64)
            stiffness = self.probe.stiffness(ids, rows, depths, dt)
        else:
            stiffness = self.truth.jacobian.contact_wrench.astype(np.float64)
        factor = damping_factor(self.sensor, dt)
        self.normal_stiffness = factor * restoring(stiffness, self.lever).reshape(*self.shape, 6, 6)
        if self.shear is not None:
            self.shear_stiffness = self.shear.stiffness(self.truth, dt).reshape(*self.shape, 6, 6)

    def storable(self) -> Array:
        """(N): upper bound of the elastic energy, J. F d / 2 for a law linear in depth d, with d <= F / K and d <= thickness."""
        force = np.linalg.norm(self.wrench[..., :3], axis=2)
        direction = self.wrench[..., :3] / np.maximum(force, 1e-30)[..., np.newaxis]
        stiffness = -np.einsum("ngi,ngij,ngj->ng", direction, self.normal_stiffness[..., :3, :3], direction)
        # Twice the energy of a linear spring F^2 / K: K grows with depth on round objects, where the energy is 2/3 F^2 / K.
        return np.asarray(np.minimum(force * self.sensor.skin.thickness / 2, force**2 / np.maximum(stiffness, 1e-30)).sum(axis=1))

    def pairs(self, instances: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Mask of the pairs of some instances, of the batch of pairs."""
        mask = np.zeros(self.shape, np.bool_)
        mask[np.atleast_1d(instances)] = True
        return mask.reshape(-1)
