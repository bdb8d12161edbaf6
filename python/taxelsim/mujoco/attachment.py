"""Sensors at sites of a MuJoCo model: frames from the state of its simulations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from .._core import Device, Model, Object, OutputOptions, Sensor, load_sensor
from ..errors import InputError
from ..frame import Frame
from ..simulator import Simulator
from .geoms import Geom, find, select
from .poses import Kinematics
from .slots import Slots

Sources = Any
"""What observe() takes: mujoco.MjData, a sequence of MjData, or mujoco.batch.Batch, of num_instances simulations."""


def attach(
    model: Any,
    sensors: Mapping[str, str | PathLike[str] | Sensor],
    geoms: Sequence[str | int] | None = None,
    *,
    num_instances: int = 1,
    device: Device | None = None,
    seed: int = 0,
    outputs: OutputOptions | None = None,
    image_unit: str = "counts",
    max_regions: int = 0,
) -> Attachment:
    """Sensors at sites of a mujoco.MjModel, touched by its geoms. Reads shapes from the model, no files.

    sensors: sensor file, or Sensor, by the name of the site. The frame of the site is the sensor frame S: z out of the skin.
    geoms: names, or numbers, of the geoms that touch them; default: all but those on the body of the sensor. A plane is infinite, a mesh
        touches with its triangles and not with its convex hull, an ellipsoid becomes a mesh within 10 um.
    num_instances: N, simulations that observe() takes.
    device, seed, outputs, image_unit, max_regions: as for Model and Simulator; default: the best device.

    Raises InputError for a site or geom that is not in the model, a geom that taxelsim has no shape for, no geoms, or a wrong sensor.
    """
    options = {"seed": seed, "outputs": outputs, "image_unit": image_unit, "max_regions": max_regions}
    return Attachment(*read_model(model, sensors, geoms, device), num_instances, options)


def read_model(
    model: Any, sensors: Mapping[str, str | PathLike[str] | Sensor], geoms: Sequence[str | int] | None, device: Device | None
) -> tuple[Any, dict[str, int], dict[str, Sensor], list[Geom], Device]:
    """First arguments of Attachment: the model, sites, sensors, geoms and device."""
    if not sensors:
        raise InputError("sensors: at least one is needed, as {site: sensor file}")
    sites = {name: find(model, "site", name) for name in sensors}
    selected = select(model, geoms, sites.values())
    read = {name: value if isinstance(value, Sensor) else load_sensor(value) for name, value in sensors.items()}
    return model, sites, read, selected, Device.open() if device is None else device


class Attachment:
    """Sensors at the sites of one MjModel. Made by attach()."""

    _moves_bodies: ClassVar = False

    def __init__(
        self,
        model: Any,
        sites: Mapping[str, int],
        sensors: Mapping[str, Sensor],
        geoms: Sequence[Geom],
        device: Device,
        num_instances: int,
        options: Mapping[str, Any],
    ) -> None:
        """options: of Simulator."""
        self.model = model
        self.num_instances = num_instances
        self.sensors = dict(sensors)
        self.geoms = list(geoms)
        self._sites = sites
        self._indices = [geom.index for geom in geoms]
        self._rotations = np.array([geom.rotation for geom in geoms])
        self._slots = {name: Slots(name, sensor, geoms, num_instances) for name, sensor in sensors.items()}
        objects = [Object(geom.shape, geom.name) for geom in geoms]
        models: list[Model] = []
        for sensor in sensors.values():  # sensors of one kind share a model
            if all(sensor != model.sensor for model in models):
                models.append(Model(device, sensor, objects))
        self.simulators = {
            name: Simulator(
                next(model for model in models if model.sensor == sensor),
                num_instances,
                num_slots=self._slots[name].num_slots,
                **options,
            )
            for name, sensor in sensors.items()
        }
        self._kinematics = Kinematics(model, num_instances, with_masses=self._moves_bodies)

    def observe(self, source: Sources, dt: float | None = None, instances: npt.ArrayLike | None = None) -> dict[str, Frame]:
        """Frames of all sensors, by site, at the present state (qpos, mocap_pos, mocap_quat) of the simulations.

        source: a mujoco.batch.Batch with nsim = num_instances, a sequence of as many MjData, or one MjData. It is only read.
        dt: s, simulated time since the last call, in which the skin has moved; default: one time step of the model.
        instances: as in Simulator.step(): gives the first frames of these instances after their reset() only.

        Stage: after mj_step() or Batch.step(), MuJoCo's geom_xpos and site_xpos belong to the start of that step. They are not used: the
        poses of the present qpos are computed here, so that frames are never a step late, whatever stage the caller has computed.

        The frames are arrays over the memory of the simulators, valid until the next call; frame.copy() keeps them. On a skin with
        friction, shear follows from the motion between calls; call reset() after a jump. Raises InputError for another number of
        simulations, a model with other bodies, joints, geoms or sites, or more than eight geoms near a sensor. Masses may differ.
        """
        self._kinematics.update(source)
        step = float(self.model.opt.timestep) if dt is None else dt
        for name, simulator in self.simulators.items():
            simulator.set_objects(*self._slots[name].assign(self._poses(name)))
        for simulator in self.simulators.values():
            simulator.step(step, instances)
        return {name: simulator.read() for name, simulator in self.simulators.items()}

    def _poses(self, name: str) -> npt.NDArray[np.float64]:
        """X_SO (N, G, 7) of all geoms, at the state of the last update of the kinematics."""
        return self._kinematics.relative(self._sites[name], self._indices, self._rotations)

    def reset(self, instances: npt.ArrayLike | None = None, episodes: npt.ArrayLike | None = None, **variation: float) -> None:
        """Starts an episode on some instances of every sensor, after their simulations were reset; see Simulator.reset()."""
        for simulator in self.simulators.values():
            simulator.reset(instances, episodes, **variation)
