"""Observations of a task with dynamics, by name.

| name | shape of one environment | content |
|---|---|---|
| `contact` | (4) | centre of pressure x, y, z, m; normal force, N; of the tactile image |
| `tactile_image` | (rows, cols) | counts, int32 |
| `binary_contact` | (1) | 1 if a taxel is above its trigger, else 0 |
| `binary_image` | (rows, cols) | 1 for each taxel with counts, else 0 |
| `center_of_pressure` | (3) | of the tactile image, m |
| `shear` | (3) | shear force x, y, N, and torque about z, N m, on the sensor |
| `shear_image` | (rows, cols, 2) | shear force of each taxel, N |
| `features` | (13) | as FEATURES |
| `proprioception` | (2 x joints) | positions of the actuated joints, and their targets, m or rad |
| `goal` | of the task | what the task asks, in the sensor's plane |

Shear is the true one: a tactile image has none, and these sensors have no three-axis taxels. All in the sensor frame S.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from ..._core import Sensor
from ..._differentiation import image_shape
from ...frame import Frame
from ...policies.observations import FEATURES, touched

TACTILE = ("contact", "tactile_image", "binary_contact", "binary_image", "center_of_pressure", "shear", "shear_image", "features")
"""Observations that come from the sensor."""

OBSERVATIONS = (*TACTILE, "proprioception", "goal")


def tactile(name: str, frame: Frame) -> NDArray[Any]:
    """One observation out of TACTILE, (N, ...); a copy."""
    truth = frame.ground_truth
    if name == "contact":
        return np.column_stack((frame.center_of_pressure, frame.total_force)).astype(np.float32)
    if name == "tactile_image":
        return np.array(frame.tactile_image)
    if name == "binary_contact":
        return touched(frame)
    if name == "binary_image":
        return (frame.tactile_image > 0).astype(np.float32)
    if name == "center_of_pressure":
        return np.array(frame.center_of_pressure, np.float32)
    if name == "shear":
        return truth.contact_wrench[:, [0, 1, 5]].astype(np.float32)  # on a flat skin only friction acts along x and y and about z
    if name == "shear_image":
        image: NDArray[np.float32] = truth.tactile_shear_force.copy()
        return image
    columns = [frame[name].reshape(len(frame.total_force), -1) for name, _, _ in FEATURES]
    return np.concatenate(columns, axis=1, dtype=np.float32)


def space(name: str, sensor: Sensor, num_joints: int, num_goal: int) -> spaces.Box:
    """Space of an observation of one environment."""
    image = image_shape(sensor)
    if name == "tactile_image":
        return spaces.Box(0, sensor.readout.saturation, image, np.int32)
    if name.startswith("binary"):
        return spaces.Box(0, 1, image if name == "binary_image" else (1,), np.float32)
    shapes = {
        "contact": (4,),
        "center_of_pressure": (3,),
        "shear": (3,),
        "shear_image": (*image, 2),
        "features": (sum(size for _, size, _ in FEATURES),),
        "proprioception": (2 * num_joints,),
        "goal": (num_goal,),
    }
    return spaces.Box(-np.inf, np.inf, shapes[name], np.float32)
