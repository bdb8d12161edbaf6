"""A batch of grasps whose joints the caller moves. The Environment of a scene of kind grasp."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked_count
from ._core import Device, OutputOptions, Scene, Sensor
from .environment import NO_OUTPUTS, DoubleArray, EnvironmentLayout, EpisodeArray, EpisodeBatch, split_sensors
from .errors import InputError
from .frame import Arrays, BoolArray, Frame, IntArray


class _FrameByName(dict[str, type[Arrays]]):
    def __missing__(self, name: str) -> type[Arrays]:
        return Frame


class SensorFrames(Arrays):
    """Frame of each sensor of a hand, by the name of the sensor; arrays (N, ...)."""

    _nested: ClassVar = _FrameByName()


class GraspFrame(Arrays):
    """The latest frame of every instance and the state of its episode. N = num_instances; W: world.

    Frames of an instance go on after the end of its episode, until its next reset().
    """

    _nested: ClassVar = {"sensors": SensorFrames}

    sensors: SensorFrames
    """Frame of each sensor, by its name."""
    episodes: EpisodeArray
    """(N), number of the episode."""
    frame_numbers: IntArray
    """(N), 0 to num_frames - 1; larger after the end of the episode."""
    times: DoubleArray
    """(N), s since frame 0."""
    X_WO: DoubleArray
    """(N, num_objects, 7): position (m) and quaternion (w, x, y, z) of each object."""
    X_WS: DoubleArray
    """(N, num_sensors, 7), pose of each sensor."""
    joint_positions: DoubleArray
    """(N, num_joints), rad or m."""
    joint_velocities: DoubleArray
    """(N, num_joints), rad/s or m/s."""
    robot_status: npt.NDArray[np.uint8]
    """(N), what limited the latest motion; bits as in verdicts."""
    target_forces: DoubleArray
    """(N, num_fingers), N, force that each finger must hold."""


class GraspState(Arrays):
    """State of the fingers at the latest frame of the episode, by clean forces. N = num_instances."""

    forces: DoubleArray
    """(N, num_fingers), N, total force."""
    peak_forces: DoubleArray
    """(N, num_fingers), N, largest force so far."""
    num_losses: IntArray
    """(N, num_fingers), times that contact was lost so far."""
    were_in_contact: BoolArray
    """(N, num_fingers): the finger has touched in this episode."""


@dataclass(frozen=True)
class GraspTask:
    """The task of a scene of kind grasp: at the end each finger holds its target force."""

    tolerance: float
    """Fraction of the target force."""
    hold: float
    """s at the end of the episode in which all forces must be within their tolerances."""
    drift: float | None
    """m, largest motion of the centre of pressure in that time. None: not judged."""
    fingers: tuple[str, ...]
    """Names of the sensors of the fingers."""

    @staticmethod
    def of(scene: Scene) -> GraspTask:
        """The task of `scene`, of kind grasp."""
        tolerance, hold, drift, fingers = _core.grasp_task_of(scene)
        return GraspTask(tolerance, hold, drift, tuple(fingers))


@dataclass(frozen=True)
class GraspLayout:
    """Sensors and counts that determine the shapes of the arrays of a frame."""

    sensors: dict[str, Sensor]
    num_joints: int
    num_fingers: int

    @staticmethod
    def of(scene: Scene) -> GraspLayout:
        """The layout of `scene`, of kind grasp."""
        return GraspLayout(dict(scene.sensors), len(_core.joints_of(scene)), len(GraspTask.of(scene).fingers))

    @property
    def num_sensors(self) -> int:
        """Number of sensors."""
        return len(self.sensors)

    def alone(self, sensor: str) -> EnvironmentLayout:
        """The layout of a scene with this sensor only."""
        return EnvironmentLayout(self.sensors[sensor], 1, self.num_joints)


def grasp_frame_of(arrays: Mapping[str, Any]) -> GraspFrame:
    """The arrays of the library, in which sensors with equal settings share their rows, as a frame."""
    num_instances = len(arrays["frame_numbers"])
    sensors = {name: _rows(entry["frame"], num_instances, entry["first_row"]) for name, entry in arrays["sensors"].items()}
    rest = {name: values for name, values in arrays.items() if name != "dt"}
    return GraspFrame({**rest, "times": arrays["dt"] * arrays["frame_numbers"], "sensors": sensors})


def _rows(frame: Mapping[str, Any], num_instances: int, first_row: int) -> dict[str, Any]:
    """The rows first_row, first_row + rows / num_instances, ... of the arrays of a frame."""
    split = split_sensors(frame, num_instances, len(frame["total_force"]) // num_instances)

    def of_sensor(arrays: Mapping[str, Any]) -> dict[str, Any]:
        return {name: of_sensor(values) if isinstance(values, Mapping) else values[:, first_row] for name, values in arrays.items()}

    return of_sensor(split)


class GraspEnvironment(EpisodeBatch):
    """A batch of instances that run episodes of a scene of kind grasp, whose joints the caller moves. See taxelsim.envs for Gymnasium.

    reset(), then in a loop: observe(), step_joints(). The law that closes fingers and the servo of the scene do not act. An episode depends
    on the scene, its number and the velocities alone. generate() and evaluate_grasp() give the same frames for the same velocities, bit for
    bit. Threads and live arrays: as of Environment.
    """

    def __init__(
        self, device: Device, scene: Scene | str | os.PathLike[str], num_instances: int = 1, *, outputs: OutputOptions | None = None
    ) -> None:
        """Allocates all device memory. Raises InputError for a scene of another kind, and if the batch does not fit.

        outputs: optional outputs of frames; default none.
        """
        checked_count("num_instances", num_instances)
        loaded = scene if isinstance(scene, Scene) else _core.load_scene(os.fspath(scene))
        super().__init__(_core.GraspEnvironment(device, loaded, num_instances, outputs or NO_OUTPUTS), loaded)

    @property
    def layout(self) -> GraspLayout:
        """Sensors, and numbers of joints and fingers."""
        return GraspLayout.of(self.scene)

    def step(self, twists: npt.ArrayLike, num_frames: int | None = None) -> None:
        """Raises InputError: a hand has several sensors, and no twist moves all of them."""
        raise InputError("twists are not allowed in a scene of kind grasp: joint velocities, step_joints()")

    def observe(self) -> GraspFrame:
        """The latest frame."""
        return grasp_frame_of(self._batch.arrays())

    def task_state(self) -> GraspState:
        """State of the fingers at the latest frame."""
        return GraspState(self._batch.task_arrays())

    def judge(self, instances: npt.ArrayLike) -> dict[str, npt.NDArray[Any]]:
        """Verdicts on the latest episodes of `instances` (K,), up to the latest frame; arrays as in GraspEvaluation.verdicts.

        A success only once the last frame of the episode has been computed.
        """
        return self._judged(instances)
