"""Two-way coupling: the skins push MuJoCo's bodies.

Explicit forces would need time steps of far less than a millisecond: a skin of 2.5e9 N/m^3 under 100 g on a disc of 20 mm oscillates at
2.8 kHz. Here the wrench is implicit in the velocity at the end of the time step h. With the relative twist u = J v of sensor and object
at the sensor, K the derivative of the wrench w by a displacement of the sensor, and A = J M^-1 J^T,

    w* = w + h K u+             wrench during the step
    u+ = u0 + h A (w* - w)      u0: relative twist after a step of MuJoCo under w, with all its other forces and constraints
    =>  (I - h^2 K A) (w* - w) = h K u0

for all contacts of a simulation at once. At rest u0 = 0, so that w* = w: an object rests where the skin carries its weight. Oscillations
faster than the time step are damped, as by any implicit scheme.

Contacts that start, tip or leave the array within a time step could still gain energy, and a skin with normal pressure only is not a
conservative field at its borders. An energy budget bounds this (passivity control; B. Hannaford, J.-H. Ryu, "Time-domain passivity control
of haptic interfaces", IEEE Trans. Robotics and Automation 18(1), 2002): the skins of a simulation never return more work than they took,
and forces that would are scaled down. What was damped leaves the budget slowly, down to the energy that the skins can store.

Each time step takes one frame of the sensors and two evaluations of MuJoCo's dynamics.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from .._arguments import checked_names
from .._core import Device, OutputOptions, Sensor
from ..errors import InputError
from ..frame import Frame
from .attachment import Attachment, Sources, read_model
from .batch import require_batch
from .collisions import refuse_collisions
from .contacts import Contacts
from .engine import Engine, engine_of
from .geoms import Geom
from .mounts import Mount, SensorSource
from .poses import Array
from .stiffness import check_law, join, split

# s. Work that was damped stays in the budget for this long. Without it an object that bounces to rest, and whose last contact starts below
# the equilibrium, where the skin has taken no work, would stay there.
BUDGET_TIME = 0.1
INTEGRATORS = ("Euler", "implicit", "implicitfast")


def couple(
    model: Any,
    sensors: Mapping[str, SensorSource],
    geoms: Sequence[str | int] | None = None,
    *,
    num_instances: int = 1,
    device: Device | None = None,
    seed: int = 0,
    outputs: OutputOptions | None = None,
    image_unit: str = "counts",
    max_regions: int = 0,
) -> Coupling:
    """As attach(), but the skins push the bodies: MuJoCo's time steps are taken by Coupling.step().

    Collisions between the geoms and those on the bodies of the sensors must be off in MuJoCo; all others stay MuJoCo's. At rest the wrench
    is that of the skin at the pose of the object. Integrators Euler, implicit and implicitfast.

    Raises ImportError under MuJoCo 3, and InputError as attach() and for a sensor of law proximity, collisions that are on, and another
    integrator.
    """
    require_batch("taxelsim.mujoco.couple()")
    options = {"seed": seed, "outputs": outputs, "image_unit": image_unit, "max_regions": max_regions}
    return Coupling(*read_model(model, sensors, geoms, device), num_instances, options)


class Coupling(Attachment):
    """Sensors on one MjModel that push the bodies which touch them. Made by couple()."""

    _moves_bodies = True

    def __init__(
        self,
        model: Any,
        mounts: Mapping[str, Mount],
        sensors: Mapping[str, Sensor],
        geoms: Sequence[Geom],
        device: Device,
        num_instances: int,
        options: Mapping[str, Any],
    ) -> None:
        """options: of Simulator."""
        integrator = mujoco.mjtIntegrator(int(model.opt.integrator)).name.removeprefix("mjINT_")
        if integrator.lower() not in [name.lower() for name in INTEGRATORS]:
            raise InputError(f"integrator {integrator} is not allowed: two-way coupling takes {', '.join(INTEGRATORS)}")
        for name, sensor in sensors.items():
            check_law(sensor, name)
        refuse_collisions(model, mounts.values(), geoms)
        super().__init__(model, mounts, sensors, geoms, device, num_instances, options)
        self._contacts = {name: Contacts(simulator, len(geoms), options["seed"]) for name, simulator in self.simulators.items()}
        self._bodies = model.geom_bodyid[self._indices]
        self._observed: Array | None = None
        self._budget: Array = np.zeros(num_instances)
        self._frames: dict[str, Frame] = {}
        self.wrenches: dict[str, Array] = {name: np.zeros((num_instances, len(geoms), 6)) for name in sensors}
        """Wrenches (N, G, 6) on each sensor by each geom during the last time step, N and N m, at the origin of S in S."""

    def observe(
        self, source: Sources, dt: float | None = None, instances: npt.ArrayLike | None = None, *, forces: str = "skin"
    ) -> dict[str, Frame]:
        """As Attachment.observe(), but masses may not differ, and forces are those of the skin. Needed only for first frames."""
        checked_names("forces", forces, ("skin",))
        step = float(self.model.opt.timestep) if dt is None else dt
        self._frames = super().observe(source, step, instances)
        self._update(step, instances)
        self._budget = self._storable()
        return self._frames

    def _update(self, step: float, instances: npt.ArrayLike | None = None) -> None:
        for name, contacts in self._contacts.items():
            poses = self._poses(name)
            contacts.update(self._slots[name].near(poses), poses, step, instances)
        self._observed = self._configuration()

    def _storable(self) -> Array:
        return np.asarray(sum(contacts.storable() for contacts in self._contacts.values()))

    def _configuration(self) -> Array:
        batch = self._kinematics.batch
        parts = [np.asarray(batch.bind(name)).reshape(self.num_instances, -1) for name in ("qpos", "mocap_pos", "mocap_quat")]
        return np.concatenate(parts, axis=1)

    def reset(self, instances: npt.ArrayLike | None = None, episodes: npt.ArrayLike | None = None, **variation: float) -> None:
        """Starts an episode on some instances of every sensor, after their simulations were reset; see Simulator.reset()."""
        super().reset(instances, episodes, **variation)
        for contacts in self._contacts.values():
            contacts.simulator.reset(None if instances is None else contacts.pairs(instances))

    def step(self, source: Sources, nstep: int = 1) -> dict[str, Frame]:
        """Advances MuJoCo by `nstep` time steps under the forces of the skins, and returns the frames at the new state.

        source: as for observe(); its simulations take steps of model.opt.timestep. Their qfrc_applied is as before afterwards: the caller's
            own external forces act besides those of the skins.

        A state that the caller has changed since the last call is observed first. `wrenches` has the wrenches that acted in the last step:
        while a contact moves they are damped and differ from frame.ground_truth.contact_wrench, the wrench at the pose of the frame.
        Raises InputError as observe(), and for a model with other masses.
        """
        engine = engine_of(source)
        self._kinematics.update(source)
        if self._observed is None or not np.array_equal(self._observed, self._configuration()):
            self.observe(source)
        dt = float(self.model.opt.timestep)
        for _ in range(nstep):
            before = engine.velocities.copy()
            forces = self._forces(engine, dt)
            engine.step(forces)
            returned = dt * (forces * (before + engine.velocities)).sum(axis=1) / 2
            self._frames = super().observe(source, dt)
            self._update(dt)
            self._budget = np.maximum(self._budget - returned, 0)
            excess = np.maximum(self._budget - self._storable(), 0)
            self._budget -= excess * (1 - math.exp(-dt / BUDGET_TIME))
        return self._frames

    def _forces(self, engine: Engine, dt: float) -> Array:
        """Generalized forces (N, nv) of all skins during the next time step, from the poses and wrenches of the last frames."""
        pairs = [(name, g) for name, c in self._contacts.items() for g in range(len(self.geoms)) if c.wrench[:, g].any()]
        for wrench in self.wrenches.values():
            wrench[:] = 0
        if not pairs:
            return np.zeros((self.num_instances, self.model.nv))
        jacobian = np.stack([self._relative_jacobian(name, g) for name, g in pairs], axis=1)  # (N, P, 6, nv)
        wrench = np.stack([self._contacts[name].wrench[:, g] for name, g in pairs], axis=1)
        transposed = np.swapaxes(jacobian.reshape(self.num_instances, -1, self.model.nv), 1, 2)  # (N, nv, 6 P)
        accelerations = engine.accelerations((transposed @ wrench.reshape(self.num_instances, -1, 1))[..., 0])
        mass, implicit = self._kinematics.mass_matrices(dt)
        right = np.concatenate((transposed, mass @ accelerations[..., np.newaxis]), axis=2)
        solved = np.linalg.solve(implicit, right)
        mobility = np.swapaxes(transposed, 1, 2) @ solved[..., :-1]
        free = np.swapaxes(transposed, 1, 2) @ (engine.velocities[..., np.newaxis] + dt * solved[..., -1:])
        total = self._implicit(pairs, wrench, mobility, free.reshape(wrench.shape), dt)
        now = (np.swapaxes(transposed, 1, 2) @ engine.velocities[..., np.newaxis])[..., 0]
        total *= self._passive(total, wrench, mobility, now + free[..., 0], dt)[:, np.newaxis, np.newaxis]
        for k, (name, g) in enumerate(pairs):
            self.wrenches[name][:, g] = total[:, k]
        return np.asarray((transposed @ total.reshape(self.num_instances, -1, 1))[..., 0])

    def _relative_jacobian(self, name: str, geom: int) -> Array:
        """(N, 6, nv): twist of the sensor against the object, at the origin of S in S, per velocity."""
        kinematics, mount = self._kinematics, self._mounts[name]
        points, rotations, _ = kinematics.frames_of(mount)
        sensor = kinematics.batch.jac(mount.body, points)
        body = kinematics.batch.jac(int(self._bodies[geom]), points)
        inverse = np.swapaxes(rotations, 1, 2)
        return np.concatenate([inverse @ (a - b) for a, b in zip(sensor, body, strict=True)], axis=1)

    def _implicit(self, pairs: list[tuple[str, int]], wrench: Array, mobility: Array, free: Array, dt: float) -> Array:
        """w* (N, P, 6). Contacts that would pull are left out; those that would slip beyond Coulomb's bound slide at it."""
        normal = np.stack([self._contacts[name].normal_stiffness[:, g] for name, g in pairs], axis=1)
        shear = np.stack([self._contacts[name].shear_stiffness[:, g] for name, g in pairs], axis=1)
        none = np.zeros_like(wrench)
        total = wrench + _solve(normal + shear, none, mobility, free, dt)
        if shear.any():
            slip, change = self._slip(pairs, wrench, total, free)
            total = wrench + _solve(normal + np.where(slip[..., np.newaxis, np.newaxis], 0, shear), change, mobility, free, dt)
        pulls = (total[..., :3] * wrench[..., :3]).sum(axis=2) < 0
        pulls |= ~wrench.any(axis=2)
        return np.where(pulls[..., np.newaxis], 0, total)

    def _passive(self, total: Array, wrench: Array, mobility: Array, twists: Array, dt: float) -> Array:
        """Factor (N) of w*, 0 to 1, with which the skins return at most the budget.

        The work is h w . (u + u+) / 2, the change of kinetic energy: a s^2 + b s for a factor s. twists (N, 6 P): u + u0.
        """
        flat = total.reshape(len(total), -1)
        moved = (mobility @ flat[..., np.newaxis])[..., 0]
        under = (mobility @ wrench.reshape(len(total), -1, 1))[..., 0]
        a = dt * dt * (flat * moved).sum(axis=1) / 2
        b = dt * (flat * (twists - dt * under)).sum(axis=1) / 2
        root = np.sqrt(b * b + 4 * a * self._budget)
        with np.errstate(divide="ignore", invalid="ignore"):
            largest = np.where(b > 0, 2 * self._budget / (b + root), (root - b) / (2 * a))
        return np.where(a + b > self._budget, np.clip(np.nan_to_num(largest, nan=0.0), 0, 1), 1)

    def _slip(self, pairs: list[tuple[str, int]], wrench: Array, total: Array, free: Array) -> tuple[npt.NDArray[np.bool_], Array]:
        """Which contacts (N, P) slip, and the change of their wrenches (N, P, 6) to Coulomb's bound."""
        slip = np.zeros(wrench.shape[:2], np.bool_)
        change = np.zeros_like(wrench)
        for k, (name, g) in enumerate(pairs):
            contacts = self._contacts[name]
            if contacts.shear is None:
                continue
            frames = [part.reshape(*contacts.shape, *part.shape[1:])[:, g] for part in contacts.shear.contact_frame(contacts.truth)]
            normal, center, radius = frames
            _, old_force, old_torsion = split(wrench[:, k], normal, center)
            along, force, torsion = split(total[:, k], normal, center)
            velocity = free[:, k, :3] + np.cross(free[:, k, 3:], center)
            sliding = np.linalg.norm(velocity - (velocity * normal).sum(axis=1, keepdims=True) * normal, axis=1)
            bound = np.maximum(contacts.shear.coefficient(sliding) * np.maximum(-along, 0), 1e-30)
            excess = np.hypot(np.linalg.norm(force, axis=1), torsion / radius) / bound
            slip[:, k] = excess > 1
            scale = 1 / np.maximum(excess, 1)
            limited = join(force * scale[:, np.newaxis] - old_force, torsion * scale - old_torsion, normal, center)
            change[:, k] = np.where(slip[:, k, np.newaxis], limited, 0)
        return slip, change


def _solve(stiffness: Array, change: Array, mobility: Array, free: Array, dt: float) -> Array:
    """w* - w (N, P, 6) = h K u+ + change, with stiffness K (N, P, 6, 6) of each contact."""
    count, pairs = free.shape[0], stiffness.shape[1]
    u0 = free.reshape(count, pairs, 6, 1)
    right = dt * (stiffness @ u0)[..., 0] + change
    rows = stiffness @ mobility.reshape(count, pairs, 6, 6 * pairs)
    matrix = np.eye(6 * pairs) - dt * dt * rows.reshape(count, 6 * pairs, 6 * pairs)
    return np.asarray(np.linalg.solve(matrix, right.reshape(count, -1, 1))).reshape(count, pairs, 6)
