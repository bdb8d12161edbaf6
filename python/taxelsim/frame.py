"""Frames: what a batch of sensors reports at one step.

All arrays are read-only and have the instances as first axis; N = num_instances. Frames of reference: S sensor, P patch. An array that
read() returned shows the memory of the simulator, without a copy: it stays valid for as long as it exists, even without its simulator, and
shows newer numbers after a step. copy() returns numbers that stay.
"""

from __future__ import annotations

from typing import ClassVar

from ._core import OUTPUTS
from ._features import CleanTactileJacobian, ContactFeatures, Features, ReadoutFeatures, TactileJacobian, TruthFeatures
from ._named_arrays import Arrays, BoolArray, FloatArray, IntArray

__all__ = [
    "Arrays",
    "BoolArray",
    "CleanTactileJacobian",
    "ContactFeatures",
    "Features",
    "FloatArray",
    "Frame",
    "GroundTruth",
    "IntArray",
    "TactileJacobian",
]


def _requested_in(group: str) -> dict[str, str]:
    """Field of OutputOptions by the attribute of a group of arrays that it requests."""
    return {where.rpartition(".")[2]: name for name, where in OUTPUTS.items() if where.rpartition(".")[0] == group}


class GroundTruth(TruthFeatures):
    """Values that no sensor could measure: before time behaviour, readout and noise."""

    _nested: ClassVar = {"contact": ContactFeatures, "jacobian": CleanTactileJacobian}
    _requests: ClassVar = _requested_in("frame.ground_truth")

    contact: ContactFeatures
    """Features of contacts from tactile_normal_force, if requested."""
    jacobian: CleanTactileJacobian
    """Derivatives of the features above, if requested."""


class Frame(ReadoutFeatures):
    """One frame of the whole batch. Features come from `tactile_image`, converted to newtons by the nominal curve."""

    _nested: ClassVar = {"contact": ContactFeatures, "jacobian": TactileJacobian, "ground_truth": GroundTruth}
    _requests: ClassVar = _requested_in("frame")

    tactile_image: IntArray | FloatArray
    """(N, num_rows, num_cols), counts, int32; (N, num_taxels) for sensors of several patches. With image_unit="newtons" N by the nominal
    curve, float32: an array of its own, which read() fills."""
    contact: ContactFeatures
    """Features of contacts, if requested."""
    jacobian: TactileJacobian
    """Derivatives of features, if requested."""
    ground_truth: GroundTruth
    """Values that no sensor could measure."""
