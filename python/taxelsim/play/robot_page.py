"""A page that shows a robot with its sensors and moves its joints."""

from __future__ import annotations

import html
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .._core import Robot
from .joints import add_joint_sliders
from .robot_3d import Robot3D
from .server import LOOPBACK, start_server
from .skins import Skins


class RobotPage:
    """Serves a page on the loopback interface: links, taxels, the direction that each skin faces, and a slider for each joint.

    file: a robot file, or a scene with a robot. positions: (num_joints), rad or m; default: the initial ones.
    port: of 127.0.0.1; 0: a free one.

    Raises InputError for a file without a robot that has joints, or for positions that are not allowed.
    """

    def __init__(self, file: str | Path, positions: Sequence[float] | None = None, *, port: int = 0) -> None:
        self.robot = Robot(file)
        """Kinematics of the robot."""
        start = [joint[-1] for joint in self.robot.joints] if positions is None else list(positions)
        poses = self.robot.sensor_poses(start)
        self._known = [k for k, (_, sensor) in enumerate(self.robot.sensors) if sensor is not None]
        self._server, guard = start_server(port, "taxelsim robot", 0, lambda _: None)
        self.url = f"http://{LOOPBACK}:{self._server.get_port()}/{guard.token}/"
        """Address of the page, with the token."""
        self._drawn = Robot3D(self._server.scene, self.robot, start)
        sensors = [sensor for _, sensor in self.robot.sensors if sensor is not None]
        self._skins = Skins(self._server.scene, sensors, [poses[k] for k in self._known]) if sensors else None
        self._table = self._server.gui.add_html("")
        add_joint_sliders(self._server.gui, self.robot, start, self.move)
        self._drawn.aim(self._server.initial_camera)
        self.move(start)

    def move(self, positions: Sequence[float]) -> None:
        """Shows the robot at joint positions (num_joints), rad or m. Raises InputError for positions that are not allowed."""
        poses = self.robot.sensor_poses(positions)
        with self._server.atomic():
            self._drawn.move(positions)
            if self._skins is not None:
                self._skins.place([poses[k] for k in self._known])
            self._table.content = _table(self.robot, positions)

    def close(self) -> None:
        """Stops the server."""
        self._server.stop()


def _table(robot: Robot, positions: Sequence[float]) -> str:
    """Places and directions of the sensors, as `taxelsim robot` prints them."""
    lines = [f"{'sensor':12} {'place in the world, mm':>26}  {'faces':>20}"]
    for (name, _), X_WS in zip(robot.sensors, robot.sensor_poses(positions), strict=True):
        faces = np.subtract(X_WS.transform((0, 0, 1)), X_WS.position)
        place, direction = (
            ", ".join(f"{value:.{digits}f}" for value in values) for values, digits in ((1e3 * np.array(X_WS.position), 1), (faces, 2))
        )
        lines.append(f"{html.escape(name):12} {place:>26}  {direction:>20}")
    return "<pre style='font-size: 70%; margin: 0 0.7em'>" + "\n".join(lines) + "</pre>"
