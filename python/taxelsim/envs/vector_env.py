"""Vector environment of a scene of kind servo with a task, or of kind grasp."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from .. import _core
from .._core import Device, OutputOptions, Scene
from ..device_array import platform_of
from ..environment import Environment
from ..errors import InputError
from ..grasps import GraspEnvironment
from ..pictures import SensorPictures
from ..policies.actions import ActionMap
from ..policies.observations import Bounds, ObservationBuilder, outputs_of
from ..policies.values import TorchValues
from .episodic import EpisodicVectorEnv, Mask
from .judged import judged_task
from .rewards import Reward


class TactileVectorEnv(EpisodicVectorEnv):
    """N episodes of a scene at once; one step is one control tick.

    An episode starts as the scene draws it: object, pose, load, variation of the sensor. It is truncated after the frames of the scene,
    and terminated if contact stays lost for longer than `max_lost_time`.

    scene: file name, or a Scene of kind servo with a task, or of kind grasp. Fingers and arm of a hand then follow the actions alone.
    observations, image_unit, normalized, history, copy: see ObservationBuilder. A name gives an array, a sequence of names a dict.
    action: "twist" of the sensor, or "joint_velocities" or "joint_positions" of a robot with joints. Default: "twist", of a hand
        "joint_velocities".
    actions: components that have an action, out of ACTIONS or the names of the joints; default: all. Action 1 is `linear_scale` m/s or
        `angular_scale` rad/s; default: the limits of the scene's first controller, or the velocity limit of each joint. Positions range
        over the limits of each joint.
    reward: see Reward.
    max_lost_time: s, >= 0; default 0.25, of a hand infinite.
    render_mode: None, or "rgb_array": render() returns a picture of every tactile image, of three-axis taxels with arrows for the shear.
    range: counts of the brightest colour of these pictures; default: the largest so far, beyond noise.
    device: an open Device, or the argument of Device.open().
    backend: library of the tensors that reset() and step() return, see EpisodicVectorEnv.
    memory: where tactile images lie, as for Simulator. With "cuda" all tensors are on that GPU and actions may be, and backend must be
        "torch"; counts and newtons of observations are computed there, and no image visits the host.

    Infos, from ground truth: `episode_key`, `success` (only at the end of an episode), `contact`, `num_losses`, `peak_force` (N),
    `load_reached`, and for each criterion of the task `<measure>_error` (rad, N or m; infinite without contact). Of a hand by finger:
    `contact`, `num_losses`, `peak_force`, `force` and `force_error` (N).
    """

    def __init__(
        self,
        scene: Scene | str | os.PathLike[str],
        num_envs: int = 1,
        *,
        observations: str | Sequence[str] = "contact",
        image_unit: str = "counts",
        normalized: bool = False,
        history: int = 1,
        copy: bool = True,
        action: str | None = None,
        actions: str | Sequence[str] | None = None,
        linear_scale: float | None = None,
        angular_scale: float | None = None,
        reward: Reward | None = None,
        max_lost_time: float | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
        range: float | None = None,
        device: Device | str = "",
        backend: str = "numpy",
        memory: str = "host",
    ) -> None:
        super().__init__(num_envs, autoreset_mode, render_mode, backend)
        if max_lost_time is not None and not (np.isfinite(max_lost_time) and max_lost_time >= 0):
            raise InputError(f"max_lost_time: {max_lost_time} is not allowed: a finite number of at least 0 (s)")
        self.scene = scene if isinstance(scene, Scene) else _core.load_scene(os.fspath(scene))
        self._task = judged_task(self.scene, self.num_envs)
        opened = device if isinstance(device, Device) else Device.open(device)
        images = self._images = self._images_in(memory, opened)
        self._pictures = SensorPictures(self.scene, range) if render_mode is not None else None
        outputs = outputs_of(observations, self.scene)
        if self._pictures is not None and self._pictures.draws_axes:
            outputs = outputs.replace(taxel_counts=True)
        self._environment: Environment | GraspEnvironment | None = _open(opened, self.scene, self.num_envs, outputs, memory)
        self._period, self._num_frames = self._environment.control_period, self._environment.num_frames
        self.step_time = self._period * self._environment.dt
        self.max_episode_steps = -(-(self._num_frames - 1) // self._period)  #: steps of an episode that is not terminated
        layout = self._environment.layout
        self._builder = ObservationBuilder(
            layout, observations, image_unit=image_unit, normalized=normalized, history=history, copy=copy, images=images
        )
        self._actions = ActionMap(self.scene, action, actions, linear_scale, angular_scale)
        self._reward = reward or Reward()
        lost_time = self._task.max_lost_time if max_lost_time is None else max_lost_time
        self._max_lost_steps = np.rint(lost_time / self.step_time)
        self._lost_steps = np.zeros(num_envs, np.int64)
        self.single_observation_space = _space(self._builder.bounds())
        self.num_actions = len(self._actions.names)
        self.single_action_space = spaces.Box(-1, 1, (self.num_actions,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def _images_in(self, memory: str, device: Device) -> TorchValues | None:
        """The operations on images in the memory of a GPU; None: the host has them."""
        if platform_of(memory, device) is None:
            return None
        if self.backend != "torch":
            raise InputError(f"backend: {self.backend!r} is not allowed where memory is {memory!r}: 'torch'")
        images = TorchValues()
        self._convert = images.constant
        return images

    def _on_host(self, actions: Any) -> Any:
        return actions if self._images is None or not hasattr(actions, "cpu") else actions.cpu()

    @property
    def _batch(self) -> Environment | GraspEnvironment:
        if self._environment is None:
            raise RuntimeError("this environment is closed")
        return self._environment

    def _start(self, mask: Mask, keys: NDArray[np.uint64]) -> None:
        self._batch.reset(mask, keys)
        self._frame, self._state = self._batch.observe(), self._batch.task_state()
        self._success = np.zeros(self.num_envs, np.bool_)
        self._builder.update(self._frame, started=mask, rows=mask)
        self._lost_steps[mask] = 0
        self._task.restart(mask)

    def _advance(self, actions: NDArray[Any], running: Mask) -> tuple[NDArray[np.float64], Mask, Mask]:
        num_left = self._num_frames - 1 - self._frame.frame_numbers
        ending = running & (num_left <= self._period)
        forces = self._step(self._actions.commands(actions, self._frame.joint_positions), ending)
        state = self._state
        is_lost = self._task.is_lost(state)
        self._lost_steps = np.where(is_lost, self._lost_steps + 1, 0)
        progress = self._task.progress(state, self.max_episode_steps)
        rewards = self._reward(self._task.errors(self._frame, state), self._task.tolerances, progress, ~is_lost, forces)
        self._success = self._judged(ending)
        return rewards, running & (self._lost_steps > self._max_lost_steps), ending

    def _step(self, commands: NDArray[np.float64], ending: Mask) -> NDArray[np.float64]:
        """Advances by a control period, or to the last frame of the episodes that are `ending`. Returns total forces (num_envs), N."""
        step = self._batch.step_joints if self._actions.by_joints else self._batch.step
        num_last = (self._num_frames - 1) % self._period or self._period  # frames of the last step of an episode
        if num_last == self._period or not ending.any():
            step(commands)
            self._frame, self._state = self._batch.observe(), self._batch.task_state()
            self._builder.update(self._frame)
            return self._forces()
        step(commands, num_last)
        self._frame = self._batch.observe()
        self._builder.update(self._frame, rows=ending)
        self._builder.detach()
        last_forces = self._forces()
        self._batch.advance(self._period - num_last)
        self._frame, self._state = self._batch.observe(), self._batch.task_state()
        self._builder.update(self._frame, rows=~ending, kept=ending)
        return np.where(ending, last_forces, self._forces())

    def _judged(self, ended: Mask) -> Mask:
        success = np.zeros(self.num_envs, np.bool_)
        if ended.any():
            success[ended] = self._batch.judge(np.flatnonzero(ended))["success"]
        return success

    def _forces(self) -> NDArray[np.float64]:
        return self._task.forces(self._frame, self._state)

    def _observe(self) -> Any:
        return self._builder.observation()

    def _info(self) -> dict[str, NDArray[Any]]:
        info: dict[str, NDArray[Any]] = {"episode_key": self._keys.copy(), "success": self._success.copy()}
        return {**info, **self._task.info(self._frame, self._state)}

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Picture (height, width, 3) of the tactile image of each environment; None without `render_mode`, and before the first reset()."""
        self._check_usable()
        if self._pictures is None or self._ended is None:
            return None
        return tuple(self._pictures.draw(self._frame))

    def close_extras(self, **kwargs: Any) -> None:
        """Releases the device memory, once no live array is left."""
        self._environment = None


def _open(device: Device, scene: Scene, num_envs: int, outputs: OutputOptions, memory: str) -> Environment | GraspEnvironment:
    if scene.kind != Scene.Kind.GRASP:
        return Environment(device, scene, num_envs, outputs=outputs, memory=memory)
    if platform_of(memory, device) is not None:
        raise InputError(f"memory: {memory!r} is not allowed for a scene of kind grasp: 'host'")
    return GraspEnvironment(device, scene, num_envs, outputs=outputs)


def _space(bounds: Bounds | dict[str, Bounds]) -> spaces.Space[Any]:
    if isinstance(bounds, dict):
        return spaces.Dict({name: _box(value) for name, value in bounds.items()})
    return _box(bounds)


def _box(bounds: Bounds) -> spaces.Box:
    return spaces.Box(bounds.low, bounds.high, dtype=bounds.low.dtype.type)
