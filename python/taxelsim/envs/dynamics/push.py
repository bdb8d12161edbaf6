"""Push: a disc on a table to a goal along a path, seen by touch alone."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..draws import Array, each
from .models import document, pad
from .vector_env import STEP, DynamicVectorEnv, Outcome, rotated

RADIUS, HALF_HEIGHT, MASS = 0.03, 0.015, 0.2  # m, kg, of the disc
LENGTH = 0.12  # m, of the path along x
SPEED = 0.04  # m/s, of the target along x
LOOKAHEAD = 0.02  # m: the target is ahead of the disc's schedule by this much
START_OFFSET = 0.01  # m, largest offset of the disc from the middle of the pad
BEND = 0.025  # m, largest offset of the goal to the side
FRICTION = (0.25, 0.6)  # of disc on table
TOLERANCE = 0.005  # m, of the final position


class PushVectorEnv(DynamicVectorEnv):
    """A pad pushes a disc along a path that bends to a side, and stops it at the goal.

    Where the disc starts against the pad (up to 10 mm off its middle), the bend and the friction with the table are drawn. A policy
    observes the position of its target, not that of the disc.

    Actions (3): forward (along z of S), to the side (along y of S), m/s of 60 mm/s, and turn to the side of y, of 1 rad/s.
    `goal` (4): target that moves along the path, then the goal, forward and to the side of the pad, m.
    Success: the disc is within 5 mm of the goal at the end. Metrics: `goal_distance`, `path_error` (mean distance from the path), m.
    Reward, in [0, 2]: w (1 - d / 120 mm), at least 0, and exp(-(d / 5 mm)^2), where d is the distance from the goal,
    w = (1 + exp(-(e / 5 mm)^2)) / 2, and e the distance from the path. It is about 0 at the start, and an episode that ends early because
    contact is lost wins nothing.
    """

    geoms = ("disc",)
    speeds = (0.06, 0.06, 1.0)
    num_goal = 4
    num_draws = 3
    max_episode_steps = round((LENGTH / SPEED + 0.8) / STEP)
    max_lost_steps: ClassVar[int] = 60

    @staticmethod
    def model_text(stiffness: float) -> str:
        body = f"""
          <geom name="table" type="plane" size="1 1 .1" friction="0 0 0"/>
          <body name="pusher" pos="0 0 {HALF_HEIGHT}"><inertial pos="0 0 0" mass="1" diaginertia=".01 .01 .01"/>
            <joint name="x" type="slide" axis="1 0 0" range="-1 1"/><joint name="y" type="slide" axis="0 1 0" range="-1 1"/>
            <joint name="yaw" axis="0 0 1" range="-85 85"/>
            <body name="pad" euler="0 90 0">{pad(stiffness, 'friction=".6 .005 0" priority="1"')}</body>
          </body>
          <body name="disc" pos="{RADIUS} 0 {HALF_HEIGHT}"><freejoint/>
            <geom name="disc" type="cylinder" size="{RADIUS} {HALF_HEIGHT}" mass="{MASS}" friction=".4 .005 0"/></body>"""
        servos = '<position joint="x" kp="4000"/><position joint="y" kp="4000"/><position joint="yaw" kp="40"/>'
        return document(body, servos, 'gravity="0 0 -9.81"')

    def _allocate(self) -> None:
        self._error_sum = np.zeros(self.num_envs)
        self._address = int(self.model.jnt_qposadr[self.model.body("disc").jntadr[0]])

    def _place(self, rows: NDArray[np.intp], draws: Array) -> None:
        self.batch.qpos[rows, self._address + 1] = START_OFFSET * (2 * draws[:, 0] - 1)
        self.batch.expand("geom_friction")[rows, self.model.geom("disc").id, 0] = FRICTION[0] + (FRICTION[1] - FRICTION[0]) * draws[:, 2]
        self._error_sum[rows] = 0

    @property
    def _disc(self) -> Array:
        return np.asarray(self.batch.qpos[:, self._address : self._address + 2])

    @property
    def _bend(self) -> Array:
        return BEND * (2 * self._draws[:, 1] - 1)

    def _path(self, x: Array) -> Array:
        """Offset to the side of the path at x, (N), m."""
        u = np.clip((x - RADIUS) / LENGTH, 0, 1)
        return np.asarray(self._bend * u * u * (3 - 2 * u))

    def _goal(self) -> Array:
        pusher, yaw = self.batch.qpos[:, :2], self.batch.qpos[:, 2]
        x = RADIUS + np.minimum(SPEED * STEP * self._elapsed + LOOKAHEAD, LENGTH)
        target = np.column_stack((x, self._path(x)))
        end = np.column_stack((np.full(self.num_envs, RADIUS + LENGTH), self._bend))
        return np.concatenate((rotated(target - pusher, -yaw), rotated(end - pusher, -yaw)), axis=1)

    def _targets(self, velocities: Array) -> None:
        # Forward and sideways velocities belong to the pad, and so does the turn about the middle of its face.
        turned = np.array(velocities)
        turned[:, :2] = rotated(velocities[:, :2], self.batch.qpos[:, 2])
        super()._targets(turned)

    def _distance(self) -> Array:
        disc = self._disc
        return np.asarray(np.hypot(disc[:, 0] - RADIUS - LENGTH, disc[:, 1] - self._bend))

    def _judge(self) -> Outcome:
        disc = self._disc
        error = np.abs(disc[:, 1] - self._path(disc[:, 0]))
        self._error_sum += error
        distance = self._distance()
        on_path, at_goal = (each(math.exp, -((values / TOLERANCE) ** 2)) for values in (error, distance))
        reward = np.maximum(1 - distance / LENGTH, 0) * (1 + on_path) / 2 + at_goal
        return Outcome(reward, np.zeros(self.num_envs, np.bool_), distance < TOLERANCE)

    def _metrics(self) -> dict[str, NDArray[Any]]:
        return {"goal_distance": self._distance(), "path_error": self._error_sum / np.maximum(self._elapsed, 1)}
