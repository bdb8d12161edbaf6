"""Topics of a sensor: which messages a frame is published as."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import Pose, Sensor, axis_angle
from .._counts import newtons_of_counts
from ..errors import InputError
from ..frame import Frame
from .messages import image, pixels, point_cloud, pose, wrench

POINT = ("x", "y", "z", "normal_force")
"""Fields of a point of the topic `taxels`: m in the sensor frame, and N."""
_NAME = re.compile(r"(?!.{201})[A-Za-z](_?[A-Za-z0-9])*")  # a token of a topic of ROS 2, which has at most 247 characters


@dataclass(frozen=True)
class Topic:
    """A topic, without its namespace."""

    name: str
    schema: str
    content: Callable[[Frame, int], dict[str, Any] | None]
    """Fields of the message, without its header, of a frame and the index of an instance. None: there is no message for this frame."""


def namespace_of(name: str) -> str:
    """Namespace of the topics of a sensor; "" is the only sensor. Raises InputError for a name that ROS 2 does not allow."""
    if name and not _NAME.fullmatch(name):
        raise InputError(
            f"sensor {name!r:.60} is not allowed as a part of a topic: up to 200 letters, digits and single underscores, a letter first"
        )
    return f"/tactile/{name}" if name else "/tactile"


def topics_of(sensor: Sensor) -> tuple[Topic, ...]:
    """The topics of a sensor. Their contents are those of frames of Simulator, in counts or in newtons."""
    patches = sensor.patches
    X_SP = patches[0].X_SP if len(patches) == 1 else Pose()  # the edge angle of several patches is in the xy plane of S
    counts = np.uint16 if sensor.readout.saturation < 1 << 16 else np.int32
    newtons = newtons_of_counts(sensor.readout)
    points = np.zeros((sensor.num_taxels, len(POINT)), "<f4")
    points[:, :3] = sensor.taxel_positions

    def tactile_image(frame: Frame, instance: int) -> dict[str, Any]:
        values = frame.tactile_image[instance]
        return image(values if values.dtype.kind == "f" else values.astype(counts))

    def taxels(frame: Frame, instance: int) -> dict[str, Any]:
        values = frame.tactile_image[instance].reshape(-1)
        points[:, 3] = values if values.dtype.kind == "f" else newtons[values]
        return point_cloud(POINT, points)

    def contact(frame: Frame, instance: int) -> dict[str, Any] | None:
        if not frame.total_force[instance] > 0:
            return None
        rotation = (X_SP * Pose(rotation=axis_angle([0, 0, 1], float(frame.edge_angle[instance])))).rotation
        return pose([*frame.center_of_pressure[instance], *rotation])

    def axes(frame: Frame, instance: int) -> dict[str, Any] | None:
        return pixels(frame.taxel_counts[instance]) if "taxel_counts" in frame else None

    return (
        Topic("image", "sensor_msgs/Image", tactile_image),
        Topic("taxels", "sensor_msgs/PointCloud2", taxels),
        Topic("contact_wrench", "geometry_msgs/WrenchStamped", lambda frame, instance: wrench(frame.ground_truth.contact_wrench[instance])),
        Topic("contact_pose", "geometry_msgs/PoseStamped", contact),
        *([Topic("taxel_counts", "sensor_msgs/Image", axes)] if sensor.readout.three_axis else []),
    )
