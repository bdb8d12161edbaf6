"""Forces and features that the tactile Jacobian predicts for another pose of the object."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._arrays import rotation_matrices
from ..frame import Frame


@dataclass(frozen=True)
class Features:
    """Features of the true forces."""

    total_force: float  #: N.
    center_of_pressure: NDArray[np.float64]  #: (3), m, in S.
    edge_angle: float  #: rad.


@dataclass(frozen=True)
class Linearization:
    """Forces and features at a pose, with their derivatives by a twist of the sensor."""

    pose: NDArray[np.float64]  #: (7), of the object in S.
    newtons: NDArray[np.float64]  #: (num_taxels).
    features: Features
    newtons_by_twist: NDArray[np.float64]  #: (6, num_taxels).
    features_by_twist: NDArray[np.float64]  #: (5, 6): total force, centre of pressure, edge angle.

    def newtons_at(self, pose: NDArray[np.float64]) -> NDArray[np.float64]:
        """Normal forces of the taxels (num_taxels), N, to first order; none is below 0."""
        return np.maximum(self.newtons + twist_between(self.pose, pose) @ self.newtons_by_twist, 0)

    def features_at(self, pose: NDArray[np.float64]) -> Features:
        """Features to first order; the edge angle is in (-pi/2, pi/2]."""
        change = self.features_by_twist @ twist_between(self.pose, pose)
        angle = self.features.edge_angle + change[4]
        return Features(
            self.features.total_force + change[0], self.features.center_of_pressure + change[1:4], angle - math.pi * round(angle / math.pi)
        )


def features_of(frame: Frame, instance: int = 0) -> Features:
    """Features of an instance of a frame."""
    truth = frame.ground_truth
    centre = np.array(truth.center_of_pressure[instance], np.float64)
    return Features(float(truth.total_force[instance]), centre, float(truth.edge_angle[instance]))


def linearization_of(frame: Frame, pose: NDArray[np.float64]) -> Linearization:
    """From the first instance of a frame with the outputs of outputs_for(), with one object at `pose`."""
    truth = frame.ground_truth
    rows = [truth.jacobian.total_force[0, :1], truth.jacobian.center_of_pressure[0, 0], truth.jacobian.edge_angle[0, :1]]
    forces = np.array(truth.tactile_normal_force[0], np.float64).reshape(-1)
    by_twist = np.array(truth.taxel_jacobian[0], np.float64).reshape(6, -1)
    return Linearization(pose, forces, features_of(frame), by_twist, np.concatenate(rows).astype(np.float64))


def twist_between(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """The motion (6) of the sensor that changes the pose (7) of an object in S from `first` to `second`, while the object stays.

    Translation of the origin of S (m) and rotation vector (rad), in S.
    """
    before, after = rotation_matrices(np.array([first[3:], second[3:]]))
    rotation = before @ after.T
    axis = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]) / 2
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, (np.trace(rotation) - 1) / 2)
    vector = axis * (angle / sine if sine > 1e-12 else 1.0)
    return np.concatenate([first[:3] - rotation @ second[:3], vector])
