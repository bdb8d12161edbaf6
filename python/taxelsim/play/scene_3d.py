"""The 3-D scene of the playground: skins of sensors, their robot, and objects with handles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from .._core import Pose
from ..viewer.shapes import triangles_of
from .robot_3d import Robot3D
from .skins import UNITS, Skins
from .state import Press, Settings, View

_OBJECT_COLOUR = (190, 190, 200)


class Scene3D:
    """Draws frames, and calls `drag` with the number and the handles of an object when a browser moves them."""

    def __init__(self, server: viser.ViserServer, press: Press, settings: Settings, drag: Callable[[int, Any], None]) -> None:
        self._scene = server.scene
        self._press = press
        self._settings = settings
        sensors = list(press.sensors.values())
        if press.robot is None:
            self._robot = None
            extent = UNITS * float(np.ptp(sensors[0].taxel_positions, axis=0).max() + 0.01)
            server.initial_camera.position = (0.6 * extent, 0.0, 0.8 * extent)
            server.initial_camera.look_at = (0.0, 0.0, 0.0)
        else:
            self._robot = Robot3D(server.scene, press.robot, settings.positions)
            self._robot.aim(server.initial_camera)
        self._skins = Skins(server.scene, sensors, self._sensor_poses(settings))
        self._handles = [self._add_handles(k, drag) for k in range(max(len(settings.objects), 1))]
        for k, X_WO in enumerate(settings.objects):
            self.draw_object(press.items[k].object.shape, k)
            self._move(k, np.array([*X_WO.position, *X_WO.rotation]))

    def _sensor_poses(self, settings: Settings) -> Sequence[Pose]:
        return [Pose()] if self._press.robot is None else self._press.robot.sensor_poses(settings.positions)

    def _add_handles(self, number: int, drag: Callable[[int, Any], None]) -> viser.TransformControlsHandle:
        handles = self._scene.add_transform_controls(f"/objects/{number}", scale=2.0)
        handles.on_update(lambda event: drag(number, event.target))
        return handles

    def _move(self, number: int, X_WO: NDArray[np.float64]) -> None:
        self._handles[number].position, self._handles[number].wxyz = UNITS * X_WO[:3], X_WO[3:]

    def draw_object(self, shape: Any, number: int = 0) -> None:
        """Replaces an object."""
        vertices, triangles = triangles_of(shape, 0.1)
        name = f"/objects/{number}/shape"
        self._scene.add_mesh_simple(name, UNITS * vertices, triangles, color=_OBJECT_COLOUR, opacity=0.5, side="double")

    def show(self, views: Sequence[View], levels: NDArray[np.float64], moves: bool) -> None:
        """Draws a frame of each sensor.

        levels: (num_taxels of all sensors), 1 for the brightest colour. moves: whether the handles of an object that one sensor touches go
        to the pose of the frame.
        """
        newest = views[0].settings
        if self._robot is not None and newest.positions != self._settings.positions:
            self._robot.move(newest.positions)
            self._skins.place(self._sensor_poses(newest))
        self._settings = newest
        newtons, shear = (np.concatenate(values) for values in zip(*((view.newtons, view.shear) for view in views), strict=True))
        self._skins.show(levels, newtons, shear)
        if moves and self._robot is None:
            self._move(0, views[0].pose)
