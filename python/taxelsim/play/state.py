"""One press of an object into a sensor: settings in, a frame out. Knows no browser."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import rotation_matrices
from .._core import (
    AreaStiffness,
    DepthSampling,
    Device,
    Model,
    Object,
    Sensor,
    Skin,
    SkinData,
    foundation_of,
    gaussian_psf,
    lowest_point,
    skin_stiffness,
    skins_of,
)
from ..errors import InputError
from ..simulator import Simulator

DEFAULT_STEP = 0.01
"""s, for sensors that report a frame at every step; 1 / DEFAULT_STEP is the default simulation_rate of scenes."""


@dataclass(frozen=True)
class Changes:
    """Settings that replace those of the sensor; None keeps the sensor's."""

    law: str | None = None
    friction: float | None = None  #: Coefficient.
    noise: float | None = None  #: Counts.
    spread: float | None = None  #: Taxels, width of a Gaussian; 0 for none.
    sampling: str | None = None  #: A DepthSampling, in lower case.


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


@dataclass(frozen=True)
class View:
    """A frame of one sensor, copied from its simulator."""

    settings: Settings
    sensor: Sensor
    pose: NDArray[np.float64]  #: (7), position (m) and quaternion of the object's frame in S.
    counts: NDArray[np.int32]  #: (num_taxels).
    shear: NDArray[np.float64]  #: (num_taxels, 2), N.
    features: dict[str, Any]
    load_reached: bool


def law_name(skin: Skin) -> str:
    """Name of a skin's contact law without the underscores that it has in files: "elasticlayer"."""
    return type(skin.law).__name__.lower()


def skin_under(skin: Skin, law: str, friction: float) -> Skin:
    """A skin of the same thickness and area stiffness under another contact law, by its name in files."""
    stiffness = AreaStiffness(foundation_of(skin).normal_contact_stiffness)
    skins = skins_of(skin_stiffness(SkinData(thickness=skin.thickness, stiffness=stiffness)), friction)
    found = [each for each in skins if law_name(each) == law.replace("_", "")]
    if not found:
        raise InputError(f"law: {law!r} is not allowed: {', '.join(map(law_name, skins))}")
    return found[0]


def changed_sensor(sensor: Sensor, changes: Changes) -> Sensor:
    """The sensor with changes, in the steady state that a single frame shows. Raises InputError."""
    skin, readout = sensor.skin, sensor.readout.replace(delay=0.0, low_pass_time=0.0)
    friction = skin.friction.friction_coefficient if changes.friction is None else changes.friction
    if changes.law is not None and changes.law.replace("_", "") != law_name(skin):
        skin = skin_under(skin, changes.law, friction)
    elif changes.friction is not None:
        skin = skin.replace(friction=skin_under(skin, law_name(skin), friction).friction)
    if changes.noise is not None:
        readout = readout.replace(noise=changes.noise)
    sensor = sensor.replace(skin=skin, readout=readout)
    if changes.spread is not None:
        sensor = sensor.replace(psf=gaussian_psf(max(changes.spread, 1e-3), 5, sensor.psf.normalization))
    if changes.sampling is not None:
        sensor = sensor.replace(depth_sampling=DepthSampling[changes.sampling.upper()])
    return sensor


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


class Press:
    """Computes frames. Builds a Model when the sensor changes, which takes seconds; for one thread at a time."""

    def __init__(self, device: Device, sensor: Sensor, objects: list[Object]) -> None:
        self._device = device
        self.base = sensor
        self.objects = objects
        self._changes: Changes | None = None

    def needs_model(self, settings: Settings) -> bool:
        """Whether the next view() builds a Model."""
        return settings.changes != self._changes

    def view(self, settings: Settings) -> View:
        """The frame of a fresh press. Raises InputError."""
        numbers = [settings.x, settings.y, settings.depth, settings.load or 0.0]
        if not np.isfinite(numbers).all():
            raise InputError(f"position, depth or load: {numbers} is not allowed: finite numbers")
        if self.needs_model(settings):
            model = Model(self._device, changed_sensor(self.base, settings.changes), self.objects)
            self._simulator, self._changes = Simulator(model), settings.changes
        simulator = self._simulator
        sensor = simulator.model.sensor
        anchor = np.array(lowest_point(self.objects[settings.object_index], settings.rotation))
        depth = settings.depth if settings.load is None else 0.0
        simulator.reset(episodes=0)
        simulator.set_loads(settings.load)
        simulator.set_objects(settings.object_index, np.array([[settings.x, settings.y, -depth, *settings.rotation]]), anchor=anchor)
        simulator.step(1 / sensor.frame_rate if sensor.frame_rate > 0 else DEFAULT_STEP)
        frame = simulator.read()
        position = np.array([settings.x, settings.y, -depth]) - rotation_matrices(np.array([settings.rotation]))[0] @ anchor
        position[2] += frame.ground_truth.load_offset[0]
        names = ("total_force", "peak_force", "center_of_pressure", "eigenvalues", "edge_angle", "contact_area")
        return View(
            settings,
            sensor,
            np.concatenate([position, settings.rotation]),
            np.array(frame.tactile_image[0]).reshape(-1),
            np.array(frame.ground_truth.tactile_shear_force[0], np.float64).reshape(-1, 2),
            {name: np.array(getattr(frame, name)[0]) for name in names},
            bool(frame.ground_truth.load_reached[0]),
        )
