"""Pictures of the places of taxels, to look at before a sensor is used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._core import Sensor
from ..pictures import colours_of, taxel_axes
from .surface import Array

# Of the views from +x, -y and +z: axis to the right, axis upwards, axis towards the viewer and its sign.
_VIEWS = ((1, 2, 0, 1), (0, 2, 1, -1), (0, 1, 2, 1))
_COVERED = 0.86  # of a side of a taxel; the rest is the gap that makes taxels countable
_BACK = 60  # grey of a taxel that looks away
_MARGIN = 8  # pixels


def draw(sensor: Sensor, height: int = 360) -> NDArray[np.uint8]:
    """Three views of the taxels of a sensor at one scale, (height, width, 3): from +x, from -y and from +z of S.

    Colours go from the first taxel (dark) to the last one (bright); taxels that look away are grey. Nearer taxels hide others.
    height: pixels, at least 32.
    """
    pixels = max(32, height) - 2 * _MARGIN
    sides = np.concatenate([np.tile(patch.pitch, (patch.num_rows * patch.num_cols, 1)) for patch in sensor.patches])
    middles, axes = np.asarray(sensor.taxel_positions), taxel_axes(sensor) * (_COVERED * sides)[..., np.newaxis]
    scale = pixels / float(np.ptp(middles, axis=0).max() + sides.max())
    steps = np.linspace(-0.5, 0.5, int(np.ceil(sides.max() * scale)) + 2)  # of the points on a side, less than a pixel apart
    u, v = (grid.ravel() for grid in np.meshgrid(steps, steps))
    points = middles[:, np.newaxis] + np.einsum("p,ta->tpa", u, axes[:, 0]) + np.einsum("p,ta->tpa", v, axes[:, 1])
    levels = np.linspace(0.1, 1, len(middles))
    views = [_view(points, np.asarray(sensor.taxel_normals), levels, scale, pixels + 2 * _MARGIN, view) for view in range(3)]
    return np.concatenate(views, axis=1)


def _view(points: Array, normals: Array, levels: Array, scale: float, height: int, view: int) -> NDArray[np.uint8]:
    across, up, axis, sign = _VIEWS[view]
    low, high = points[..., (across, up)].min(axis=(0, 1)), points[..., (across, up)].max(axis=(0, 1))
    width = int(np.ceil((high[0] - low[0]) * scale)) + 2 * _MARGIN
    picture = np.full((height, width, 3), 255, np.uint8)
    columns = (_MARGIN + (points[..., across] - low[0]) * scale).astype(np.intp).ravel()
    middle = (low[1] + high[1]) / 2
    rows = (height / 2 - (points[..., up] - middle) * scale).astype(np.intp).ravel()
    looks_here = sign * normals[:, axis] > 1e-6
    colours = np.where(looks_here[:, np.newaxis], colours_of(levels), _BACK)
    order = np.argsort(sign * points[..., axis].ravel(), kind="stable")  # nearer points are drawn later
    rows, columns = np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)
    picture[rows[order], columns[order]] = np.repeat(colours, points.shape[1], axis=0)[order]
    return picture
