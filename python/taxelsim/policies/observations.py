"""Observations by name: what a policy sees of a batch of episodes.

| name | shape of one environment | content, SI units |
|---|---|---|
| `contact` | (6) | centre of pressure (x, y, z), m, then force on the sensor (x, y, z), N, both in S |
| `tactile_image` | (rows, cols) of one patch, else (taxels) | counts, int32; or newtons by the nominal curve, float32 |
| `taxel_counts` | (rows, cols, 3) of one patch, else (taxels, 3) | counts of three-axis taxels along x, y and the normal, int32 |
| `binary_contact` | (1) | 1 if a taxel is above its trigger, else 0 |
| `binary_image` | (rows, cols) of one patch, else (taxels) | 1 for each taxel with counts, else 0 |
| `center_of_pressure` | (3) | of the tactile image, m, in S; 0 without contact |
| `features` | (13) | moments of the tactile image, in the order of FEATURES |
| `proprioception` | (7 + joints) | pose of S relative to its start: position, m, quaternion (w, x, y, z); joint positions, rad or m |
| `joint_positions`, `joint_velocities` | (joints) | rad or m; rad/s or m/s |
| `start_contact` | (6) | `contact` in the first frame of the episode |
| `target_force` | (fingers) | N, force that each finger must hold; scenes of kind grasp |

All but counts are float32. With several sensors per environment those of a sensor have an axis (sensors) in front, `binary_contact` is
(sensors), and `proprioception` has 7 numbers per sensor. Centre, z of the force and features come from the tactile image, so gain and noise
of the sensor affect them. A tactile image has no shear, so x and y of the force are the true ones; they are 0 on a flat skin without
friction. `taxel_counts` needs a sensor with `readout: {three_axis}`, which measures shear with its noise and cross-talk.

In a scene of kind grasp `thumb/contact` is that of one sensor. `contact` alone is that of all sensors in the order of the robot. Images of
sensors with different taxels are joined to (taxels), or (taxels, 3). Poses of `proprioception` are in the world.

Normalised observations are divided by SCALES, counts by the largest count of the sensor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_count, checked_names
from .._core import OutputOptions, Scene, Sensor
from .._counts import IMAGE_UNITS
from .._features import IMAGE_FEATURES
from ..environment import NO_OUTPUTS, EnvironmentFrame, EnvironmentLayout
from ..errors import InputError
from ..grasps import GraspFrame, GraspLayout
from .values import NumpyValues

Layout = EnvironmentLayout | GraspLayout
AnyFrame = EnvironmentFrame | GraspFrame
Values = NDArray[Any]

SENSOR_OBSERVATIONS = (
    "contact",
    "tactile_image",
    "taxel_counts",
    "binary_contact",
    "binary_image",
    "center_of_pressure",
    "features",
    "start_contact",
)
"""Names of observations of a sensor."""

OBSERVATIONS = (*SENSOR_OBSERVATIONS, "proprioception", "joint_positions", "joint_velocities", "target_force")
"""Names of observations."""

SCALES = {"m": 0.01, "N": 1.0, "m^2": 1e-4, "rad": 1.0, "rad/s": 1.0, "1": 1.0}
"""Divisors of normalised observations, by unit."""

FEATURES = IMAGE_FEATURES
"""Fields of the observation `features`: name, number of values, unit."""


@dataclass(frozen=True)
class Bounds:
    """Range of one observation of one environment."""

    low: Values
    high: Values


@dataclass(frozen=True)
class _Block:
    bounds: Bounds
    scale: NDArray[np.float32]
    read: Callable[[Any], Values]  # takes a frame, returns (N, *shape) in SI units
    live: bool = False  # read() returns memory that the next step changes, perhaps that of a GPU
    table: NDArray[np.float32] | None = None  # read() returns indices into it
    of_first_frame: bool = False  # holds the value of the first frame of the episode


def _unbounded(shape: tuple[int, ...]) -> Bounds:
    return Bounds(np.full(shape, -np.inf, np.float32), np.full(shape, np.inf, np.float32))


def _sensors(layout: EnvironmentLayout) -> tuple[int, ...]:
    return (layout.num_sensors,) if layout.num_sensors > 1 else ()


def _contact(layout: EnvironmentLayout) -> _Block:
    def read(frame: EnvironmentFrame) -> Values:
        center = frame.center_of_pressure
        contact = np.empty((*center.shape[:-1], 6), np.float32)
        contact[..., :3] = center
        contact[..., 3:5] = frame.ground_truth.contact_wrench[..., :2]
        contact[..., 5] = -frame.total_force
        return contact

    scale = np.repeat(np.array([SCALES["m"], SCALES["N"]], np.float32), 3)
    return _Block(_unbounded((*_sensors(layout), 6)), scale, read)


def _start_contact(layout: EnvironmentLayout) -> _Block:
    return replace(_contact(layout), of_first_frame=True)


def _counts(layout: EnvironmentLayout) -> _Block:
    shape = (*_sensors(layout), *layout.image_shape)
    bounds = Bounds(np.zeros(shape, np.int32), np.full(shape, layout.saturation, np.int32))
    return _Block(bounds, np.array(layout.saturation, np.float32), lambda frame: frame.tactile_image, live=True)


def _largest_count(sensor: Sensor) -> int:
    axes = sensor.readout.three_axis
    if axes is None:
        raise InputError(f"observations: 'taxel_counts' needs a sensor with readout.three_axis, which {sensor.name} has not")
    return axes.saturation


def _taxel_counts(layout: EnvironmentLayout) -> _Block:
    shape, largest = (*_sensors(layout), *layout.image_shape, 3), _largest_count(layout.sensor)
    bounds = Bounds(np.full(shape, -largest, np.int32), np.full(shape, largest, np.int32))
    return _Block(bounds, np.array(largest, np.float32), lambda frame: frame.taxel_counts, live=True)


def _newtons(layout: EnvironmentLayout) -> _Block:
    shape, table = (*_sensors(layout), *layout.image_shape), layout.newtons_of_counts()
    bounds = Bounds(np.zeros(shape, np.float32), np.full(shape, table[-1], np.float32))
    return _Block(bounds, np.array(SCALES["N"], np.float32), lambda frame: frame.tactile_image, live=True, table=table)


def touched(frame: Any) -> NDArray[np.float32]:
    """`binary_contact` of a frame, (N, sensors): whether any taxel is above its trigger."""
    return (np.asarray(frame.contact_area) > 0).astype(np.float32).reshape(len(frame.contact_area), -1)


def _binary_contact(layout: EnvironmentLayout) -> _Block:
    shape = (layout.num_sensors,)
    return _Block(Bounds(np.zeros(shape, np.float32), np.ones(shape, np.float32)), np.array(1, np.float32), touched)


def _binary_image(layout: EnvironmentLayout) -> _Block:
    shape, table = (*_sensors(layout), *layout.image_shape), np.ones(layout.saturation + 1, np.float32)
    table[0] = 0
    bounds = Bounds(np.zeros(shape, np.float32), np.ones(shape, np.float32))
    return _Block(bounds, np.array(1, np.float32), lambda frame: frame.tactile_image, live=True, table=table)


def _center_of_pressure(layout: EnvironmentLayout) -> _Block:
    def read(frame: EnvironmentFrame) -> Values:
        return np.array(frame.center_of_pressure, np.float32)

    return _Block(_unbounded((*_sensors(layout), 3)), np.array(SCALES["m"], np.float32), read)


def _features(layout: EnvironmentLayout) -> _Block:
    def read(frame: EnvironmentFrame) -> Values:
        parts = [(frame[name], size) for name, size, _ in FEATURES]
        return np.concatenate([values if size > 1 else values[..., np.newaxis] for values, size in parts], axis=-1)

    scale = np.array([SCALES[unit] for _, size, unit in FEATURES for _ in range(size)], np.float32)
    return _Block(_unbounded((*_sensors(layout), len(scale))), scale, read)


def _proprioception(layout: Layout) -> _Block:
    num_values = 7 * layout.num_sensors

    def read(frame: AnyFrame) -> Values:
        poses = frame.X_WS.reshape(len(frame.X_WS), num_values)
        return np.concatenate([poses, frame.joint_positions], axis=-1, dtype=np.float32)

    units = ["m"] * 3 + ["1"] * 4
    scale = np.array([SCALES[unit] for unit in units * layout.num_sensors + ["rad"] * layout.num_joints], np.float32)
    return _Block(_unbounded((num_values + layout.num_joints,)), scale, read)


def _joints(array: str, unit: str) -> Callable[[Layout], _Block]:
    def block(layout: Layout) -> _Block:
        if not layout.num_joints:
            raise InputError(f"observations: {array!r} needs a robot with joints, which this scene has not")
        scale = np.array(SCALES[unit], np.float32)
        return _Block(_unbounded((layout.num_joints,)), scale, lambda frame: frame[array].astype(np.float32))

    return block


def _target_force(layout: Layout) -> _Block:
    if not isinstance(layout, GraspLayout):
        raise InputError("observations: 'target_force' needs a scene of kind grasp")
    bounds = Bounds(np.zeros(layout.num_fingers, np.float32), np.full(layout.num_fingers, np.inf, np.float32))
    return _Block(bounds, np.array(SCALES["N"], np.float32), lambda frame: frame.target_forces.astype(np.float32))


_ROBOT_BLOCKS: dict[str, Callable[[Layout], _Block]] = {
    "proprioception": _proprioception,
    "joint_positions": _joints("joint_positions", "rad"),
    "joint_velocities": _joints("joint_velocities", "rad/s"),
    "target_force": _target_force,
}
_SENSOR_BLOCKS: dict[str, Callable[[EnvironmentLayout], _Block]] = {
    "contact": _contact,
    "tactile_image": _counts,
    "taxel_counts": _taxel_counts,
    "features": _features,
    "binary_contact": _binary_contact,
    "binary_image": _binary_image,
    "center_of_pressure": _center_of_pressure,
    "start_contact": _start_contact,
}


def _block(name: str, layout: Layout, image_unit: str) -> _Block:
    sensor, _, quantity = name.rpartition("/")
    if quantity in _ROBOT_BLOCKS:
        return _ROBOT_BLOCKS[quantity](layout)
    make = _newtons if quantity == "tactile_image" and image_unit == "newtons" else _SENSOR_BLOCKS[quantity]
    if isinstance(layout, EnvironmentLayout):
        return make(layout)
    blocks = [_of_sensor(each, make(layout.alone(each))) for each in ([sensor] if sensor else layout.sensors)]
    return blocks[0] if sensor else _joined(blocks, [each.num_taxels for each in layout.sensors.values()], quantity)


def _of_sensor(sensor: str, block: _Block) -> _Block:
    table = block.table
    if table is None:
        return replace(block, read=lambda frame: block.read(frame.sensors[sensor]))
    return replace(block, read=lambda frame: table[block.read(frame.sensors[sensor])], live=False, table=None)


def _joined(blocks: Sequence[_Block], num_taxels: Sequence[int], quantity: str) -> _Block:
    """Blocks of all sensors on one axis in front; images of different shapes as one list of taxels."""
    shapes = [block.bounds.low.shape for block in blocks]

    def join(parts: Sequence[Values]) -> Values:  # (K, *shape) each
        if quantity == "binary_contact":
            return np.concatenate(parts, axis=1)
        if len(set(shapes)) == 1:
            return np.stack(parts, axis=1)
        vector = shapes[0][-1:] if quantity == "taxel_counts" else ()
        return np.concatenate([part.reshape(len(part), n, *vector) for part, n in zip(parts, num_taxels, strict=True)], axis=1)

    low, high, scale = (
        join([np.broadcast_to(values, shape)[np.newaxis] for values, shape in zip(each, shapes, strict=True)])[0]
        for each in zip(*((block.bounds.low, block.bounds.high, block.scale) for block in blocks), strict=True)
    )
    return replace(blocks[0], bounds=Bounds(low, high), scale=scale, read=lambda frame: join([b.read(frame) for b in blocks]), live=False)


def checked_observations(names: str | Sequence[str], sensors: Sequence[str]) -> tuple[str, ...]:
    """`names` as a tuple if they are observations of a scene, whose `sensors` have these names, else InputError."""
    return checked_names("observations", names, (*OBSERVATIONS, *(f"{s}/{name}" for s in sensors for name in SENSOR_OBSERVATIONS)))


def outputs_of(names: str | Sequence[str], scene: Scene) -> OutputOptions:
    """Optional outputs that frames of the scene need for these observations.

    Raises InputError for an unknown name, and for `taxel_counts` of a sensor without readout.three_axis.
    """
    sensors = dict(scene.sensors)
    needed = [name for name in checked_observations(names, tuple(sensors)) if name.endswith("taxel_counts")]
    for name in needed:
        of_one = name.rpartition("/")[0]
        for sensor in [sensors[of_one]] if of_one else sensors.values() or [scene.sensor]:
            _largest_count(sensor)
    return NO_OUTPUTS.replace(taxel_counts=bool(needed))


class ObservationBuilder:
    """Builds batched observations from the frames of a batch.

    names: a name gives an array, a sequence of names a dict of arrays.
    image_unit: "counts" or "newtons".
    normalized: whether values are divided by SCALES.
    history: number of latest frames, oldest first, on an axis before the shape of one frame. It starts with copies of the first frame.
    copy: False returns live arrays that the next step overwrites. A rollout buffer must not keep them.
    images: the operations on counts, of NumPy or of tensors where the images of frames lie.

    Raises what outputs_of() raises, which names the outputs that frames need.
    """

    def __init__(
        self,
        layout: Layout,
        names: str | Sequence[str] = "contact",
        *,
        image_unit: str = "counts",
        normalized: bool = False,
        history: int = 1,
        copy: bool = True,
        images: NumpyValues | None = None,
    ) -> None:
        self.names = checked_observations(names, () if isinstance(layout, EnvironmentLayout) else tuple(layout.sensors))
        checked_names("image_unit", image_unit, IMAGE_UNITS)
        self._blocks = {name: _block(name, layout, image_unit) for name in self.names}
        self._is_dict = not isinstance(names, str)
        self._normalized = normalized
        self._history = checked_count("history", history)
        self._copy = copy
        host = NumpyValues()
        self._operations = {name: images or host if block.live else host for name, block in self._blocks.items()}
        self._values: dict[str, Values] = {}
        self._first_values: dict[str, Values] = {}  # of the blocks `of_first_frame`

    def bounds(self) -> Bounds | dict[str, Bounds]:
        """Ranges of one environment, structured as the observation."""
        bounds = {name: self._bounds(block) for name, block in self._blocks.items()}
        return bounds if self._is_dict else bounds[self.names[0]]

    def _bounds(self, block: _Block) -> Bounds:
        limits = []
        for limit in (block.bounds.low, block.bounds.high):
            scaled = (limit / block.scale).astype(np.float32) if self._normalized else limit
            shape = scaled.shape if self._history == 1 else (self._history, *scaled.shape)
            limits.append(np.broadcast_to(scaled, shape).copy())
        return Bounds(*limits)

    def update(
        self,
        frame: AnyFrame,
        started: NDArray[np.bool_] | None = None,
        rows: Any = slice(None),
        kept: NDArray[np.bool_] | None = None,
    ) -> None:
        """Takes the latest frame of the instances `rows`.

        started: (N), instances in the first frame of their episode. kept: (N), instances not in `rows` that keep their observation although
        the frame has no values for them.
        """
        for name, block in self._blocks.items():
            operations = self._operations[name]
            values = operations.live(block.read(frame))
            if block.table is not None:
                values = operations.entries(block.table, values)
            if self._normalized:
                values = operations.scaled(values, block.scale)
            if block.of_first_frame:
                values = self._first(name, values, started)
            if self._history == 1:
                self._values[name] = values if kept is None else operations.where(kept, self._values[name], values)
                continue
            if name not in self._values:
                self._values[name] = operations.zeros((len(values), self._history, *values.shape[1:]), values)
            frames, taken = self._values[name], operations.rows(rows)
            frames[taken, :-1] = operations.copy(frames[taken, 1:])
            frames[taken, -1] = values[taken]
            if started is not None:
                first = operations.rows(started)
                frames[first] = values[first][:, np.newaxis]

    def _first(self, name: str, values: Values, started: NDArray[np.bool_] | None) -> Values:
        first = self._first_values.setdefault(name, values.copy())
        if started is not None:
            first[started] = values[started]
        copied: Values = first.copy()
        return copied

    def detach(self) -> None:
        """Copies live values, so that a step does not change them."""
        self._values = {name: self._operations[name].copy(values) for name, values in self._values.items()}

    def observation(self, rows: NDArray[np.integer[Any]] | None = None) -> Any:
        """Latest observation of the instances `rows`, a copy; or of all."""
        result = {name: self._result(name, rows) for name in self.names}
        return result if self._is_dict else result[self.names[0]]

    def _result(self, name: str, rows: NDArray[np.integer[Any]] | None) -> Values:
        values = self._values[name]
        if rows is not None:
            chosen: Values = values[self._operations[name].rows(rows)]
            return chosen
        block = self._blocks[name]
        is_live = self._history > 1 or (block.live and block.table is None and not self._normalized)
        copied: Values = self._operations[name].copy(values) if self._copy and is_live else values
        return copied
