"""The 3-D scene of the playground: taxels, shear, and the object with handles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from .._core import Sensor
from ..pictures import ARROW_TAXELS, colours_of, taxel_axes
from ..viewer.shapes import TAXEL_SHARE, taxel_pitches, triangles_of
from .state import View

UNITS = 100.0
"""Units of the 3-D scene per metre: controls and camera of viser suit a scene of that size."""
_OBJECT_COLOUR, _ARROW_COLOUR = (190, 190, 200), (230, 60, 60)
_SQUARE = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]], np.float32)
_LEAST_SHEAR = 0.02  # of the largest normal force; no arrow below


def _linear(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Colours as linear light (IEC 61966-2-1), by which the browser multiplies the colours of instances."""
    levels = colours / 255
    linear = np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)
    return np.asarray(np.rint(255 * linear), np.uint8)


class Scene3D:
    """Draws frames, and calls `drag` with the handles of the object when a browser moves them."""

    def __init__(self, server: viser.ViserServer, sensor: Sensor, drag: Callable[[Any], None]) -> None:
        self._scene = server.scene
        self._positions, self._axes, pitches = sensor.taxel_positions, taxel_axes(sensor), taxel_pitches(sensor)
        self._arrow_length = ARROW_TAXELS * float(np.median(pitches))
        rotations = [np.repeat([patch.X_SP.rotation], patch.num_rows * patch.num_cols, 0) for patch in sensor.patches]
        self._taxels = self._scene.add_batched_meshes_simple(
            "/taxels",
            _SQUARE,
            np.array([[0, 1, 2], [0, 2, 3]]),
            np.concatenate(rotations).astype(np.float32),
            (UNITS * self._positions).astype(np.float32),
            batched_scales=np.column_stack([UNITS * TAXEL_SHARE * pitches, np.ones(len(pitches))]).astype(np.float32),
            batched_colors=_linear(colours_of(np.zeros(len(pitches)))),
            lod="off",
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
        self._arrows = self._scene.add_arrows("/shear", np.zeros((1, 2, 3), np.float32), _ARROW_COLOUR, visible=False)
        self._handles = self._scene.add_transform_controls("/object", scale=2.0)
        self._handles.on_update(lambda event: drag(event.target))
        extent = UNITS * float(np.ptp(self._positions, axis=0).max() + 0.01)
        server.initial_camera.position = (0.6 * extent, 0.0, 0.8 * extent)
        server.initial_camera.look_at = (0.0, 0.0, 0.0)

    def draw_object(self, shape: Any) -> None:
        """Replaces the object."""
        vertices, triangles = triangles_of(shape, 0.1)
        self._scene.add_mesh_simple("/object/shape", UNITS * vertices, triangles, color=_OBJECT_COLOUR, opacity=0.5, side="double")

    def show(self, view: View, levels: NDArray[np.float64], moves: bool) -> None:
        """Draws a frame. levels: (num_taxels), 1 for the brightest colour. moves: whether the handles go to the pose of the frame."""
        self._taxels.batched_colors = _linear(colours_of(levels))
        largest = float(view.newtons.max(initial=0.0))
        seen = np.linalg.norm(view.shear, axis=1) > _LEAST_SHEAR * largest
        self._arrows.visible = bool(seen.any())
        if seen.any():
            vectors = np.einsum("ta,tas->ts", view.shear[seen] / largest, self._axes[seen]) * self._arrow_length
            starts = self._positions[seen]
            self._arrows.points = (UNITS * np.stack([starts, starts + vectors], 1)).astype(np.float32)
        if moves:
            self._handles.position, self._handles.wxyz = UNITS * view.pose[:3], view.pose[3:]
