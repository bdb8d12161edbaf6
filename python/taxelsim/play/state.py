"""Objects that press into sensors: settings in, frames out. Knows no browser.

A sensor alone is pressed by one object of a list. Sensors of a robot touch all objects at once, where joints place them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import rotation_matrices
from .._core import Device, Model, Object, Pose, Robot, Sensor, lowest_point
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
    positions: tuple[float, ...] = ()  #: Joint positions of a robot, rad or m.
    objects: tuple[Pose, ...] = ()  #: X_WO of all objects around a robot, which count instead of the pressed object.
    follows: bool = True  #: Whether a frame goes on from the one before, so that sliding adds up shear; else each is a fresh press.

    @property
    def row(self) -> list[float]:
        """The pose (7) for set_objects() with the lowest point as its anchor, m and a quaternion. With a load the device finds z."""
        return [self.x, self.y, -self.depth if self.load is None else 0.0, *self.rotation]


@dataclass(frozen=True)
class View:
    """A frame of one sensor, copied from its simulator."""

    name: str  #: Name of the sensor of a robot; empty for a sensor alone.

    path: tuple[Settings, ...]  #: Steps since the skin was fresh; the last one is that of the frame.
    sensor: Sensor
    pose: NDArray[np.float64]  #: (7), position (m) and quaternion of the object's frame in S; the first object's for a robot.
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


def finite_position(values: Any) -> list[float]:
    """Three finite numbers. Raises InputError."""
    p = np.asarray(values, np.float64)
    if p.shape != (3,) or not np.isfinite(p).all():
        raise InputError(f"position: {values!r:.60} is not allowed: three finite numbers")
    return [float(value) for value in p]


def settings_at(settings: Settings, item: Object, position: Any, rotation: Any) -> Settings:
    """Settings with the object's frame at a pose in S. Raises InputError for numbers that are not finite."""
    R = unit_quaternion(rotation)
    lowest = np.array(finite_position(position)) + rotation_matrices(np.array([R]))[0] @ np.array(lowest_point(item, R))
    return replace(settings, x=float(lowest[0]), y=float(lowest[1]), depth=float(-lowest[2]), rotation=R)


def with_object_at(settings: Settings, number: int, position: Any, rotation: Any) -> Settings:
    """Settings with one of the objects around a robot at another pose X_WO. Raises InputError for numbers that are not finite."""
    pose = Pose(finite_position(position), unit_quaternion(rotation))
    return replace(settings, objects=(*settings.objects[:number], pose, *settings.objects[number + 1 :]))


def step_time(sensor: Sensor) -> float:
    """s, of one step: until the next frame of the sensor."""
    return 1 / sensor.frame_rate if sensor.frame_rate > 0 else DEFAULT_STEP


@dataclass(frozen=True)
class Group:
    """Sensors with equal settings: one simulator with an instance for each."""

    names: list[str]
    simulator: Simulator


class Press:
    """Computes frames. Builds models when the sensors change, which takes seconds; for one thread at a time."""

    def __init__(self, device: Device, sensors: Mapping[str, Sensor], items: list[Item], robot: Robot | None = None) -> None:
        """sensors: by name, of the robot; without a robot one sensor."""
        self._device = device
        self.sensors = dict(sensors)
        self.items = items
        self.robot = robot
        self._changes: Changes | None = None
        self._views: tuple[View, ...] = ()
        self.groups: list[Group] = []
        """Simulators of the newest views."""

    def add(self, item: Item) -> int:
        """Adds an object and returns its index. The next views() builds models."""
        self.items = [*self.items, item]
        self._changes = None
        return len(self.items) - 1

    def needs_model(self, settings: Settings) -> bool:
        """Whether the next views() builds models."""
        return settings.changes != self._changes

    def views(self, settings: Settings) -> tuple[View, ...]:
        """The frame of each sensor after the next step. Raises InputError, and then nothing has changed."""
        if not np.isfinite([*settings.row, settings.load or 0.0]).all():
            raise InputError(f"position, depth or load: {settings.row[:3]} is not allowed: finite numbers")
        if self.needs_model(settings):
            self.groups, self._changes, self._views = self._built(settings.changes), settings.changes, ()
        path: tuple[Settings, ...] = (settings,)
        if self._views and self._goes_on(self._views, settings):
            path = (*self._views[0].path, settings)
        else:
            for group in self.groups:
                group.simulator.reset()
        self._views = ()  # until the step has been done
        found = {}
        for group in self.groups:
            frame = self._step(group, settings)
            found.update({name: self._view_of(frame, row, group, path) for row, name in enumerate(group.names)})
        self._views = tuple(found[name] for name in self.sensors)
        return self._views

    def linearize(self) -> Linearization:
        """Repeats the path of the newest view of a sensor alone and gives the derivatives at its end.

        Raises InputError for a sensor that has none, for a robot, and before the first view.
        """
        if len(self._views) != 1:
            raise InputError("linearize: there is no frame yet" if not self._views else "linearize: a robot is not allowed: a sensor alone")
        view, group = self._views[0], self.groups[0]
        group = replace(group, simulator=Simulator(group.simulator.model, outputs=outputs_for()))
        for settings in view.path:
            frame = self._step(group, settings)
        return linearization_of(frame, view.pose)

    def _built(self, changes: Changes) -> list[Group]:
        names: list[tuple[Sensor, list[str]]] = []
        for name, base in self.sensors.items():
            sensor = changed_sensor(base, changes)
            equal = next((group for other, group in names if other == sensor), None)
            if equal is None:
                names.append((sensor, [name]))
            else:
                equal.append(name)
        objects = [item.object for item in self.items]
        num_slots = 1 if self.robot is None else len(objects)
        return [Group(group, Simulator(Model(self._device, s, objects), len(group), num_slots=num_slots)) for s, group in names]

    @staticmethod
    def _goes_on(last: tuple[View, ...], settings: Settings) -> bool:
        touches = any(view.truth.total_force > 0 for view in last)
        before = last[0].path
        return settings.follows and touches and before[-1].object_index == settings.object_index and len(before) < MAX_STEPS

    def _anchor(self, settings: Settings) -> NDArray[np.float64]:
        return np.array(lowest_point(self.items[settings.object_index].object, settings.rotation))

    def _step(self, group: Group, settings: Settings) -> Frame:
        simulator = group.simulator
        simulator.set_loads(settings.load)
        if self.robot is None:
            simulator.set_objects(settings.object_index, np.array([settings.row]), anchor=self._anchor(settings))
        else:
            poses = poses_in_sensors(self.robot, group.names, settings)
            simulator.set_objects(np.tile(np.arange(len(settings.objects)), (len(group.names), 1)), poses)
        simulator.step(step_time(simulator.model.sensor))
        return simulator.read()

    def _view_of(self, frame: Frame, row: int, group: Group, path: tuple[Settings, ...]) -> View:
        settings, truth = path[-1], frame.ground_truth
        if self.robot is None:
            position = np.array(settings.row[:3]) - rotation_matrices(np.array([settings.rotation]))[0] @ self._anchor(settings)
            position[2] += truth.load_offset[0]
            pose = np.concatenate([position, settings.rotation])
        else:
            pose = poses_in_sensors(self.robot, group.names[row : row + 1], settings)[0, 0]
        names = ("total_force", "edge_angle", "contact_area")
        return View(
            group.names[row],
            path,
            group.simulator.model.sensor,
            pose,
            np.array(frame.tactile_image[row]).reshape(-1),
            np.array(truth.tactile_normal_force[row], np.float64).reshape(-1),
            np.array(truth.tactile_shear_force[row], np.float64).reshape(-1, 2),
            {name: float(getattr(frame, name)[row]) for name in names},
            features_of(frame, row),
            bool(truth.load_reached[row]),
        )


def poses_in_sensors(robot: Robot, names: Sequence[str], settings: Settings) -> NDArray[np.float64]:
    """X_SO (len(names), num_objects, 7) of all objects for sensors of a robot."""
    poses = dict(zip((name for name, _ in robot.sensors), robot.sensor_poses(settings.positions), strict=True))
    in_sensors = [[poses[name].inverse() * X_WO for X_WO in settings.objects] for name in names]
    return np.array([[[*X.position, *X.rotation] for X in row] for row in in_sensors])
