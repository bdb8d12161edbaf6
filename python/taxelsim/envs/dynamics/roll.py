"""Roll: a ball on a table to a place under the palm that rolls it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..draws import Array
from .models import document, pad
from .vector_env import DynamicVectorEnv, Outcome

RADIUS, MASS = 0.01, 0.05  # m, kg, of the ball
LOAD = 2.0  # N, with which the palm presses
COVER = 3300.0  # N/m: a ball 0.6 mm deep in the soft cover, pi R k d^2 = 2 N
TABLE = 0.0  # m, height
START, GOAL = (0.005, 0.012), (0.006, 0.015)  # m, largest offsets of ball and goal from the middle of the array, along x and y of S
TOLERANCE = 0.002  # m
HOLD = 20  # steps, 0.2 s
SPEED = 0.06  # m/s, of the palm at action 1


class RollVectorEnv(DynamicVectorEnv):
    """A palm rolls a ball on a table until the ball is at a goal under the palm, and keeps it there.

    Where the ball starts under the palm and the goal are drawn. The palm presses with 2 N and follows in height.

    Actions (2): velocity of the palm along x and y of S, of 60 mm/s. `goal` (2): place of the goal in S, m.
    Success: the ball is within 2 mm of the goal in the last 0.2 s. Metric: `goal_distance`, m.
    """

    geoms = ("ball",)
    speeds = (SPEED, SPEED)
    num_goal = 2
    num_draws = 4
    max_episode_steps = 150

    @staticmethod
    def model_text(stiffness: float) -> str:
        # A long soft spring is a nearly constant force.
        spring = 10.0
        body = f"""
          <geom name="table" type="plane" size="1 1 .1" pos="0 0 {TABLE}" friction="1 .005 .0001"/>
          <body name="palm" pos="0 0 {2 * RADIUS}" gravcomp="1"><inertial pos="0 0 0" mass=".3" diaginertia=".001 .001 .001"/>
            <joint name="x" type="slide" axis="1 0 0" range="-.2 .2"/><joint name="y" type="slide" axis="0 -1 0" range="-.2 .2"/>
            <joint name="z" type="slide" axis="0 0 1" stiffness="{spring}" springref="{-LOAD / spring}" damping="15" limited="true"
              range="-.003 .003"/>
            <body name="pad" euler="180 0 0">{pad(stiffness, 'friction="1 .005 .0001"', COVER, 2)}</body>
          </body>
          <body name="ball" pos="0 0 {RADIUS}"><freejoint/>
            <geom name="ball" size="{RADIUS}" mass="{MASS}" friction="1 .005 .0001"/></body>"""
        return document(body, '<position joint="x"/><position joint="y"/>')

    def _allocate(self) -> None:
        self._held = np.zeros(self.num_envs, np.int64)
        self._address = int(self.model.jnt_qposadr[self.model.body("ball").jntadr[0]])

    def _place(self, rows: NDArray[np.intp], draws: Array) -> None:
        ball = self._address
        self.batch.qpos[rows, ball] = START[0] * (2 * draws[:, 0] - 1)
        self.batch.qpos[rows, ball + 1] = -START[1] * (2 * draws[:, 1] - 1)
        self._held[rows] = 0

    def _goal(self) -> Array:
        return np.asarray(np.array(GOAL) * (2 * self._draws[:, 2:] - 1))

    def _distance(self) -> Array:
        qpos, ball = self.batch.qpos, self._address
        offset = np.column_stack((qpos[:, ball] - qpos[:, 0], -qpos[:, ball + 1] - qpos[:, 1]))  # y of S and its joint point down the table
        return np.asarray(np.hypot(*(offset - self._goal()).T))

    def _judge(self) -> Outcome:
        distance = self._distance()
        self._held = np.where(distance < TOLERANCE, self._held + 1, 0)
        return Outcome(-distance / GOAL[1], np.zeros(self.num_envs, np.bool_), self._held >= HOLD)

    def _metrics(self) -> dict[str, NDArray[Any]]:
        return {"goal_distance": self._distance()}
