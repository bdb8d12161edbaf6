"""A batch of episodes whose actions the caller chooses: reset, observe, act, judge. The seam below the environments of Gymnasium."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked_count, checked_names
from ._arrays import Dimension, to_array
from ._core import OUTPUTS, TASK_MEASURES, Device, OutputOptions, Scene, Sensor
from ._counts import IMAGE_UNITS, newtons_of_counts
from .device_array import on_device, platform_of
from .errors import InputError
from .frame import Arrays, BoolArray, FloatArray, Frame, IntArray

DoubleArray = npt.NDArray[np.float64]
EpisodeArray = npt.NDArray[np.uint64]

NO_OUTPUTS = OutputOptions(**dict.fromkeys(OUTPUTS, False))


class EnvironmentFrame(Frame):
    """The latest frame of every instance and the state of its episode. N = num_instances; S: sensor, W: sensor 0 at the start.

    With several sensors per instance the arrays of Frame are (N, num_sensors, ...). Rows of an instance that is not active are undefined.
    """

    active: BoolArray
    """(N): the instance runs an episode, and this frame belongs to it."""
    control_due: BoolArray
    """(N): control tick, at which the instance takes an action."""
    episodes: EpisodeArray
    """(N), number of the episode."""
    frame_numbers: IntArray
    """(N), 0 to num_frames - 1."""
    times: DoubleArray
    """(N), s since frame 0."""
    objects: IntArray
    """(N), index into Scene.objects."""
    load_reached: BoolArray
    """(N), False: the skin could not carry the load at the start, so the deepest contact is taken."""
    start_force: FloatArray
    """(N), N: load at the start, or measured force of frame 0 if the start is depth-driven."""
    X_SO: DoubleArray
    """(N, num_sensors, 7): position (m) and quaternion (w, x, y, z) of the object in each sensor."""
    X_WO: DoubleArray
    """(N, 7), pose of the object."""
    X_WS: DoubleArray
    """(N, num_sensors, 7), pose of each sensor."""
    joint_positions: DoubleArray
    """(N, num_joints), rad or m."""
    joint_velocities: DoubleArray
    """(N, num_joints), rad/s or m/s."""
    robot_status: npt.NDArray[np.uint8]
    """(N), what limited the latest motion; bits as in verdicts."""


class TaskState(Arrays):
    """State of the task at the latest frame, from ground truth. N = num_instances."""

    errors: DoubleArray
    """(N, 4), by TASK_MEASURES, rad, N or m. NaN: no such criterion. Infinite: undefined, as without contact."""
    within: BoolArray
    """(N): in contact, and all errors are within their tolerances."""
    contact: BoolArray
    """(N): the clean total force is above 0."""
    travel: FloatArray
    """(N), m, path length of the sensor's origin over the object so far."""
    laps: FloatArray
    """(N), turns around the object's contour so far; 0 unless the task requires laps."""
    peak_force: FloatArray
    """(N), N, largest clean total force so far."""
    num_losses: IntArray
    """(N), times that contact was lost so far."""


@dataclass(frozen=True)
class Task:
    """The task of a scene."""

    tolerances: dict[str, float]
    """Tolerance of each criterion, by name out of TASK_MEASURES; rad, N or m."""
    laps: float
    """Turns around the object's contour required."""
    travel: float
    """m, path length required."""
    hold: float
    """s at the end of the episode in which all errors must be within their tolerances."""

    @staticmethod
    def of(scene: Scene) -> Task:
        """The task of `scene`. Raises InputError if it has none."""
        if not scene.has_task:
            raise InputError(f"{scene.file}: this scene has no `task`, which an environment needs")
        tolerances, laps, travel, hold = _core.task_of(scene)
        return Task({name: value for name, value in zip(TASK_MEASURES, tolerances, strict=True) if not np.isnan(value)}, laps, travel, hold)


@dataclass(frozen=True)
class EnvironmentLayout:
    """Sensor and joints, which determine the shapes of the arrays of a frame."""

    sensor: Sensor
    num_sensors: int
    num_joints: int

    @property
    def image_shape(self) -> tuple[int, ...]:
        """(rows, cols) of a sensor of one patch, else (num_taxels,)."""
        patches = self.sensor.patches
        return (patches[0].num_rows, patches[0].num_cols) if len(patches) == 1 else (self.sensor.num_taxels,)

    @property
    def saturation(self) -> int:
        """Largest count of a taxel."""
        return self.sensor.readout.saturation

    def newtons_of_counts(self) -> FloatArray:
        """(saturation + 1): force (N) that reads each count on the nominal curve."""
        return newtons_of_counts(self.sensor.readout)


def frame_of(arrays: Mapping[str, Any], num_instances: int, num_sensors: int) -> EnvironmentFrame:
    """The arrays of the library, which have num_instances x num_sensors rows of sensors, as a frame."""
    sensors = arrays["frame"] if num_sensors == 1 else split_sensors(arrays["frame"], num_instances, num_sensors)
    return EnvironmentFrame({**sensors, **{name: values for name, values in arrays.items() if name != "frame"}})


def split_sensors(arrays: Mapping[str, Any], num_instances: int, num_sensors: int) -> dict[str, Any]:
    """Arrays (num_instances x num_sensors, ...) as (num_instances, num_sensors, ...)."""
    return {
        name: split_sensors(values, num_instances, num_sensors)
        if isinstance(values, Mapping)
        else values.reshape(num_instances, num_sensors, *values.shape[1:])
        for name, values in arrays.items()
    }


class EpisodeBatch:
    """Instances that run episodes, whose joints the caller moves: base of the batches of all kinds of scenes."""

    def __init__(self, batch: _core.Environment | _core.GraspEnvironment, scene: Scene) -> None:
        self._batch: Any = batch
        self._scene = scene
        self._N: Dimension = (batch.num_instances, "N")

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self._scene

    @property
    def num_instances(self) -> int:
        """N."""
        return int(self._batch.num_instances)

    @property
    def num_frames(self) -> int:
        """Frames per episode."""
        return int(self._batch.num_frames)

    @property
    def control_period(self) -> int:
        """Frames from one control tick to the next."""
        return int(self._batch.control_period)

    @property
    def dt(self) -> float:
        """s, from one frame to the next."""
        return float(self._batch.dt)

    def reset(self, mask: npt.ArrayLike, episodes: npt.ArrayLike) -> None:
        """Starts episode episodes[i] on every instance i with mask[i], and computes its frame 0. Waits.

        mask: (N,) booleans. episodes: (N,) integers, 0 to 2^64 - 1; see episode_keys(). All other instances stay as they are, bit for bit.
        """
        checked = to_array("mask", mask, np.bool_, [[self._N]])
        self._batch.reset(checked.view(np.uint8), to_array("episodes", episodes, np.uint64, [[self._N]]))

    def step_joints(self, velocities: npt.ArrayLike, num_frames: int | None = None) -> None:
        """Commands joint velocities (N, num_joints; rad/s or m/s), and advances by some frames; default: one control period. Waits.

        Velocities beyond a limit are reduced. Raises InputError, and changes nothing, for another shape or dtype, or for a value that is
        not finite.
        """
        checked = to_array("velocities", velocities, np.float64, [[self._N, self._batch.num_joints]])
        self._batch.step_joints(checked, self._frames(num_frames))

    def advance(self, num_frames: int) -> None:
        """Advances by some frames; the robots keep their actions. Waits for the last frame."""
        self._batch.advance(self._frames(num_frames))

    def _judged(self, instances: npt.ArrayLike) -> dict[str, npt.NDArray[Any]]:
        checked = to_array("instances", instances, np.int32, [[(-1, "K")]], per_instance=False)
        verdicts: dict[str, npt.NDArray[Any]] = self._batch.judge(checked)
        return verdicts

    def _frames(self, num_frames: int | None) -> int:
        return self.control_period if num_frames is None else checked_count("num_frames", num_frames)

    def __repr__(self) -> str:
        return f"<taxelsim.{type(self).__name__} of {self.num_instances} instances of {self._scene.name}>"


class Environment(EpisodeBatch):
    """A batch of instances that run episodes of a scene of kind servo. See taxelsim.envs for environments of Gymnasium.

    reset(), then in a loop: observe(), step(). An episode depends on the scene, its number and the actions alone, whatever the number of
    instances. An instance whose episode has ended is not active until its next reset(). generate() and evaluate() give the same frames for
    the same actions, bit for bit.

    Threads may share an environment; calls wait for each other. Whatever waits for the device releases the GIL. Arrays of a frame and of a
    task state show the memory of the environment: they stay valid for as long as they exist, and change with the next step() or reset().
    """

    def __init__(
        self,
        device: Device,
        scene: Scene | str | os.PathLike[str],
        num_instances: int = 1,
        *,
        outputs: OutputOptions | None = None,
        image_unit: str = "counts",
        max_regions: int = 0,
        memory: str = "host",
    ) -> None:
        """Allocates all device memory. Raises InputError for a scene of another kind, and if the batch does not fit.

        outputs: optional outputs of frames; default none. image_unit: of frame.tactile_image, "counts", or "newtons" by the nominal curve.
        max_regions: rows of contact features for regions, 0 to 8.
        memory: where tactile_image and taxel_counts lie, as for Simulator; the host has all other arrays.
        """
        checked_names("image_unit", image_unit, IMAGE_UNITS)
        platform = platform_of(memory, device, image_unit)
        loaded = scene if isinstance(scene, Scene) else _core.load_scene(os.fspath(scene))
        super().__init__(_core.Environment(device, loaded, num_instances, outputs or NO_OUTPUTS, max_regions, platform), loaded)
        self._newtons = newtons_of_counts(self._scene.sensor.readout) if image_unit == "newtons" else None

    @property
    def layout(self) -> EnvironmentLayout:
        """Sensor, and numbers of sensors and joints."""
        return EnvironmentLayout(self._scene.sensor, self._batch.num_sensors, self._batch.num_joints)

    def step(self, twists: npt.ArrayLike, num_frames: int | None = None) -> None:
        """Commands `twists`, and advances by some frames; default: one control period. Waits for the last frame.

        twists: (N, 6), linear (m/s) and angular velocity (rad/s) of sensor 0 in S. Rows of instances that are not active, or whose control
        tick is not due, are ignored. Raises InputError, and changes nothing, for another shape or dtype, or for NaN.
        """
        self._batch.step(to_array("twists", twists, np.float64, [[self._N, 6]]), self._frames(num_frames))

    def observe(self) -> EnvironmentFrame:
        """The latest frame."""
        arrays = self._batch.arrays()
        if self._newtons is not None:
            arrays["frame"]["tactile_image"] = self._newtons[arrays["frame"]["tactile_image"]]
        return frame_of(on_device(self._batch, arrays), self.num_instances, self._batch.num_sensors)

    def task_state(self) -> TaskState:
        """State of the task at the latest frame. Raises InputError for a scene without a task."""
        return TaskState(self._batch.task_arrays())

    def judge(self, instances: npt.ArrayLike) -> dict[str, npt.NDArray[Any]]:
        """Verdicts on the latest episodes of `instances` (K,), up to the latest frame; arrays (K, ...) as in Evaluation.verdicts.

        A success only once the last frame of the episode has been computed.
        """
        return self._judged(instances)


def episode_keys(seeds: npt.ArrayLike, instances: npt.ArrayLike, num_resets: npt.ArrayLike) -> EpisodeArray:
    """Numbers of episodes for resets of instances, (K,): a hash of the seed, the index and the count, which are broadcast.

    Independent of the number of instances, so that a batch of any size runs the same episodes.
    """
    columns = np.broadcast_arrays(np.asarray(seeds, np.uint64), np.asarray(instances, np.uint32), np.asarray(num_resets, np.uint64))
    keys: Any = _core.episode_keys(*(np.ascontiguousarray(np.atleast_1d(column)) for column in columns))
    return np.asarray(keys, np.uint64)
