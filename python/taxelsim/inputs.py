"""Inputs of a simulator as writable arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._named_arrays import Arrays
from ._tensors import converted, converter
from .errors import InputError

if TYPE_CHECKING:
    from .simulator import Simulator

NO_OBJECT = -1
"""Id of an empty slot."""


class Inputs(Arrays):
    """Writable arrays that step() takes as they are then: write to them, or to their tensors(), and step.

    tensors() share the memory; PyTorch and Warp write to theirs. Rows are read while step() runs. A simulator for contact points has
    `positions`, `normal_forces` and `num_contacts`, all others `ids`, `poses` and `loads`.

    In the memory of a GPU the device reads the arrays, and the host never sees them: write to them after read(). Loads need
    Simulator.prepare(loads=True) before. The call that waits for a step whose inputs are not allowed raises InputError with the instance.
    """

    ids: npt.NDArray[np.int32]
    """(N,), or (N, S) with slots: indices into model.objects; NO_OBJECT, the initial value, for an empty slot."""
    poses: npt.NDArray[np.float64]
    """(N, 7), or (N, S, 7): position (m) and quaternion (w, x, y, z) of the origin of each object in S."""
    loads: npt.NDArray[np.float32]
    """(N,), N, >= 0; NaN, the initial value, for instances that are driven by pose."""
    positions: npt.NDArray[np.float64]
    """(N, C, 3), m, in S, C = max_contacts."""
    normal_forces: npt.NDArray[np.float64]
    """(N, C), N, >= 0, along z of the patch."""
    num_contacts: npt.NDArray[np.int32]
    """(N,), 0 to C: points of each instance; those behind are not read."""

    def tensors(self, library: str = "torch") -> Inputs:
        """The same arrays as writable tensors of "torch", "warp" or "numpy". Raises InputError for JAX, whose arrays are constant."""
        if library == "jax":
            raise InputError("library: 'jax' is not allowed for inputs: arrays of JAX are constant; give them to set_objects()")
        return Inputs(converted(self.as_dict(), converter(library)))


def new_inputs(num_instances: int, num_slots: int, max_contacts: int) -> Inputs:
    """Inputs of no object, or of no contact point."""
    if max_contacts > 0:
        points = (num_instances, max_contacts)
        return Inputs(
            {"positions": np.zeros((*points, 3)), "normal_forces": np.zeros(points), "num_contacts": np.zeros(num_instances, np.int32)}
        )
    rows = (num_instances,) if num_slots == 1 else (num_instances, num_slots)
    poses = np.zeros((*rows, 7))
    poses[..., 3] = 1
    return Inputs({"ids": np.full(rows, NO_OBJECT, np.int32), "poses": poses, "loads": np.full(num_instances, np.nan, np.float32)})


def commit(inputs: Inputs, simulator: Simulator) -> None:
    """Gives the inputs to the simulator. Raises what its setters raise."""
    if "poses" in inputs:
        simulator.set_objects(inputs.ids, inputs.poses)
        is_driven = ~np.isnan(inputs.loads)
        simulator.set_loads(np.where(is_driven, inputs.loads, 0), where=is_driven)
        return
    counts = inputs.num_contacts
    most = inputs.positions.shape[1]
    wrong = (counts < 0) | (counts > most)
    if wrong.any():
        first = int(np.argmax(wrong))
        raise InputError(f"num_contacts of instance {first}: {counts[first]} is not allowed: 0 to {most}")
    used: Any = np.arange(most) < counts[:, np.newaxis]
    simulator.set_contacts(inputs.positions[used], inputs.normal_forces[used], np.concatenate([[0], np.cumsum(counts)]).astype(np.int32))
