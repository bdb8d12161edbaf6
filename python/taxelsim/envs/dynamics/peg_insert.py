"""PegInsert: a square peg, held by elastic fingers, into a square hole whose place is known roughly."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..draws import Array
from .models import SITE, TANGENTIAL_RATIO, document
from .vector_env import DynamicVectorEnv, Outcome

HALF_WIDTH, HALF_LENGTH, MASS = 0.006, 0.02, 0.1  # m, kg, of the peg
CLEARANCE = (0.0005, 0.002)  # m, of the width of the hole
OFFSET = 0.003  # m, largest offset of the hole along x and y
START_HEIGHT = 0.002  # m, of the peg above the plate
PRELOAD = 0.0003  # m, depth of the peg in the skin
GRIP = 0.012  # m, of the middle of the pad above the lower end of the peg
DEPTH = 0.006  # m: inserted
WALL = 0.02  # m, half-width of the walls
FORCE_LIMIT = 30.0  # N, on the plate


class PegInsertVectorEnv(DynamicVectorEnv):
    """A gripper inserts a peg into a hole with a clearance of 0.5 mm to 2 mm, drawn, and an error of up to 3 mm along x and y, drawn.

    The fingers hold the peg without slip; it gives way in the grasp by the elasticity of their skins, in all directions. The sensor on one
    finger sees the peg's side: tilts about y of S move the pressure along x, tilts about z of S and pushes are shear.

    Actions (3): velocity along x, y and z of the world, of 30 mm/s; x is z of S, y is y of S, z is -x of S.
    `goal` (3): the assumed place of the hole relative to the gripper, m.
    The episode ends with success when the peg is 6 mm in the hole, and fails above 30 N on the plate. Metrics: `depth`, m, `clearance`, m,
    and `push`, N.
    Reward: +10 with success, -10 with failure, and the progress of a step: of the depth, over 6 mm, and towards the axis of the hole, over
    3 mm. Staying gives 0, so that nothing is won by waiting before the end.
    """

    geoms = ("peg",)
    speeds = (0.03, 0.03, 0.03)
    num_goal = 3
    num_draws = 3
    max_episode_steps = 400

    @staticmethod
    def model_text(stiffness: float) -> str:
        # Two skins of 12 mm x 20.4 mm on the peg, along x of the world, and their moments.
        area, height = 2 * HALF_WIDTH * 0.0204, 0.0204
        k = 2 * stiffness * area
        t = TANGENTIAL_RATIO * k
        about = {"x": t * (height**2 + 4 * HALF_WIDTH**2) / 12, "y": k * height**2 / 12, "z": k * 4 * HALF_WIDTH**2 / 12}
        slides = "".join(
            f'<joint name="peg_{n}" type="slide" axis="{a}" stiffness="{s:.9g}" damping="{(s * MASS) ** 0.5:.9g}"/>'
            for n, a, s in (("x", "1 0 0", k), ("y", "0 1 0", t), ("z", "0 0 1", t))
        )
        inertia = 2e-5
        hinges = "".join(
            f'<joint name="tilt_{n}" axis="{a}" stiffness="{about[n]:.9g}" damping="{(about[n] * inertia) ** 0.5:.9g}"/>'
            for n, a in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1"))
        )
        middle = HALF_LENGTH - GRIP
        walls = "".join(
            f'<body name="wall{i}" mocap="true"><geom name="wall{i}" type="box" size="{WALL} {WALL} .01" friction=".4 .005 0"/></body>'
            for i in range(4)
        )
        body = f"""{walls}
          <body name="gripper" pos="0 0 {START_HEIGHT + GRIP}" gravcomp="1"><inertial pos="0 0 0" mass=".5" diaginertia=".001 .001 .001"/>
            <joint name="x" type="slide" axis="1 0 0" range="-.02 .02"/><joint name="y" type="slide" axis="0 1 0" range="-.02 .02"/>
            <joint name="z" type="slide" axis="0 0 1" range="-.03 .01"/>
            <body name="pad" pos="{-HALF_WIDTH + PRELOAD} 0 0" euler="0 90 0"><site name="{SITE}"/></body>
            <body name="peg" gravcomp="1">{slides}{hinges}
              <inertial pos="0 0 {middle}" mass="{MASS}" diaginertia="{inertia} {inertia} {inertia}"/>
              <geom name="peg" type="box" size="{HALF_WIDTH} {HALF_WIDTH} {HALF_LENGTH}" pos="0 0 {middle}" friction=".4 .005 0"/></body>
          </body>"""
        return document(body, '<position joint="x"/><position joint="y"/><position joint="z"/>')

    def _allocate(self) -> None:
        self._progress = np.zeros(self.num_envs)

    def _clearance(self) -> Array:
        return np.asarray(CLEARANCE[0] + (CLEARANCE[1] - CLEARANCE[0]) * self._draws[:, 2])

    def _hole(self) -> Array:
        return np.asarray(OFFSET * (2 * self._draws[:, :2] - 1))

    def _place(self, rows: NDArray[np.intp], draws: Array) -> None:
        reach = HALF_WIDTH + self._clearance()[rows] / 2 + WALL
        hole, walls = self._hole()[rows], self.batch.mocap_pos
        for i, (x, y) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
            walls[rows, i, 0] = hole[:, 0] + x * reach
            walls[rows, i, 1] = hole[:, 1] + y * reach
            walls[rows, i, 2] = -0.01
        self._progress[rows] = self._potential()[rows]

    def _goal(self) -> Array:
        return np.asarray(-self.batch.qpos[:, :3] - (0, 0, START_HEIGHT))

    def _depth(self) -> Array:
        return np.asarray(-START_HEIGHT - self.batch.qpos[:, 2] - self.batch.qpos[:, 5])

    def _force(self) -> Array:
        return np.asarray(np.abs(self.batch.qpos[:, 5]) * self.model.joint("peg_z").stiffness[0])

    def _potential(self) -> Array:
        """What the reward calls progress: 1 for the whole depth, -1 for each 3 mm of distance from the axis of the hole."""
        distance = np.hypot(*(self.batch.qpos[:, :2] - self._hole()).T)
        return np.asarray(np.clip(self._depth() / DEPTH, 0, 1) - distance / OFFSET)

    def _judge(self) -> Outcome:
        inserted = self._depth() > DEPTH
        broken = self._force() > FORCE_LIMIT
        before, self._progress = self._progress, self._potential()
        return Outcome(self._progress - before + 10.0 * inserted - 10.0 * broken, inserted | broken, inserted & ~broken)

    def _metrics(self) -> dict[str, NDArray[Any]]:
        return {"depth": self._depth(), "clearance": self._clearance(), "push": self._force()}
