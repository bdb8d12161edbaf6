"""Gaps in the coverage of a data set: what its scene allows and its frames lack."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .sample import Sample
from .summary import ANGLE_BIN, VARIABLE_BINS, Summary

FEW = 0.1  # of the episodes that an object has by its weight, fewer are a gap


def _ranges(is_empty: NDArray[np.bool_], edges: NDArray[np.float64], unit: str) -> str:
    """Adjacent empty bins as ranges of values."""
    bounds = np.flatnonzero(np.diff(np.concatenate([[False], is_empty, [False]]).astype(int)))
    return ", ".join(f"{edges[first]:.4g} to {edges[end]:.4g}" for first, end in bounds.reshape(-1, 2)) + f" {unit}"


def gaps_of(sample: Sample, summary: Summary) -> list[str]:
    """A sentence for each gap."""
    result = [f"Object {name} has no episode." for name, count in summary.objects.items() if count == 0]
    if len(summary.objects) > 1:
        share = FEW * summary.num_sampled_episodes / len(summary.objects)
        rare = [(name, count) for name, count in summary.objects.items() if 0 < count < share]
        result += [f"Object {name} has {count} of {summary.num_sampled_episodes} episodes." for name, count in rare]
    untouched = int((summary.taxel_contacts == 0).sum())
    if untouched:
        result.append(f"{untouched} of {len(summary.taxel_contacts)} taxels are 0 in every frame.")
    return result + _variable_gaps(sample, summary) + _angle_gaps(sample)


def _variable_gaps(sample: Sample, summary: Summary) -> list[str]:
    """Empty tenths of the ranges of the scene's random variables."""
    result = []
    for name, (low, high) in summary.scene.randomization.items():
        column = f"meta/{name}"
        if column not in sample.data or not low < high:
            continue
        counts, edges = np.histogram(sample.column(column), VARIABLE_BINS, (low, high))
        if (counts == 0).any():
            unit = sample.data[column].unit.replace("1", "").strip()
            result.append(f"No episode has a {name} of {_ranges(counts == 0, edges, unit).strip()}.")
    return result


def _angle_gaps(sample: Sample) -> list[str]:
    """Empty bins of the edge angle, of confident frames."""
    if "data/edge_angle" not in sample.data or "data/edge_confidence" not in sample.data:
        return []
    angles = np.degrees(sample.column("data/edge_angle")[sample.column("data/edge_confidence") > 0].ravel())
    counts, edges = np.histogram(angles, np.arange(-90, 91, ANGLE_BIN))
    return [f"No frame has an edge angle of {_ranges(counts == 0, edges, 'deg')}."] if (counts == 0).any() else []
