"""Skins of sensors in the 3-D scene: taxels coloured by what they feel, and arrows of shear."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from .._arrays import rotation_matrices
from .._core import Pose, Sensor
from ..pictures import ARROW_TAXELS, colours_of, taxel_axes
from ..viewer.shapes import TAXEL_SHARE, taxel_pitches

UNITS = 100.0
"""Units of the 3-D scene per metre: controls and camera of viser suit a scene of that size."""
ARROW_COLOUR = (230, 60, 60)
_SQUARE = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]], np.float32)
_LEAST_SHEAR = 0.02  # of the largest normal force; no arrow below


def _linear(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Colours as linear light (IEC 61966-2-1), by which the browser multiplies the colours of instances."""
    levels = colours / 255
    linear = np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)
    return np.asarray(np.rint(255 * linear), np.uint8)


class Skins:
    """All taxels of all sensors as one batch of squares, in the order of the sensors. T: number of taxels of all sensors."""

    def __init__(self, scene: viser.SceneApi, sensors: Sequence[Sensor], poses: Sequence[Pose]) -> None:
        """poses: X_WS of each sensor."""
        self._sensors = sensors
        pitches = np.concatenate([taxel_pitches(sensor) for sensor in sensors])
        self._arrow_length = ARROW_TAXELS * float(np.median(pitches))
        self._taxels = scene.add_batched_meshes_simple(
            "/taxels",
            _SQUARE,
            np.array([[0, 1, 2], [0, 2, 3]]),
            np.zeros((len(pitches), 4), np.float32),
            np.zeros((len(pitches), 3), np.float32),
            batched_scales=np.column_stack([UNITS * TAXEL_SHARE * pitches, np.ones(len(pitches))]).astype(np.float32),
            batched_colors=_linear(colours_of(np.zeros(len(pitches)))),
            lod="off",
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
        self._arrows = scene.add_arrows("/shear", np.zeros((1, 2, 3), np.float32), ARROW_COLOUR, visible=False)
        self.place(poses)

    def place(self, poses: Sequence[Pose]) -> None:
        """Moves the sensors to X_WS."""
        positions, axes, rotations = [], [], []
        for sensor, X_WS in zip(self._sensors, poses, strict=True):
            R_WS = rotation_matrices(np.array([X_WS.rotation]))[0]
            positions.append(sensor.taxel_positions @ R_WS.T + X_WS.position)
            axes.append(taxel_axes(sensor) @ R_WS.T)
            rotations += [np.repeat([(X_WS * p.X_SP).rotation], p.num_rows * p.num_cols, 0) for p in sensor.patches]
        self._positions, self._axes = np.concatenate(positions), np.concatenate(axes)
        self._taxels.batched_positions = (UNITS * self._positions).astype(np.float32)
        self._taxels.batched_wxyzs = np.concatenate(rotations).astype(np.float32)

    def show(self, levels: NDArray[np.float64], newtons: NDArray[np.float64], shear: NDArray[np.float64]) -> None:
        """Draws a frame. levels: (T), 1 for the brightest colour. newtons: (T), normal forces. shear: (T, 2), N."""
        self._taxels.batched_colors = _linear(colours_of(levels))
        largest = float(newtons.max(initial=0.0))
        seen = np.linalg.norm(shear, axis=1) > _LEAST_SHEAR * largest
        self._arrows.visible = bool(seen.any())
        if seen.any():
            vectors = np.einsum("ta,tas->ts", shear[seen] / largest, self._axes[seen]) * self._arrow_length
            starts = self._positions[seen]
            self._arrows.points = (UNITS * np.stack([starts, starts + vectors], 1)).astype(np.float32)
