"""Sensors at sites and on geoms of a MuJoCo model: frames from the state of its simulations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from .._arguments import checked_names
from .._attached import AttachedSensors
from .._core import Device, Object, OutputOptions, Proximity, Sensor
from .._log import warn_once
from ..environment import NO_OUTPUTS
from ..errors import InputError
from ..frame import Frame
from ..inputs import NO_OBJECT
from ..simulator import Simulator
from .forces import normal_forces
from .geoms import Geom, select
from .mounts import Mount, SensorSource, mount_of
from .poses import Array, Kinematics
from .slots import Slots
from .stiffness import Shear

FORCES = ("skin", "engine")
"""Sources of the forces of observe()."""

MOST_DIFFERENCE = 0.2  # share of the larger force; skin and MuJoCo differ beyond it
NUM_COMPARISONS, COMPARED = 16, 8  # frames with contact, and simulations of each, that are compared

Sources = Any
"""What observe() takes: mujoco.MjData, a sequence of MjData, or mujoco.batch.Batch, of num_instances simulations."""


def attach(
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
) -> Attachment:
    """Sensors at sites and on geoms of a mujoco.MjModel, touched by its geoms. Reads shapes from the model, no files.

    sensors: sensor file, or Sensor, by the name of the site. The frame of the site is the sensor frame S: z out of the skin.
        A GeomSensor of grid_on_geom() or cover_geom() needs no site and has any name.
    geoms: names, or numbers, of the geoms that touch them; default: all but those on the body of the sensor. A plane is infinite, a mesh
        touches with its triangles and not with its convex hull, an ellipsoid becomes a mesh within 10 um.
    num_instances: N, simulations that observe() takes.
    device, seed, outputs, image_unit, max_regions: as for Model and Simulator; default: the best device.

    Raises InputError for a site or geom that is not in the model, a geom that taxelsim has no shape for, no geoms, or a wrong sensor.
    """
    options = {"seed": seed, "outputs": outputs, "image_unit": image_unit, "max_regions": max_regions}
    return Attachment(*read_model(model, sensors, geoms, device), num_instances, options)


def read_model(
    model: Any, sensors: Mapping[str, SensorSource], geoms: Sequence[str | int] | None, device: Device | None
) -> tuple[Any, dict[str, Mount], dict[str, Sensor], list[Geom], Device]:
    """First arguments of Attachment: the model, mounts, sensors, geoms and device."""
    if not sensors:
        raise InputError("sensors: at least one is needed, as {site: sensor file}")
    found = {name: mount_of(model, name, source) for name, source in sensors.items()}
    mounts = {name: mount for name, (mount, _) in found.items()}
    selected = select(model, geoms, [mount.body for mount in mounts.values()])
    return model, mounts, {name: sensor for name, (_, sensor) in found.items()}, selected, Device.open() if device is None else device


class Attachment(AttachedSensors):
    """Sensors on one MjModel. Made by attach()."""

    _moves_bodies: ClassVar = False

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
        self.model = model
        self.geoms = list(geoms)
        self._mounts = mounts
        self._indices = [geom.index for geom in geoms]
        self._rotations = np.array([geom.rotation for geom in geoms])
        self._slots = {name: Slots(mounts[name].label, sensor, geoms, num_instances) for name, sensor in sensors.items()}
        objects = [Object(geom.shape, geom.name) for geom in geoms]
        num_slots = next(iter(self._slots.values())).num_slots
        super().__init__(device, sensors, objects, num_instances, {"num_slots": num_slots, **options})
        self._alone: dict[str, Simulator] = {}  # an instance for each slot
        self._is_pressed = False
        self._comparisons = NUM_COMPARISONS
        self._kinematics = Kinematics(model, num_instances, with_masses=self._moves_bodies)

    def observe(
        self, source: Sources, dt: float | None = None, instances: npt.ArrayLike | None = None, *, forces: str = "skin"
    ) -> dict[str, Frame]:
        """Frames of all sensors, by name, at the present state (qpos, mocap_pos, mocap_quat) of the simulations.

        source: a mujoco.batch.Batch with nsim = num_instances, a sequence of as many MjData, or one MjData. It is only read.
        dt: s, simulated time since the last call, in which the skin has moved; default: one time step of the model.
        instances: as in Simulator.step(): gives the first frames of these instances after their reset() only.
        forces: "skin": what the skin carries at the poses, which warns once where that differs from MuJoCo's contacts by more than 20 %.
            "engine": the pad is pressed until it carries the normal forces of MuJoCo's contacts of its body with each geom, in their
            component along -z of S; geoms without contact press on nothing. For skins without friction, since MuJoCo's tangential forces
            are not distributed. MuJoCo's forces are those of mj_forward() at the present state, one simulation after the other.

        Loads that the caller has set before, simulators[site].set_loads(), drive the frames of forces="skin".

        Stage: after mj_step() or Batch.step(), MuJoCo's geom_xpos and site_xpos belong to the start of that step. They are not used: the
        poses of the present qpos are computed here, so that frames are never a step late, whatever stage the caller has computed.

        The frames are arrays over the memory of the simulators, valid until the next call; frame.copy() keeps them. On a skin with
        friction, shear follows from the motion between calls; call reset() after a jump. Raises InputError for another number of
        simulations, a model with other bodies, joints, geoms or sites, or more than eight geoms near a sensor. Masses may differ. Raises
        InputError for forces="engine" where a skin has friction or no forces.
        """
        checked_names("forces", forces, FORCES)
        self._kinematics.update(source)
        step = float(self.model.opt.timestep) if dt is None else dt
        if forces == "engine":
            self._press(source, step, instances)
        else:
            self._place()
        frames = self._advance(step, instances)
        if forces == "skin" and not self._moves_bodies and self._comparisons > 0:
            self._compare(source, frames)
        return frames

    def _place(self) -> None:
        """Sets the objects to their poses."""
        for name, simulator in self.simulators.items():
            simulator.set_objects(*self._slots[name].assign(self._poses(name)))
            if self._is_pressed:
                simulator.set_loads(None)
        self._is_pressed = False

    def _press(self, source: Sources, dt: float, instances: npt.ArrayLike | None) -> None:
        """Sets the objects to their poses, and the loads of MuJoCo's contacts."""
        for name, sensor in self.sensors.items():
            refused = f"{self._mounts[name].label}: forces='engine' is not allowed"
            if isinstance(sensor.skin.law, Proximity):
                raise InputError(f"{refused} with the law proximity, which has no forces: 'skin'")
            if Shear.needed(sensor):
                raise InputError(f"{refused} on a skin with friction: 'skin', or friction_coefficient 0")
        engine = normal_forces(self.model, source, self._mounts, self._indices)
        for name, simulator in self.simulators.items():
            ids, poses = self._slots[name].assign(self._poses(name))
            loads = np.where(ids != NO_OBJECT, np.take_along_axis(engine[name], np.maximum(ids, 0), axis=1), 0)
            ids = np.where(loads > 0, ids, NO_OBJECT).astype(np.int32)
            if ((loads > 0).sum(axis=1) > 1).any():
                poses = self._pressed(name, simulator, ids, poses, loads, dt)
            simulator.set_objects(ids, poses)
            total = loads.sum(axis=1)
            simulator.set_loads(total, where=total > 0)
        self._is_pressed = True

    def _pressed(self, name: str, simulator: Simulator, ids: npt.NDArray[np.int32], poses: Array, loads: Array, dt: float) -> Array:
        """Poses (N, S, 7) at which each object alone carries its load."""
        if name not in self._alone:
            self._alone[name] = Simulator(simulator.model, ids.size, outputs=NO_OUTPUTS)
        alone = self._alone[name]
        alone.set_objects(ids.reshape(-1), poses.reshape(-1, 7))
        alone.set_loads(loads.reshape(-1), where=loads.reshape(-1) > 0)
        alone.step(dt)
        moved: Array = poses.copy()
        moved[..., 2] += alone.read().ground_truth.load_offset.reshape(ids.shape)
        return moved

    def _compare(self, source: Sources, frames: Mapping[str, Frame]) -> None:
        """Warns once where the skin and MuJoCo's contacts differ. Looks at a few simulations in the first frames with contact."""
        engine = normal_forces(self.model, source, self._mounts, self._indices, COMPARED)
        for name, values in engine.items():
            expected = values.sum(axis=1)
            found = -frames[name].ground_truth.contact_wrench[: len(expected), 2].astype(np.float64)
            touching = np.flatnonzero(expected > 0)
            if not len(touching):
                continue
            self._comparisons -= 1
            worst = touching[np.abs(found - expected)[touching].argmax()]
            if abs(found[worst] - expected[worst]) > MOST_DIFFERENCE * max(found[worst], expected[worst]):
                self._comparisons = 0
                warn_once(
                    f"site {name!r}, instance {worst}: the skin carries {found[worst]:.3g} N where MuJoCo's contacts have "
                    f"{expected[worst]:.3g} N, because poses drive it; observe(forces='engine') presses it to MuJoCo's forces"
                )
                return

    def _poses(self, name: str) -> npt.NDArray[np.float64]:
        """X_SO (N, G, 7) of all geoms, at the state of the last update of the kinematics."""
        return self._kinematics.relative(self._mounts[name], self._indices, self._rotations)
