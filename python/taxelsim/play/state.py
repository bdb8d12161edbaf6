"""One press of an object into a sensor: settings in, a frame out. Knows no browser."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import rotation_matrices
from .._core import Device, Model, Object, Sensor, lowest_point
from .._differentiation import outputs_for
from ..errors import InputError
from ..frame import Frame
from ..simulator import Simulator
from .changes import Changes, changed_sensor
from .prediction import Features, Linearization, features_of, linearization_of

DEFAULT_STEP = 0.01
"""s, for sensors that report a frame at every step; 1 / DEFAULT_STEP is the default simulation_rate of scenes."""
MAX_STEPS = 2000
"""Steps of a path; the next one begins a new path."""


@dataclass(frozen=True)
class Item:
    """An object with the words that give it."""

    object: Object
    spec: str  #: In the notation of the command line.
    scale: float = 1.0  #: Metres per unit of a mesh file.
    up_axis: str = "z"  #: Axis of a mesh file that becomes z.


@dataclass(frozen=True)
class Settings:
    """What is pressed, where, and how."""

    object_index: int = 0
    x: float = 0.0  #: m, of the lowest point of the object, in S.
    y: float = 0.0
    rotation: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)  #: w, x, y, z, of the object in S.
    depth: float = 0.0  #: m, of the lowest point below the skin; not used with a load.
    load: float | None = None  #: N.
    changes: Changes = field(default_factory=Changes)
    follows: bool = True  #: Whether a frame goes on from the one before, so that sliding adds up shear; else each is a fresh press.

    @property
    def row(self) -> list[float]:
        """The pose (7) for set_objects() with the lowest point as its anchor, m and a quaternion. With a load the device finds z."""
        return [self.x, self.y, -self.depth if self.load is None else 0.0, *self.rotation]


@dataclass(frozen=True)
class View:
    """A frame of one sensor, copied from its simulator."""

    path: tuple[Settings, ...]  #: Steps since the skin was fresh; the last one is that of the frame.
    sensor: Sensor
    pose: NDArray[np.float64]  #: (7), position (m) and quaternion of the object's frame in S.
    counts: NDArray[np.int32]  #: (num_taxels).
    newtons: NDArray[np.float64]  #: (num_taxels), true normal forces.
    shear: NDArray[np.float64]  #: (num_taxels, 2), N, true.
    features: dict[str, float]  #: Of the tactile image.
    truth: Features
    load_reached: bool

    @property
    def settings(self) -> Settings:
        """Settings of the frame."""
        return self.path[-1]


def unit_quaternion(values: Any) -> tuple[float, float, float, float]:
    """Four finite numbers, scaled to length 1. Raises InputError."""
    q = np.asarray(values, np.float64)
    length = float(np.linalg.norm(q)) if q.shape == (4,) else 0.0
    if not (np.isfinite(length) and length > 1e-6):
        raise InputError(f"rotation: {values!r:.60} is not allowed: a quaternion w, x, y, z")
    w, x, y, z = (q / length).tolist()
    return (w, x, y, z)


def settings_at(settings: Settings, item: Object, position: Any, rotation: Any) -> Settings:
    """Settings with the object's frame at a pose in S. Raises InputError for numbers that are not finite."""
    R = unit_quaternion(rotation)
    p = np.asarray(position, np.float64)
    if p.shape != (3,) or not np.isfinite(p).all():
        raise InputError(f"position: {position!r:.60} is not allowed: three finite numbers")
    lowest = p + rotation_matrices(np.array([R]))[0] @ np.array(lowest_point(item, R))
    return replace(settings, x=float(lowest[0]), y=float(lowest[1]), depth=float(-lowest[2]), rotation=R)


def step_time(sensor: Sensor) -> float:
    """s, of one step: until the next frame of the sensor."""
    return 1 / sensor.frame_rate if sensor.frame_rate > 0 else DEFAULT_STEP


class Press:
    """Computes frames. Builds a Model when the sensor changes, which takes seconds; for one thread at a time."""

    def __init__(self, device: Device, sensor: Sensor, items: list[Item]) -> None:
        self._device = device
        self.base = sensor
        self.items = items
        self._changes: Changes | None = None
        self._view: View | None = None

    def add(self, item: Item) -> int:
        """Adds an object and returns its index. The next view() builds a Model."""
        self.items = [*self.items, item]
        self._changes = None
        return len(self.items) - 1

    def needs_model(self, settings: Settings) -> bool:
        """Whether the next view() builds a Model."""
        return settings.changes != self._changes

    def view(self, settings: Settings) -> View:
        """The frame of the next step. Raises InputError, and then nothing has changed."""
        if not np.isfinite([*settings.row, settings.load or 0.0]).all():
            raise InputError(f"position, depth or load: {settings.row[:3]} is not allowed: finite numbers")
        if self.needs_model(settings):
            model = Model(self._device, changed_sensor(self.base, settings.changes), [item.object for item in self.items])
            self._simulator, self._changes, self._view = Simulator(model), settings.changes, None
        path: tuple[Settings, ...] = (settings,)
        if self._view is not None and self._goes_on(self._view, settings):
            path = (*self._view.path, settings)
        else:
            self._simulator.reset(episodes=0)
        self._view = None  # until the step has been done
        frame = self._step(self._simulator, settings)
        self._view = self._view_of(frame, path)
        return self._view

    def linearize(self) -> Linearization:
        """Repeats the path of the newest view and gives the derivatives at its end. Raises InputError for a sensor that has none."""
        view = self._view
        if view is None:
            raise InputError("linearize: there is no frame yet")
        simulator = Simulator(self._simulator.model, outputs=outputs_for())
        for settings in view.path:
            frame = self._step(simulator, settings)
        return linearization_of(frame, view.pose)

    @staticmethod
    def _goes_on(last: View, settings: Settings) -> bool:
        touches = last.truth.total_force > 0
        return settings.follows and touches and last.settings.object_index == settings.object_index and len(last.path) < MAX_STEPS

    def _anchor(self, settings: Settings) -> NDArray[np.float64]:
        return np.array(lowest_point(self.items[settings.object_index].object, settings.rotation))

    def _step(self, simulator: Simulator, settings: Settings) -> Frame:
        simulator.set_loads(settings.load)
        simulator.set_objects(settings.object_index, np.array([settings.row]), anchor=self._anchor(settings))
        simulator.step(step_time(simulator.model.sensor))
        return simulator.read()

    def _view_of(self, frame: Frame, path: tuple[Settings, ...]) -> View:
        settings, truth = path[-1], frame.ground_truth
        position = np.array(settings.row[:3]) - rotation_matrices(np.array([settings.rotation]))[0] @ self._anchor(settings)
        position[2] += truth.load_offset[0]
        names = ("total_force", "edge_angle", "contact_area")
        return View(
            path,
            self._simulator.model.sensor,
            np.concatenate([position, settings.rotation]),
            np.array(frame.tactile_image[0]).reshape(-1),
            np.array(truth.tactile_normal_force[0], np.float64).reshape(-1),
            np.array(truth.tactile_shear_force[0], np.float64).reshape(-1, 2),
            {name: float(getattr(frame, name)[0]) for name in names},
            features_of(frame),
            bool(truth.load_reached[0]),
        )
