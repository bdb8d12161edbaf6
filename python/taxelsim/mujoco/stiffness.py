"""How the wrench of a contact changes with the pose of its object, for the implicit coupling."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import product
from .._core import DeviceType, ElasticLayer, Friction, GridPatch, LuGre, Model, Pose, Proximity, Sensor, Winkler
from ..environment import NO_OUTPUTS
from ..errors import InputError
from ..frame import GroundTruth
from ..simulator import Simulator
from .poses import Array

PROBE_SHIFTS = (1e-7, 1e-6)  # m, least and most: hundreds of times the rounding of heights; a thousandth of a usual depth


def check_law(sensor: Sensor, site: str) -> None:
    """Raises InputError for a skin that cannot carry an object."""
    law = sensor.skin.law
    if isinstance(law, Proximity):
        raise InputError(f"sensor {sensor.name!r} at site {site!r}: law proximity has no forces, so it cannot act on MuJoCo's bodies")
    if isinstance(law, Winkler) and law.normal_damping > 0 and law.normal_exponent != 1:
        raise InputError(
            f"sensor {sensor.name!r} at site {site!r}: normal_damping with normal_exponent {law.normal_exponent:g} found; "
            "two-way coupling allows damping with exponent 1 only"
        )


def has_device_jacobian(model: Model) -> bool:
    """Whether the device gives derivatives of the wrench.

    Those of an elastic layer are six solutions by conjugate gradients in one kernel, up to 288 products of all nodes in contact with each
    other: for a contact over the whole array more loop iterations than software Vulkan allows a kernel.
    """
    return not (isinstance(model.sensor.skin.law, ElasticLayer) and model.device.info.type is DeviceType.CPU)


def damping_factor(sensor: Sensor, dt: float) -> float:
    """1 + c / (k dt): what a damper adds to the stiffness over a time step."""
    law = sensor.skin.law
    return 1 + law.normal_damping / (law.normal_contact_stiffness * dt) if isinstance(law, Winkler) else 1


def restoring(stiffness: Array, lever: float) -> Array:
    """The part of (C, 6, 6) that pushes back: symmetric and negative semidefinite, with angles weighted by `lever` (m).

    A large force far from an object's centre of mass can tip it over. An implicit step through such a negative stiffness is singular where
    the time step equals its time constant, so this part stays explicit.
    """
    scale = np.repeat([1, 1 / lever], 3)
    values, vectors = np.linalg.eigh((stiffness + np.swapaxes(stiffness, 1, 2)) / 2 * np.outer(scale, scale))
    return np.asarray((vectors * np.minimum(values, 0)[:, np.newaxis]) @ np.swapaxes(vectors, 1, 2) / np.outer(scale, scale))


class Probe:
    """Finite differences of the normal wrench: seven poses per contact in one batch, of the sensor without friction and relaxation.

    An object is shifted by at most its depth: a light one on a stiff skin is less deep than the usual shift, which would lift a side of it
    off the skin.
    """

    def __init__(self, model: Model, num_contacts: int, lever: float) -> None:
        sensor = model.sensor
        skin = sensor.skin.replace(friction=Friction(), relaxation=[])
        bare = Model(model.device, sensor.replace(skin=skin), model.objects)
        self.simulator = Simulator(bare, 7 * num_contacts, outputs=NO_OUTPUTS)
        self.units = np.repeat([1, 1 / lever], 3)  # of the twist's coordinates: all move the edge of the sensor by about a shift

    def stiffness(self, ids: NDArray[np.int32], poses: Array, depths: Array, dt: float) -> Array:
        """(C, 6, 6): columns are derivatives of the wrench by the twist of the sensor. ids (C), poses X_SO (C, 7), depths (C), m."""
        shifts = np.clip(depths, *PROBE_SHIFTS)[:, np.newaxis] * self.units
        twists = np.zeros((len(ids), 7, 6))
        twists[:, 1:] = shifts[:, :, np.newaxis] * np.eye(6)
        v, w = twists[..., :3], twists[..., 3:]
        p = poses[:, np.newaxis, :3]
        positions = p - v - np.cross(w, p)
        turned = product(np.concatenate((np.ones((*w.shape[:2], 1)), -w / 2), axis=2), poses[:, np.newaxis, 3:])
        moved = np.concatenate((positions, turned / np.linalg.norm(turned, axis=2, keepdims=True)), axis=2)
        self.simulator.reset()
        self.simulator.set_objects(np.repeat(ids, 7), moved.reshape(-1, 7))
        self.simulator.step(dt)
        wrench = self.simulator.read().ground_truth.contact_wrench.astype(np.float64).reshape(-1, 7, 6)
        return np.asarray(np.swapaxes((wrench[:, 1:] - wrench[:, :1]) / shifts[:, :, np.newaxis], 1, 2))


class Shear:
    """Tangential stiffness of a skin with friction, and Coulomb's bound of its wrench. Both are approximations: they only shape the step.

    The bristles of LuGre have damping, which is counted twice: the wrench of the last frame contains it for the last velocity, and what is
    left would flip the velocity in every step if damping dominates (the factor is (m/h - C) / (m/h + 2 C + k h), at least -1/2).
    """

    def __init__(self, sensor: Sensor) -> None:
        law, friction = sensor.skin.law, sensor.skin.friction
        self.law = law if isinstance(law, LuGre) else None
        self.friction = friction
        self.positions = np.asarray(sensor.taxel_positions)
        self.normals = np.asarray(sensor.taxel_normals)
        axes, self.areas = _taxel_axes(sensor.patches)
        # Tangential velocities of the taxels, (T, 2, 6), for a twist of the sensor, and their squares.
        moments = np.cross(self.positions[:, np.newaxis], axes)
        velocity = np.concatenate((axes, moments), axis=2)
        self.squares = np.einsum("tia,tib->tab", velocity, velocity).reshape(-1, 36)

    @staticmethod
    def needed(sensor: Sensor) -> bool:
        """Whether the skin has shear."""
        return isinstance(sensor.skin.law, LuGre) or sensor.skin.friction.friction_coefficient > 0

    def stiffness(self, truth: GroundTruth, dt: float) -> Array:
        """(C, 6, 6) of bristles or springs that stick."""
        force = truth.tactile_normal_force.reshape(len(truth.contact_wrench), -1).astype(np.float64)
        if self.law:
            weights = force * (self.law.bristle_stiffness + 2 * (self.law.bristle_damping + self.law.viscous_friction) / dt)
        else:
            weights = (force > 0) * self.areas * self.friction.tangential_stiffness
        return np.asarray(-(weights @ self.squares).reshape(-1, 6, 6))

    def contact_frame(self, truth: GroundTruth) -> tuple[Array, Array, Array]:
        """Mean normal (C, 3), centre of pressure (C, 3) and radius of gyration (C) of the pressure; 0 without contact."""
        force = truth.tactile_normal_force.reshape(len(truth.contact_wrench), -1).astype(np.float64)
        total = np.maximum(force.sum(axis=1, keepdims=True), 1e-30)
        normal = force @ self.normals
        center = force @ self.positions / total
        spread = (force @ (self.positions**2).sum(axis=1, keepdims=True) / total)[:, 0] - (center**2).sum(axis=1)
        length = np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
        return normal / length, center, np.sqrt(np.maximum(spread, 0) + self.areas.mean() / 6)

    def coefficient(self, sliding: Array) -> Array:
        """Friction coefficient at a sliding speed (C), m/s: for LuGre that of steady sliding."""
        if self.law is None:
            return np.full(len(sliding), self.friction.friction_coefficient)
        drop = np.exp(-((sliding / self.law.stribeck_velocity) ** 2))
        static, coulomb = self.law.static_friction, self.law.coulomb_friction
        return np.minimum(coulomb + (static - coulomb) * drop + self.law.viscous_friction * sliding, static)


def split(wrench: Array, normal: Array, center: Array) -> tuple[Array, Array, Array]:
    """Normal force (C), tangential force (C, 3) and torque about the normal (C) at the centre, of wrenches (C, 6) at the origin."""
    force = wrench[:, :3]
    along = (force * normal).sum(axis=1)
    torsion = ((wrench[:, 3:] - np.cross(center, force)) * normal).sum(axis=1)
    return along, force - along[:, np.newaxis] * normal, torsion


def join(tangential: Array, torsion: Array, normal: Array, center: Array) -> Array:
    """Wrench (C, 6) at the origin of a tangential force at the centre and a torque about the normal."""
    return np.concatenate((tangential, np.cross(center, tangential) + torsion[:, np.newaxis] * normal), axis=1)


def _taxel_axes(patches: Any) -> tuple[Array, Array]:
    """Axes x and y of every taxel in S (T, 2, 3), and areas (T)."""
    axes, areas = [], []
    for patch in patches:
        count = patch.num_rows * patch.num_cols
        axes += [_directions(patch)] * count
        areas += [patch.pitch[0] * patch.pitch[1]] * count
    return np.array(axes), np.array(areas)


def _directions(patch: GridPatch) -> list[list[float]]:
    turn = Pose(rotation=patch.X_SP.rotation)
    return [turn.transform((1, 0, 0)), turn.transform((0, 1, 0))]
