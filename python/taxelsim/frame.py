"""Frames: what a batch of sensors reports at one step.

All arrays are read-only and have the instances as first axis; N = num_instances. Frames of reference: S sensor, P patch. An array that
read() returned shows the memory of the simulator, without a copy: it stays valid for as long as it exists, even without its simulator, and
shows newer numbers after a step. copy() returns numbers that stay.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import numpy.typing as npt

from ._core import OUTPUTS

if TYPE_CHECKING:
    from typing_extensions import Self

FloatArray = npt.NDArray[np.float32]
IntArray = npt.NDArray[np.int32]
BoolArray = npt.NDArray[np.bool_]


class Arrays:
    """Named arrays as attributes. Arrays that were not requested are missing."""

    __slots__ = ("__dict__", "__weakref__", "_absent")

    _absent: Mapping[str, str]
    _nested: ClassVar[Mapping[str, type[Arrays]]] = {}
    _requests: ClassVar[Mapping[str, str]] = {}  # field of OutputOptions by attribute

    def __init__(self, arrays: Mapping[str, Any], absent: Mapping[str, str] | None = None) -> None:
        """absent: why there are no arrays of these names."""
        object.__setattr__(self, "_absent", absent or {})
        for name, value in arrays.items():
            object.__setattr__(self, name, self._nested[name](value) if isinstance(value, Mapping) else value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} is read-only")

    def __getattr__(self, name: str) -> Any:
        if name in self._absent:
            raise AttributeError(f"{type(self).__name__} has no {name}: {self._absent[name]}")
        if name in self._requests:
            raise AttributeError(f"{name} was not requested: Simulator(..., outputs=OutputOptions({self._requests[name]}=True))")
        raise AttributeError(f"{type(self).__name__} has no attribute {name}; it has {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        """Names of the arrays and of the nested groups."""
        return iter(vars(self))

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)

    def __contains__(self, name: str) -> bool:
        return name in vars(self)

    def as_dict(self) -> dict[str, Any]:
        """The arrays by name; groups are dicts."""
        return {name: value.as_dict() if isinstance(value, Arrays) else value for name, value in vars(self).items()}

    def copy(self) -> Self:
        """The same arrays, copied: they do not change when the simulator steps."""
        return type(self)(_copied(self.as_dict()), self._absent)

    def __reduce__(self) -> tuple[type[Self], tuple[dict[str, Any], Mapping[str, str]]]:
        return type(self), (self.as_dict(), self._absent)

    def __repr__(self) -> str:
        parts = (f"{name}{value.shape}" if isinstance(value, np.ndarray) else name for name, value in vars(self).items())
        return f"<taxelsim.{type(self).__name__}: {', '.join(parts)}>"


def _copied(arrays: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _copied(value) if isinstance(value, Mapping) else value.copy() for name, value in arrays.items()}


def _requested_in(group: str) -> dict[str, str]:
    """Field of OutputOptions by the attribute of a group of arrays that it requests."""
    return {where.rpartition(".")[2]: name for name, where in OUTPUTS.items() if where.rpartition(".")[0] == group}


class Features(Arrays):
    """Moments of an image of forces."""

    total_force: FloatArray
    """(N), N."""
    peak_force: FloatArray
    """(N), N: largest taxel."""
    center_of_pressure: FloatArray
    """(N, 3), m, in S; 0 without contact."""
    second_moments: FloatArray
    """(N, 3), m^2: xx, xy, yy about the centre of pressure, in P."""
    eigenvalues: FloatArray
    """(N, 2), m^2, larger first."""
    edge_angle: FloatArray
    """(N), rad in (-pi/2, pi/2]: principal axis; 0 where undefined."""
    edge_confidence: FloatArray
    """(N), 0 to 1."""
    contact_area: FloatArray
    """(N), m^2: area of the taxels above the trigger."""


class ContactFeatures(Features):
    """Features of contacts on parts of a sensor: (N, num_rows, ...).

    Rows: the sensor, each patch, then the regions with the largest force.
    """

    windowed_edge_angle: FloatArray
    """(N, num_rows), rad: angle of an edge that the array cuts off."""
    windowed_edge_confidence: FloatArray
    """(N, num_rows), 0 to 1."""
    ridge_edge_angle: FloatArray
    """(N, num_rows), rad: angle of an edge from taxels whose gains differ."""
    ridge_edge_confidence: FloatArray
    """(N, num_rows), 0 to 1."""
    tilt: FloatArray
    """(N, num_rows, 2), rad: rotation of a flat face against the patch, about its x and y."""
    tilt_confidence: FloatArray
    """(N, num_rows), 0 to 1."""
    contact_type: IntArray
    """(N, num_rows), values of ContactType."""
    patch: IntArray
    """(N, num_rows): patch, or taxel of a list, whose plane the moments are in; -1: xy plane of S."""
    num_regions: IntArray
    """(N): all regions, of which the largest have rows."""


class TactileJacobian(Arrays):
    """Derivatives of features by a small twist of the sensor: v of the origin of S (per m), then w (per rad). (N, num_rows, ..., 6)."""

    center_of_pressure: FloatArray
    """(N, num_rows, 3, 6), m/m and m/rad, in S."""
    total_force: FloatArray
    """(N, num_rows, 6), N/m and N/rad."""
    edge_angle: FloatArray
    """(N, num_rows, 6), rad/m and rad/rad."""


class CleanTactileJacobian(TactileJacobian):
    """The same from clean forces, and the Jacobian of the contact wrench."""

    contact_wrench: FloatArray
    """(N, 6, 6), N/m, N/rad, then N m/m, N m/rad; of the normal forces."""


class GroundTruth(Features):
    """Values that no sensor could measure: before time behaviour, readout and noise."""

    _nested: ClassVar = {"contact": ContactFeatures, "jacobian": CleanTactileJacobian}
    _requests: ClassVar = _requested_in("frame.ground_truth")

    tactile_normal_force: FloatArray
    """(N, num_rows, num_cols), N, after the point spread; (N, num_taxels) for sensors of several patches."""
    tactile_shear_force: FloatArray
    """(N, num_rows, num_cols, 2), N, along x and y of the taxel; (N, num_taxels, 2) for sensors of several patches."""
    penetration_depth: FloatArray
    """(N, num_rows, num_cols), m, mean over the taxel; (N, num_taxels) for sensors of several patches."""
    taxel_jacobian: FloatArray
    """(N, 6, num_rows, num_cols), N/m and N/rad: derivatives of tactile_normal_force by a small twist of the sensor (v of the origin of S,
    then w) while the objects stay; (N, 6, num_taxels) for sensors of several patches. See vjp()."""
    contact_wrench: FloatArray
    """(N, 6): force (N) and torque (N m) on the sensor at its origin, in S, before the point spread."""
    over_penetration: FloatArray
    """(N), fraction of samples at least as deep as the skin is thick."""
    load_offset: FloatArray
    """(N), m: displacement of the objects along z by the load search."""
    load_reached: BoolArray
    """(N), True when pose-driven or when the load is carried."""
    off_array_load: FloatArray
    """(N), N: force beyond the taxels."""
    off_array_contacts: IntArray
    """(N): contact points that lie on no taxel."""
    contact_residual: FloatArray
    """(N), relative error of the contact solver. Only for ElasticLayer."""
    contact_iterations: IntArray
    """(N), iterations of the contact solver. Only for ElasticLayer."""
    contact: ContactFeatures
    """Features of contacts from tactile_normal_force, if requested."""
    jacobian: CleanTactileJacobian
    """Derivatives of the features above, if requested."""


class Frame(Features):
    """One frame of the whole batch. Features come from `tactile_image`, converted to newtons by the nominal curve."""

    _nested: ClassVar = {"contact": ContactFeatures, "jacobian": TactileJacobian, "ground_truth": GroundTruth}
    _requests: ClassVar = _requested_in("frame")

    tactile_image: IntArray | FloatArray
    """(N, num_rows, num_cols), counts, int32; (N, num_taxels) for sensors of several patches. With image_unit="newtons" N by the nominal
    curve, float32: an array of its own, which read() fills."""
    taxel_counts: IntArray
    """(N, num_rows, num_cols, 3), counts of three-axis taxels along x, y and the normal, if requested; (N, num_taxels, 3) for sensors of
    several patches."""
    saturated: FloatArray
    """(N), fraction of taxels at the upper end of their range."""
    contact: ContactFeatures
    """Features of contacts, if requested."""
    jacobian: TactileJacobian
    """Derivatives of features, if requested."""
    ground_truth: GroundTruth
    """Values that no sensor could measure."""
