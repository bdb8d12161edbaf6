"""Which objects of an instance are near its sensor, and in which of its slots."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .._attached import MAX_SLOTS
from .._core import Sensor
from ..errors import InputError
from ..inputs import NO_OBJECT
from .geoms import Geom


def touch_sphere(sensor: Sensor) -> tuple[NDArray[np.float64], float]:
    """Centre (3), m, in S, and radius of a sphere that contains all points that can touch the sensor, and the skin's thickness around."""
    points = np.asarray(sensor.taxel_positions)
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    half_taxel = max(math.hypot(*patch.pitch) for patch in sensor.patches) / 2
    reach = float(np.linalg.norm(points - center, axis=1).max()) + half_taxel
    return center, reach + 2 * sensor.skin.thickness + 2**0.5 * sensor.skin.margin


class Slots:
    """Slots of the objects of one sensor in every instance. An object keeps its slot while it is near, so that friction follows it."""

    def __init__(self, label: str, sensor: Sensor, geoms: Sequence[Geom], num_instances: int) -> None:
        self.label = label
        self.center, self.reach = touch_sphere(sensor)
        self.geoms = geoms
        self.reaches = self.reach + np.array([geom.radius for geom in geoms])
        self.is_plane = np.isinf(self.reaches)
        self.num_slots = min(len(geoms), MAX_SLOTS)
        self.slot_of = np.full((num_instances, len(geoms)), -1)  # -1: far

    def near(self, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(N, G): objects with poses X_SO (N, G, 7) whose bounding sphere meets the sensor's."""
        offsets = poses[..., :3] - self.center
        near: NDArray[np.bool_] = np.linalg.norm(offsets, axis=2) < self.reaches
        if self.is_plane.any():
            # The component along z of the half-space, third column of the rotation, of the vector to the centre of the sensor.
            w, x, y, z = np.moveaxis(poses[:, self.is_plane, 3:], -1, 0)
            axis = np.stack((2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)), axis=-1)
            near[:, self.is_plane] = -(offsets[:, self.is_plane] * axis).sum(axis=2) > -self.reach
        return near

    def assign(self, poses: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Ids (N, S) and poses (N, S, 7) of the near objects, for Simulator.set_objects(). Raises InputError for more than eight.

        Up to eight geoms have a slot each; of more, a geom that comes near takes the first free slot.
        """
        num_instances, num_geoms = self.slot_of.shape
        near = self.near(poses)
        if num_geoms > MAX_SLOTS:
            self._reassign(near)
            slots = self.slot_of
        else:
            slots = np.where(near, np.arange(num_geoms), -1)
        ids = np.full((num_instances, self.num_slots), NO_OBJECT, np.int32)
        chosen = np.tile([0.0, 0, 0, 1, 0, 0, 0], (num_instances, self.num_slots, 1))
        rows, columns = np.nonzero(slots >= 0)
        ids[rows, slots[rows, columns]] = columns
        chosen[rows, slots[rows, columns]] = poses[rows, columns]
        return ids, chosen

    def _reassign(self, near: NDArray[np.bool_]) -> None:
        counts = near.sum(axis=1)
        if counts.max() > MAX_SLOTS:
            row = int(counts.argmax())
            raise InputError(
                f"instance {row}: {counts[row]} geoms are near {self.label}, at most {MAX_SLOTS} allowed; name fewer in geoms=[...]"
            )
        slot_of = np.where(near, self.slot_of, -1)
        taken = (slot_of[:, :, np.newaxis] == np.arange(self.num_slots)).any(axis=1)
        for geom in range(slot_of.shape[1]):
            rows = np.flatnonzero(near[:, geom] & (slot_of[:, geom] < 0))
            free = np.argmin(taken[rows], axis=1)
            slot_of[rows, geom] = free
            taken[rows, free] = True
        self.slot_of = slot_of
