"""A robot in the 3-D scene: its links, capsules between its joints, and the direction that each skin faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from .._core import Cylinder, Robot, Sphere
from ..patterns.links import link_shapes
from ..viewer.shapes import triangles_of
from .skins import ARROW_COLOUR, UNITS

_LINK_COLOUR, _CHAIN_COLOUR = (205, 210, 220), (120, 125, 140)
_ARROW_SHARE = 0.08  # length of an arrow by extent of the robot
_RADIUS_SHARE = 0.008  # radius of a capsule by extent of the robot
_LEAST_EXTENT = 0.02  # m
_VIEW = (0.7, -1.1, 0.6)  # place of the camera from the middle of the robot, by its extent


class Robot3D:
    """Draws the links of a robot that have shapes in its URDF, and capsules between the joints of the chain to each sensor."""

    def __init__(self, scene: viser.SceneApi, robot: Robot, positions: Sequence[float]) -> None:
        """positions: (num_joints), rad or m. Raises InputError and IoError for a URDF that cannot be read."""
        self._robot = robot
        points = np.concatenate([np.array(chain) for chain in robot.chain_points(positions)])
        self._centre = (points.min(0) + points.max(0)) / 2
        self._extent = max(float(np.ptp(points, axis=0).max()), _LEAST_EXTENT)  # m
        self._links = [scene.add_frame(f"/links/{k}", show_axes=False) for k in range(len(robot.links))]
        self._add_shapes(scene)
        num_bones = len(self._segments(positions)[0])
        self._bones, self._ends = (
            scene.add_batched_meshes_simple(
                f"/chains/{name}",
                *triangles_of(shape, 0),
                np.tile(np.array([1, 0, 0, 0], np.float32), (count, 1)),
                np.zeros((count, 3), np.float32),
                batched_scales=np.full((count, 3), UNITS * _RADIUS_SHARE * self._extent, np.float32),
                batched_colors=_CHAIN_COLOUR,
                lod="off",
            )
            for name, shape, count in (("bones", Cylinder(1, 1), num_bones), ("ends", Sphere(1), 2 * num_bones))
        )
        self._arrows = scene.add_arrows("/faces", np.zeros((1, 2, 3), np.float32), ARROW_COLOUR)
        self._labels = [scene.add_label(f"/names/{k}", name) for k, (name, _) in enumerate(robot.sensors)]
        self.move(positions)

    def _add_shapes(self, scene: viser.SceneApi) -> None:
        shapes = {} if self._robot.urdf is None else link_shapes(self._robot.urdf)
        for k, link in enumerate(self._robot.links):
            for number, (shape, X_LO) in enumerate(shapes.get(link, [])):
                vertices, triangles = triangles_of(shape, 0)
                place = {"position": UNITS * np.array(X_LO.position), "wxyz": np.array(X_LO.rotation)}
                scene.add_mesh_simple(f"/links/{k}/{number}", UNITS * vertices, triangles, color=_LINK_COLOUR, side="double", **place)

    def _segments(self, positions: Sequence[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """First and last points (num_segments, 3) of the capsules, m, in W."""
        chains = [np.array(chain) for chain in self._robot.chain_points(positions)]
        return np.concatenate([chain[:-1] for chain in chains]), np.concatenate([chain[1:] for chain in chains])

    def aim(self, camera: viser.InitialCameraConfig) -> None:
        """Places the first view of a browser so that the whole robot is seen."""
        camera.look_at = tuple(UNITS * self._centre)
        camera.position = tuple(UNITS * (self._centre + self._extent * np.array(_VIEW)))

    def move(self, positions: Sequence[float]) -> None:
        """Draws the robot at joint positions (num_joints), rad or m."""
        for handle, pose in zip(self._links, self._robot.link_poses(positions), strict=True):
            handle.position, handle.wxyz = UNITS * np.array(pose.position), np.array(pose.rotation)
        starts, ends = self._segments(positions)
        lengths = np.linalg.norm(ends - starts, axis=1)
        self._ends.batched_positions = (UNITS * np.concatenate([starts, ends])).astype(np.float32)
        self._bones.batched_positions = (UNITS * (starts + ends) / 2).astype(np.float32)
        self._bones.batched_wxyzs = _rotations_from_z(ends - starts).astype(np.float32)
        radii = np.full(len(lengths), _RADIUS_SHARE * self._extent)
        self._bones.batched_scales = (UNITS * np.column_stack([radii, radii, lengths])).astype(np.float32)
        tips = [[X_WS.position, X_WS.transform((0, 0, _ARROW_SHARE * self._extent))] for X_WS in self._robot.sensor_poses(positions)]
        self._arrows.points = (UNITS * np.array(tips)).astype(np.float32)
        for label, (_, tip) in zip(self._labels, tips, strict=True):
            label.position = UNITS * np.array(tip)


def _rotations_from_z(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (N, 4) of the smallest rotations from z to directions (N, 3); the identity for a direction of length 0."""
    lengths = np.linalg.norm(directions, axis=1, keepdims=True)
    x, y, z = np.where(lengths > 0, directions / np.where(lengths > 0, lengths, 1), [0, 0, 1]).T
    rotations = np.stack([1 + z, -y, x, np.zeros_like(z)], 1)
    rotations[1 + z < 1e-9] = [0, 1, 0, 0]  # half a turn about x
    return np.asarray(rotations / np.linalg.norm(rotations, axis=1, keepdims=True))
