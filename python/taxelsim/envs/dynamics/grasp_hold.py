"""GraspHold: two fingers hold a cylinder that a disturbance pulls down."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..draws import Array
from .models import NORMAL_STIFFNESS, SERVO, SOFT_STIFFNESS, TANGENTIAL_RATIO, cover, document, pad
from .vector_env import STEP, DynamicVectorEnv, Outcome

RADIUS, HALF_HEIGHT, MASS = 0.015, 0.02, 0.1  # m, kg, of the cylinder
GRAVITY = 9.81  # m/s^2
PULL = (0.5, 5.0)  # N, largest disturbance of an episode
ONSET, RISE = (0.3, 0.8), 0.4  # s, start of the disturbance, and time in which it grows to its full size
FRICTION = (0.6, 0.9)  # of the cylinder on the covers
START_FORCE = 2.0  # N
SLIP = 0.003  # m, downwards: a failure
ECONOMY = 1.5  # mean grip force over mean load: above it the grip was too tight


class GraspHoldVectorEnv(DynamicVectorEnv):
    """Two fingers hold a cylinder, lightly, while a disturbance pulls it down.

    Size and start of the disturbance and the friction are drawn. Each finger carries half of the load, weight and disturbance.

    Action (1): closing speed of the fingers, of 4 mm/s each. `goal` (1): the friction coefficient that can be relied on, 0.6.
    The episode fails at once if the cylinder slips by 3 mm. Success: it has not slipped, and the mean grip force of a finger was at most
    1.5 times the mean load. Metrics: `slip`, m, and `economy`, mean grip force over mean load.
    """

    geoms = ("object",)
    speeds = (0.004,)
    num_goal = 1
    num_draws = 3
    max_episode_steps = 200

    @staticmethod
    def model_text(stiffness: float) -> str:
        normal = NORMAL_STIFFNESS * stiffness / SOFT_STIFFNESS
        friction = 'friction=".6 .005 .0001"'
        second = cover("second", normal, normal * TANGENTIAL_RATIO * 1.5, friction)
        body = f"""
          <body name="left" pos="{-RADIUS} 0 0" gravcomp="1"><inertial pos="0 0 0" mass=".3" diaginertia=".001 .001 .001"/>
            <joint name="close" type="slide" axis="1 0 0" range="-.005 .01"/>
            <body name="pad" euler="0 90 0">{pad(stiffness, friction)}</body></body>
          <body name="right" pos="{RADIUS} 0 0" gravcomp="1"><inertial pos="0 0 0" mass=".3" diaginertia=".001 .001 .001"/>
            <joint name="other" type="slide" axis="-1 0 0" range="-.005 .01"/>
            <body name="pad2" euler="0 -90 0">{second}</body></body>
          <body name="object"><freejoint/><geom name="object" type="cylinder" size="{RADIUS} {HALF_HEIGHT}" mass="{MASS}" {friction}
            priority="1"/></body>"""
        return document(body, '<position joint="close"/><position joint="other"/>', f'gravity="0 0 {-GRAVITY}"')

    def _targets(self, velocities: Array) -> None:
        super()._targets(np.repeat(velocities, 2, axis=1))

    def _allocate(self) -> None:
        self._grip_sum, self._load_sum, self._slip = (np.zeros(self.num_envs) for _ in range(3))
        self._object = self.model.body("object").id
        self._height = int(self.model.jnt_qposadr[self.model.body_jntadr[self._object]]) + 2
        self._cover = int(self.model.joint("cover_z").qposadr[0])
        self._stiffness = float(self.model.joint("cover_z").stiffness[0])

    def _place(self, rows: NDArray[np.intp], draws: Array) -> None:
        for values in (self._grip_sum, self._load_sum, self._slip):
            values[rows] = 0
        self.batch.expand("geom_friction")[rows, self.model.geom("object").id, 0] = FRICTION[0] + (FRICTION[1] - FRICTION[0]) * draws[:, 2]
        depth = START_FORCE / self._stiffness
        self.batch.qpos[rows, self._cover] = -depth
        self.batch.qpos[rows, int(self.model.joint("second_z").qposadr[0])] = -depth
        closed = self.model.joint("close").qposadr[0], self.model.joint("other").qposadr[0]
        for address in closed:
            self.batch.qpos[rows, address] = depth
        self.batch.ctrl[rows] = depth + START_FORCE / SERVO
        self.batch.xfrc_applied[rows] = 0

    def _pull(self) -> Array:
        """Disturbance (N), N, now."""
        size = PULL[0] + (PULL[1] - PULL[0]) * self._draws[:, 0]
        onset = ONSET[0] + (ONSET[1] - ONSET[0]) * self._draws[:, 1]
        return np.asarray(size * np.clip((STEP * self._elapsed - onset) / RISE, 0, 1))

    def _push(self) -> None:
        self.batch.xfrc_applied[:, self._object, 2] = -self._pull()

    def _goal(self) -> Array:
        return np.full((self.num_envs, 1), FRICTION[0])

    def _judge(self) -> Outcome:
        self._grip_sum -= self._stiffness * self.batch.qpos[:, self._cover]  # N: the spring of the cover, the true force on the finger
        self._load_sum += MASS * GRAVITY + self._pull()
        # What the covers give way is no slip: their displacement along the pull is that of the object until it slips.
        give = self.batch.qpos[:, self._cover - 2]
        self._slip = np.maximum(self._slip, -self.batch.qpos[:, self._height] - give)
        failed = self._slip > SLIP
        economy = self._economy()
        return Outcome(1 - np.abs(np.log(np.maximum(economy, 1e-3))) - 10.0 * failed, failed, ~failed & (economy <= ECONOMY))

    def _economy(self) -> Array:
        return np.asarray(self._grip_sum / np.maximum(self._load_sum, 1e-9))

    def _metrics(self) -> dict[str, NDArray[Any]]:
        return {"slip": self._slip.copy(), "economy": self._economy()}
