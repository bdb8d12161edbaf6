"""Actions in [-1, 1] to what the robot follows: a twist of the sensor, or velocities or positions of the joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._arguments import checked_names, checked_positive
from .._core import Scene
from ..errors import InputError

ACTIONS = ("v_x", "v_y", "v_z", "w_x", "w_y", "w_z")
"""Components of the twist of sensor 0 in its own frame S: linear velocity of its origin (m/s), then angular velocity (rad/s)."""

COMMANDS = ("twist", "joint_velocities", "joint_positions")
"""What a policy commands."""


class ActionMap:
    """Maps actions (N, len(names)) in [-1, 1] to the commands of a scene's robot. Components without an action are 0.

    action: "twist", or "joint_velocities" or "joint_positions" in a scene whose robot has joints. Default: "twist", which a hand does not
        take; in a scene of kind grasp "joint_velocities".
    names: components that have an action, out of ACTIONS or of the joints' names; default: all.
    linear_scale, angular_scale: the components at action 1, m/s and rad/s, > 0. Default: the limits of the scene's first controller for a
        twist, its velocity limit for each joint. Positions go from a joint's lower limit at action -1 to its upper limit at 1, and take no
        scale. A joint moves to its position within a control period, at most with its velocity limit.
    """

    def __init__(
        self,
        scene: Scene,
        action: str | None = None,
        names: str | Sequence[str] | None = None,
        linear_scale: float | None = None,
        angular_scale: float | None = None,
    ) -> None:
        allowed = COMMANDS[1:] if scene.kind == Scene.Kind.GRASP else COMMANDS
        action = action or allowed[0]
        checked_names("action", action, allowed)
        for name, scale in (("linear_scale", linear_scale), ("angular_scale", angular_scale)):
            if scale is not None:
                checked_positive(name, scale)
                if action == "joint_positions":
                    raise InputError(f"{name}: {scale} is not allowed with 'joint_positions': the limits of the joints are their range")
        self.by_joints = action != "twist"  #: Whether commands are joint velocities.
        components = _joints(scene, action) if self.by_joints else _twist(scene)
        self.names = tuple(components) if names is None else checked_names("actions", names, tuple(components))
        self._num_components = len(components)
        self._columns = np.array([list(components).index(name) for name in self.names])
        self._step_time = 1 / scene.control_rate
        self._ranges = _position_ranges(scene, self.names) if action == "joint_positions" else None
        if self._ranges is None:
            self._scales = np.array([_scale(name, *components[name], linear_scale, angular_scale) for name in self.names])
        else:
            self._scales = np.array([components[name][1] for name in self.names])

    @property
    def scales(self) -> NDArray[np.float64]:
        """(len(names)): m/s or rad/s of each component at action 1; of positions the velocity limit of each joint."""
        scales: NDArray[np.float64] = self._scales.copy()
        return scales

    def commands(self, actions: NDArray[Any], joint_positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Twists (N, 6) in S, or joint velocities (N, num_joints), m/s and rad/s.

        actions: (N, len(names)), finite and in [-1, 1]. joint_positions: (N, num_joints), rad or m, present ones.
        """
        commands = np.zeros((len(actions), self._num_components))
        if self._ranges is None:
            commands[:, self._columns] = actions * self._scales
        else:
            lower, upper = self._ranges
            goals = lower + (actions.astype(np.float64) + 1) / 2 * (upper - lower)
            velocities = (goals - joint_positions[:, self._columns]) / self._step_time
            commands[:, self._columns] = np.clip(velocities, -self._scales, self._scales)
        return commands


# Components by name: whether it is an angular velocity, and its default scale.
_Components = dict[str, tuple[bool, float]]


def _twist(scene: Scene) -> _Components:
    linear, angular = _core.servo_limits(scene)
    return {name: (k >= 3, angular if k >= 3 else linear) for k, name in enumerate(ACTIONS)}


def _joints(scene: Scene, action: str) -> _Components:
    joints = _core.joints_of(scene)
    if not joints:
        raise InputError(f"{scene.file}: action: {action!r} is not allowed: 'twist', as the robot of this scene has no joints")
    return {name: (is_revolute, max_velocity) for name, is_revolute, max_velocity, _, _ in joints}


def _position_ranges(scene: Scene, names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lower and upper limits (len(names)) of the joints, rad or m."""
    limits = {name: (lower, upper) for name, _, _, lower, upper in _core.joints_of(scene)}
    for name in names:
        if not np.isfinite(limits[name]).all():
            raise InputError(f"actions: joint {name!r} has no position limits, which 'joint_positions' needs")
    lower, upper = np.array([limits[name] for name in names]).T
    return lower, upper


def _scale(name: str, is_angular: bool, limit: float, linear_scale: float | None, angular_scale: float | None) -> float:
    scale = angular_scale if is_angular else linear_scale
    if scale is not None:
        return float(scale)
    if not np.isfinite(limit):
        needed = "angular_scale" if is_angular else "linear_scale"
        raise InputError(f"actions: joint {name!r} has no velocity limit, so {needed} is needed")
    return limit
