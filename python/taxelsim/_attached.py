"""Simulators of the sensors on the model of a physics engine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy.typing as npt

from ._core import Device, Model, Object, Sensor
from .frame import Frame
from .simulator import Simulator

MAX_SLOTS = 8
"""Objects that an instance of a Simulator can touch at once."""


class AttachedSensors:
    """A Simulator for each sensor, by name. Equal sensors share a Model."""

    def __init__(
        self, device: Device, sensors: Mapping[str, Sensor], objects: Sequence[Object], num_instances: int, options: Mapping[str, Any]
    ) -> None:
        """options: further arguments of Simulator."""
        self.num_instances = num_instances
        self.sensors = dict(sensors)
        models: list[Model] = []
        for sensor in sensors.values():
            if all(sensor != model.sensor for model in models):
                models.append(Model(device, sensor, objects))
        self.simulators = {
            name: Simulator(next(model for model in models if model.sensor == sensor), num_instances, **options)
            for name, sensor in sensors.items()
        }

    def _advance(self, dt: float, instances: npt.ArrayLike | None) -> dict[str, Frame]:
        """Frames of all sensors, by name. A step that raises leaves no frame of another sensor unread."""
        stepped = []
        try:
            for simulator in self.simulators.values():
                simulator.step(dt, instances)
                stepped.append(simulator)
        finally:
            frames = [simulator.read() for simulator in stepped]
        return dict(zip(self.simulators, frames, strict=True))

    def reset(self, instances: npt.ArrayLike | None = None, episodes: npt.ArrayLike | None = None, **variation: float) -> None:
        """Starts an episode on some instances of every sensor, after their simulations were reset; see Simulator.reset()."""
        for simulator in self.simulators.values():
            simulator.reset(instances, episodes, **variation)
