"""Vector environment of bodies that MuJoCo moves and a sensor that observes them."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import mujoco
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from mujoco.batch import Batch
from numpy.typing import NDArray

from ... import mujoco as engine
from ..._arguments import checked_names
from ..._core import Device, Friction, OutputOptions, Sensor, Winkler, load_sensor
from ...errors import InputError
from ...pictures import TactilePictures
from ...program import SCENES
from ..draws import Array, each, uniform_numbers
from ..episodic import EpisodicVectorEnv, Mask
from ..tasks import CONDITIONS
from . import observations as observed
from .models import SITE, TANGENTIAL_RATIO

STEP = 0.01
"""s, of a control step: ten time steps of MuJoCo."""

SKIN_FRICTION = 3.0
"""Friction coefficient of the observing skin, above those of the bodies: it sticks where MuJoCo's contact sticks."""


@dataclass(frozen=True)
class Condition:
    """Sensor, and ranges of its variation per episode."""

    sensor: str
    gain: tuple[float, float]
    gain_spread: tuple[float, float]  #: In addition to the sensor's own, as is the noise.
    noise: tuple[float, float]  #: counts


CONDITION_OF = dict(
    zip(
        CONDITIONS,
        (
            Condition("wts0614_soft_cover_calibrated", (1, 1), (0, 0), (0, 0)),
            Condition("wts0614_soft_cover_realistic", (0.8, 1.2), (0, 0.3), (0, 20)),
            Condition("wts0614_unseen", (1.25, 1.4), (0.35, 0.44), (25, 40)),
        ),
        strict=True,
    )
)
"""The conditions of docs/reference/tasks.md."""


@dataclass(frozen=True)
class Outcome:
    """Result of a step: rewards, terminated and successful environments, (N) each. A success counts at the end of an episode only."""

    reward: Array
    terminated: Mask
    success: Mask


class DynamicVectorEnv(EpisodicVectorEnv):
    """N simulations of MuJoCo with one tactile array each; one step is 10 ms: ten time steps, then one frame of the whole batch.

    MuJoCo's contacts move the bodies, the sensor observes them (one-way). Actions are velocities of the robot's joints, in [-1, 1] of
    `speeds`; position servos follow them.

    condition: "nominal", "randomized" or "unseen": sensor and variation of its readout.
    shear: whether the observing skin has friction. Without it `shear` and `shear_image` are 0. The motion of the bodies is the same.
    observations: out of OBSERVATIONS of observations.py; a name gives an array, a sequence of names a dict.
    render_mode: None, or "rgb_array": render() returns a picture of every tactile image.
    range: counts of the brightest colour of these pictures; default: the largest so far, beyond noise.
    device: an open Device, or the argument of Device.open().
    backend: library of the tensors that reset() and step() return, see EpisodicVectorEnv.

    Infos: `episode_key`, `success` (only at the end of an episode), `contact`, `peak_force` and `mean_force` (N, largest and mean true
    normal force of the steps of the episode so far), and the metrics of the task. Subclasses define the model, the draws of an episode
    and the metrics.
    """

    geoms: ClassVar[tuple[str, ...]]  #: Geoms that touch the sensor.
    speeds: ClassVar[tuple[float, ...]]  #: m/s or rad/s, of each action at 1.
    num_goal: ClassVar[int]  #: Numbers of the observation `goal`.
    num_draws: ClassVar[int]  #: Random numbers of an episode.
    max_episode_steps: ClassVar[int]  #: Steps of an episode that is not terminated.
    max_lost_steps: ClassVar[int] = 25  #: An episode is terminated after more steps in a row without contact.

    def __init__(
        self,
        num_envs: int = 1,
        *,
        condition: str = "nominal",
        shear: bool = True,
        observations: str | Sequence[str] = ("contact", "shear", "proprioception", "goal"),
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
        range: float | None = None,
        device: Device | str = "",
        backend: str = "numpy",
    ) -> None:
        super().__init__(num_envs, autoreset_mode, render_mode, backend)
        checked_names("condition", condition, CONDITIONS)
        if not isinstance(shear, bool):
            raise InputError(f"shear: {shear!r} is not allowed: True and False")
        self.condition, self.shear = condition, shear
        self._names = checked_names("observations", observations, observed.OBSERVATIONS)
        self._is_dict = not isinstance(observations, str)
        self.sensor = self._skin()
        self.model = mujoco.MjModel.from_xml_string(self.model_text(_stiffness(self.sensor)))
        self.batch = Batch(self.model, num_envs)
        opened = device if isinstance(device, Device) else Device.open(device)
        outputs = OutputOptions(
            tactile_normal_force=False, penetration_depth=False, tactile_shear_force=shear and "shear_image" in self._names
        )
        self.tactile = engine.attach(self.model, {SITE: self.sensor}, self.geoms, num_instances=num_envs, device=opened, outputs=outputs)
        self.step_time = STEP
        self._substeps = round(STEP / float(self.model.opt.timestep))
        self._initial = self.batch.state[0].copy()
        self._ranges = np.array(self.model.jnt_range[self.model.actuator_trnid[:, 0]])
        self._joints = self.model.jnt_qposadr[self.model.actuator_trnid[:, 0]]
        self._elapsed = np.zeros(num_envs, np.int64)
        self._lost = np.zeros(num_envs, np.int64)
        self._peak_force = np.zeros(num_envs, np.float32)
        self._force_sum = np.zeros(num_envs, np.float64)  # N, of the steps of the episode so far
        self._success = np.zeros(num_envs, np.bool_)
        self._draws = np.zeros((num_envs, self.num_draws))
        self._pictures = TactilePictures(self.sensor, range, CONDITION_OF[self.condition].noise[1])
        self._allocate()
        self._make_spaces()

    def _skin(self) -> Sensor:
        sensor = load_sensor(SCENES / f"sensors/{CONDITION_OF[self.condition].sensor}.yaml")
        friction = Friction()
        if self.shear:
            friction = Friction(tangential_stiffness=TANGENTIAL_RATIO * _stiffness(sensor), friction_coefficient=SKIN_FRICTION)
        return sensor.replace(skin=sensor.skin.replace(friction=friction))

    def _make_spaces(self) -> None:
        one: dict[str, spaces.Space[Any]] = {name: observed.space(name, self.sensor, self.model.nu, self.num_goal) for name in self._names}
        self.single_observation_space = spaces.Dict(one) if self._is_dict else one[self._names[0]]
        self.single_action_space = spaces.Box(-1, 1, (len(self.speeds),), np.float32)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    @staticmethod
    @abstractmethod
    def model_text(stiffness: float) -> str:
        """MJCF of the task, for a skin of `stiffness` N/m^3."""

    def _allocate(self) -> None:
        """Arrays of the task, and addresses in its model."""

    @abstractmethod
    def _place(self, rows: NDArray[np.intp], draws: Array) -> None:
        """Sets the state of simulations `rows` (K) at the start of their episodes, from numbers in [0, 1), (K, num_draws)."""

    @abstractmethod
    def _goal(self) -> Array:
        """The observation `goal` (N, num_goal)."""

    @abstractmethod
    def _judge(self) -> Outcome:
        """Rewards and success of the present state."""

    @abstractmethod
    def _metrics(self) -> dict[str, NDArray[Any]]:
        """Infos of the task, (N) each."""

    def _targets(self, velocities: Array) -> None:
        """Moves the targets of the joints by velocities (N, joints), m/s or rad/s, for a control step."""
        ctrl = self.batch.ctrl
        np.clip(ctrl + STEP * velocities, self._ranges[:, 0], self._ranges[:, 1], out=ctrl)

    def _push(self) -> None:
        """External forces of the next control step."""

    def _start(self, mask: Mask, keys: NDArray[np.uint64]) -> None:
        rows = np.flatnonzero(mask)
        self._draws[rows] = uniform_numbers(keys[rows], self.num_draws)
        variation = uniform_numbers(keys[rows] ^ np.uint64(0xD1B54A32D192ED03), 3)
        self.batch.state[rows] = self._initial
        self._place(rows, self._draws[rows])
        condition = CONDITION_OF[self.condition]
        for name in ("_elapsed", "_lost", "_peak_force", "_force_sum", "_success"):
            getattr(self, name)[rows] = 0
        if self.condition == "nominal":
            self.tactile.reset(mask, keys[rows], noise=condition.noise[0])
        else:
            for i, (a, b, c) in zip(rows, variation, strict=True):
                gain, spread, noise = (
                    low + (high - low) * u
                    for (low, high), u in zip((condition.gain, condition.gain_spread, condition.noise), (a, b, c), strict=True)
                )
                self.tactile.reset(i, keys[i], gain=gain, gain_spread=spread, noise=noise)
        self._frame = self.tactile.observe(self.batch, STEP, mask)[SITE]

    def _advance(self, actions: NDArray[Any], running: Mask) -> tuple[Array, Mask, Mask]:
        self._targets(actions.astype(np.float64) * self.speeds)
        self._push()
        self.batch.step(nstep=self._substeps)
        self._frame = self.tactile.observe(self.batch, STEP)[SITE]
        force = self._frame.ground_truth.total_force
        np.maximum(self._peak_force, force, out=self._peak_force)
        self._force_sum += force
        self._lost = np.where(force > 0, 0, self._lost + 1)
        self._elapsed += 1
        outcome = self._judge()
        terminated = running & (outcome.terminated | (self._lost > self.max_lost_steps))
        truncated = running & ~terminated & (self._elapsed >= self.max_episode_steps)
        self._success = outcome.success & (terminated | truncated)
        return outcome.reward, terminated, truncated

    def _observe(self) -> Any:
        values = {name: self._value(name) for name in self._names}
        return values if self._is_dict else values[self._names[0]]

    def _value(self, name: str) -> NDArray[Any]:
        if name == "goal":
            return self._goal().astype(np.float32)
        if name == "proprioception":
            return np.concatenate((self.batch.qpos[:, self._joints], self.batch.ctrl), axis=1).astype(np.float32)
        if name == "shear_image" and not self.shear:
            return np.zeros((self.num_envs, *self._frame.tactile_image.shape[1:], 2), np.float32)
        return observed.tactile(name, self._frame)

    def _info(self) -> dict[str, NDArray[Any]]:
        return {
            "episode_key": self._keys.copy(),
            "success": self._success.copy(),
            "contact": self._frame.ground_truth.total_force > 0,
            "peak_force": self._peak_force.copy(),
            "mean_force": (self._force_sum / np.maximum(self._elapsed, 1)).astype(np.float32),
            **self._metrics(),
        }

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Picture (height, width, 3) of the tactile image of each environment; None without `render_mode`, and before the first reset()."""
        self._check_usable()
        if self.render_mode is None or self._ended is None:
            return None
        return tuple(self._pictures.draw(self._frame.tactile_image.reshape(self.num_envs, -1)))

    def close_extras(self, **kwargs: Any) -> None:
        """Releases the device memory, once no live array is left."""
        del self.tactile, self.batch


def _stiffness(sensor: Sensor) -> float:
    law = sensor.skin.law
    assert isinstance(law, Winkler)  # of the sensors of CONDITION_OF
    return law.normal_contact_stiffness


def rotated(vectors: Array, angles: Array) -> Array:
    """Vectors (N, 2), turned by angles (N), rad."""
    cos, sin = each(math.cos, angles), each(math.sin, angles)
    return np.column_stack((cos * vectors[:, 0] - sin * vectors[:, 1], sin * vectors[:, 0] + cos * vectors[:, 1]))
