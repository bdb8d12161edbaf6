"""Observations by name: what a policy sees of a batch of episodes.

| name | shape of one environment | content, SI units |
|---|---|---|
| `contact` | (6) | centre of pressure (x, y, z), m, then force on the sensor (x, y, z), N, both in S |
| `tactile_image` | (rows, cols) of one patch, else (taxels) | counts, int32; or newtons by the nominal curve, float32 |
| `taxel_counts` | (rows, cols, 3) of one patch, else (taxels, 3) | counts of three-axis taxels along x, y and the normal, int32 |
| `features` | (13) | moments of the tactile image, in the order of FEATURES |
| `proprioception` | (7 + joints) | pose of S relative to its start: position, m, quaternion (w, x, y, z); joint positions, rad or m |
| `start_contact` | (6) | `contact` in the first frame of the episode |

All but counts are float32. With several sensors per environment all but `proprioception` have an axis (sensors) in front; `proprioception`
has 7 numbers per sensor. Centre, z of the force and features come from the tactile image, so gain and noise of the sensor affect them. A
tactile image has no shear, so x and y of the force are the true ones; they are 0 on a flat skin without friction. `taxel_counts` needs a
sensor with `readout: {three_axis}`, which measures shear with its noise and cross-talk.

Normalised observations are divided by SCALES, counts by the largest count of the sensor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_count, checked_names
from .._core import OutputOptions, Sensor
from .._counts import IMAGE_UNITS
from .._features import IMAGE_FEATURES
from ..environment import NO_OUTPUTS, EnvironmentFrame, EnvironmentLayout
from ..errors import InputError
from .values import NumpyValues

Values = NDArray[Any]

OBSERVATIONS = ("contact", "tactile_image", "taxel_counts", "features", "proprioception", "start_contact")
"""Names of observations."""

SCALES = {"m": 0.01, "N": 1.0, "m^2": 1e-4, "rad": 1.0, "1": 1.0}
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
    read: Callable[[EnvironmentFrame], Values]  # (N, *shape), SI units
    live: bool = False  # read() returns memory that the next step changes, perhaps that of a GPU
    table: NDArray[np.float32] | None = None  # of what read() returns as indices; the values are its entries
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


def _features(layout: EnvironmentLayout) -> _Block:
    def read(frame: EnvironmentFrame) -> Values:
        parts = [(frame[name], size) for name, size, _ in FEATURES]
        return np.concatenate([values if size > 1 else values[..., np.newaxis] for values, size in parts], axis=-1)

    scale = np.array([SCALES[unit] for _, size, unit in FEATURES for _ in range(size)], np.float32)
    return _Block(_unbounded((*_sensors(layout), len(scale))), scale, read)


def _proprioception(layout: EnvironmentLayout) -> _Block:
    num_values = 7 * layout.num_sensors

    def read(frame: EnvironmentFrame) -> Values:
        poses = frame.X_WS.reshape(len(frame.X_WS), num_values)
        return np.concatenate([poses, frame.joint_positions], axis=-1, dtype=np.float32)

    units = ["m"] * 3 + ["1"] * 4
    scale = np.array([SCALES[unit] for unit in units * layout.num_sensors + ["rad"] * layout.num_joints], np.float32)
    return _Block(_unbounded((num_values + layout.num_joints,)), scale, read)


def outputs_of(names: str | Sequence[str], sensor: Sensor) -> OutputOptions:
    """Optional outputs that frames of the sensor need for these observations.

    Raises InputError for an unknown name, and for `taxel_counts` of a sensor without readout.three_axis.
    """
    needs_counts = "taxel_counts" in checked_names("observations", names, OBSERVATIONS)
    return NO_OUTPUTS.replace(taxel_counts=needs_counts and _largest_count(sensor) > 0)


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
        layout: EnvironmentLayout,
        names: str | Sequence[str] = "contact",
        *,
        image_unit: str = "counts",
        normalized: bool = False,
        history: int = 1,
        copy: bool = True,
        images: NumpyValues | None = None,
    ) -> None:
        self.names = checked_names("observations", names, OBSERVATIONS)
        checked_names("image_unit", image_unit, IMAGE_UNITS)
        makers = {
            "contact": _contact,
            "tactile_image": _counts if image_unit == "counts" else _newtons,
            "taxel_counts": _taxel_counts,
            "features": _features,
            "proprioception": _proprioception,
            "start_contact": _start_contact,
        }
        self._blocks = {name: makers[name](layout) for name in self.names}
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
        frame: EnvironmentFrame,
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
