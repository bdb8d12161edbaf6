"""Active touch: a policy chooses where to touch, and says which object it is. After the protocol of Tactile-MNIST."""

from __future__ import annotations

import math
from os import PathLike
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from .._arguments import checked_count, checked_names, checked_positive
from .._core import Device, Model, OutputOptions, Scene, load_scene
from ..errors import InputError
from ..frame import Frame
from ..inputs import NO_OBJECT
from ..pictures import TactilePictures, noise_of
from ..program import SCENES
from ..simulator import Simulator
from .draws import each, uniform_numbers
from .env import EpisodicEnv
from .episodic import EpisodicVectorEnv, Mask

Array = NDArray[np.float64]

#: Observations of a touch.
TOUCH_OBSERVATIONS = ("tactile_image", "contact")

_LOGIT_SCALE = 10.0  # logit of a class at action 1
_STEP_TIME = 0.5  # s: the sensor is lifted, then pressed, for this long each
_PLACEMENT = 0.004  # m, largest offset of an object from the middle of the workspace, along x and y
_FIXED = ("stiffness", "friction", "trigger", "hysteresis", "delay", "psf_width", "trigger_spread")  # ranges that touches do not draw


class TouchClassifyVectorEnv(EpisodicVectorEnv):
    """N objects, each touched `num_touches` times per episode; one step is one touch.

    An episode draws an object of the scene and its planar pose: an offset of at most 4 mm along x and y, any yaw. Its load, gain,
    gain spread and noise are drawn from the scene's `randomization`. All are functions of the episode key alone.

    Action, (3 + K) in [-1, 1] for K objects: x and y of the sensor over the object, in units of `workspace` m; its yaw, in units of pi;
    then a logit per class, in units of 10. The sensor is lifted, moved, and pressed on until it carries the load. Where it misses the
    object, it reports no contact.

    Observation, a dict: `tactile_image` (rows, cols), counts, or `contact` (3): centre of pressure x, y in S, m, and force, N;
    `touch` (3): x, y and yaw of the last touch as in the action; `touches_left` (1): part of the touches that are left. Before the first
    touch all but `touches_left` are 0.

    With p_t(c), the softmax of the logits of touch t, and p_0(c) = 1 / K, the reward of touch t for an object of class c is

        reward = log p_t(c) - log p_(t-1)(c)

    The sum over an episode is log p_T(c) + log K: 0 for a policy that does not know, log K for one that is sure and right.

    The episode is terminated by its last touch. It is a success if the largest logit of that touch is that of the object; of equal logits
    the first counts.

    Infos: `episode_key`, `label`, `success` (False before the last touch), `peak_force` (N, largest true force of the episode), `contact`.

    - `scene`: a scene of kind `contacts`, or its file. Default: `scenes/benchmark/touch_classify.yaml`.
    - `condition`: of that file: "nominal", "randomized" or "unseen".
    - `workspace`: m, half of the range of the sensor's middle along x and y.
    - `render_mode="rgb_array"`: `render()` returns a picture of every tactile image, of three-axis taxels with arrows for the shear.
    - `range`: counts of the brightest colour of these pictures. Default: the largest so far, beyond noise.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        scene: Scene | str | PathLike[str] = SCENES / "benchmark/touch_classify.yaml",
        condition: str = "nominal",
        observation: str = "tactile_image",
        num_touches: int = 16,
        workspace: float = 0.02,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
        range: float | None = None,
        device: Device | str = "",
        backend: str = "numpy",
    ) -> None:
        super().__init__(num_envs, autoreset_mode, render_mode, backend)
        self.step_time = 2 * _STEP_TIME
        (self._observation,) = checked_names("observation", observation, TOUCH_OBSERVATIONS)
        self.num_touches = checked_count("num_touches", num_touches)
        self.workspace = checked_positive("workspace", workspace)
        self.scene = scene if isinstance(scene, Scene) else load_scene(scene, condition=condition)
        self._ranges = self.scene.randomization
        if "load" not in self._ranges:
            raise InputError(f"{self.scene.file}: randomization: depth found, a touch needs a load")
        for name in self._ranges:
            if name in _FIXED or name.startswith("mounting_"):
                raise InputError(
                    f"{self.scene.file}: randomization.{name}: this environment touches with the sensor's own skin and mounting"
                )
        device = device if isinstance(device, Device) else Device.open(device)
        self._model = Model(device, self.scene.sensor, self.scene.objects)
        if len(self.scene.sensor.patches) != 1:
            raise InputError(f"{self.scene.file}: sensor: {len(self.scene.sensor.patches)} patches are not allowed: one grid")
        draws_axes = render_mode is not None and self.scene.sensor.readout.three_axis is not None
        outputs = OutputOptions(penetration_depth=False, taxel_counts=draws_axes)
        self._simulator = Simulator(self._model, num_envs, outputs=outputs)
        self._pictures = TactilePictures(self.scene.sensor, range, noise_of(self.scene))
        self.class_names = tuple(item.name for item in self.scene.objects)
        self._allocate()
        self._shown = np.zeros((*self._images.shape, 3), np.int32) if draws_axes else self._images  #: That pictures show.
        self._make_spaces()

    @property
    def num_classes(self) -> int:
        """K: objects of the scene."""
        return len(self.class_names)

    def _allocate(self) -> None:
        num_envs, patch = self.num_envs, self.scene.sensor.patches[0]
        self._labels = np.zeros(num_envs, np.int32)
        self._object_poses = np.zeros((num_envs, 3))  # x, y, m, and yaw, rad, in the frame of the workspace
        self._loads = np.zeros(num_envs, np.float32)
        self._touches = np.zeros(num_envs, np.int64)
        self._log_likelihoods = np.zeros(num_envs)
        self._last_touches = np.zeros((num_envs, 3), np.float32)
        self._images = np.zeros((num_envs, patch.num_rows, patch.num_cols), np.int32)
        self._contacts = np.zeros((num_envs, 3), np.float32)
        self._in_contact = np.zeros(num_envs, np.bool_)
        self._successes = np.zeros(num_envs, np.bool_)
        self._peak_forces = np.zeros(num_envs, np.float32)

    def _make_spaces(self) -> None:
        reading = (
            spaces.Box(0, self.scene.sensor.readout.saturation, self._images.shape[1:], np.int32)
            if self._observation == "tactile_image"
            else spaces.Box(-np.inf, np.inf, (3,), np.float32)
        )
        self.single_observation_space = spaces.Dict(
            {
                self._observation: reading,
                "touch": spaces.Box(-1, 1, (3,), np.float32),
                "touches_left": spaces.Box(0, 1, (1,), np.float32),
            }
        )
        self.single_action_space = spaces.Box(-1, 1, (3 + self.num_classes,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def _start(self, mask: Mask, keys: NDArray[np.uint64]) -> None:
        numbers = uniform_numbers(keys, 8)
        self._labels[mask] = (numbers[mask, 0] * self.num_classes).astype(np.int32)
        offsets = (2 * numbers[:, 1:3] - 1) * _PLACEMENT
        self._object_poses[mask] = np.column_stack((offsets, 2 * np.pi * numbers[:, 3]))[mask]
        self._loads[mask] = self._drawn("load", numbers[:, 4])[mask]
        gains, spreads, noises = (self._drawn(name, numbers[:, k]) for name, k in (("gain", 5), ("gain_spread", 6), ("noise", 7)))
        for i in np.flatnonzero(mask):
            variation = {"gain": float(gains[i]), "gain_spread": float(spreads[i]), "noise": float(noises[i])}
            self._simulator.reset(i, keys[i], **variation)
        self._log_likelihoods[mask] = -math.log(self.num_classes)
        states: list[NDArray[Any]] = [self._touches, self._last_touches, self._images, self._contacts]
        states += [self._shown, self._in_contact, self._successes, self._peak_forces]
        for state in states:
            state[mask] = 0

    def _drawn(self, name: str, numbers: Array) -> Array:
        low, high = self._ranges[name]
        return low + (high - low) * numbers

    def _advance(self, actions: NDArray[Any], running: Mask) -> tuple[Array, Mask, Mask]:
        touches = actions[:, :3].astype(np.float64)
        frame = self._press(touches)
        self._last_touches[:] = touches
        self._images[:] = frame.tactile_image
        if self._shown is not self._images:
            self._shown[:] = frame.taxel_counts
        self._contacts[:, :2] = frame.center_of_pressure[:, :2]
        self._contacts[:, 2] = frame.total_force
        self._in_contact[:] = frame.ground_truth.total_force > 0
        np.maximum(self._peak_forces, frame.ground_truth.total_force, out=self._peak_forces)
        self._touches += 1
        logits = _LOGIT_SCALE * actions[:, 3:].astype(np.float64)
        likelihoods = _log_softmax(logits)[np.arange(self.num_envs), self._labels]
        rewards = likelihoods - self._log_likelihoods
        self._log_likelihoods = likelihoods
        terminated = (self._touches >= self.num_touches) & running
        self._successes[:] = terminated & (logits.argmax(1) == self._labels)
        return rewards, terminated, np.zeros(self.num_envs, np.bool_)

    def _press(self, touches: Array) -> Frame:
        """The frame of the sensors at `touches`, after a frame without contact, which lets hysteresis and low-pass recover."""
        poses = self._poses_in_sensor(touches)
        self._simulator.set_objects(NO_OBJECT, poses)
        self._simulator.set_loads(None)
        self._simulator.step(_STEP_TIME)
        self._simulator.read()
        self._simulator.set_objects(self._labels, poses)
        self._simulator.set_loads(self._loads)
        self._simulator.step(_STEP_TIME)
        return self._simulator.read()

    def _poses_in_sensor(self, touches: Array) -> Array:
        """Poses X_SO (N, 7). z is 0: the load search finds it."""
        yaws = math.pi * touches[:, 2]
        cos, sin = each(math.cos, yaws), each(math.sin, yaws)
        x, y = (self._object_poses[:, :2] - self.workspace * touches[:, :2]).T
        half = (self._object_poses[:, 2] - yaws) / 2
        zero = np.zeros(self.num_envs)
        return np.column_stack((cos * x + sin * y, cos * y - sin * x, zero, each(math.cos, half), zero, zero, each(math.sin, half)))

    def _observe(self) -> dict[str, NDArray[Any]]:
        reading = self._images if self._observation == "tactile_image" else self._contacts
        left = (1 - self._touches / self.num_touches).astype(np.float32)
        return {self._observation: reading.copy(), "touch": self._last_touches.copy(), "touches_left": left[:, None]}

    def _info(self) -> dict[str, NDArray[Any]]:
        return {
            "episode_key": self._keys.copy(),
            "label": self._labels.copy(),
            "success": self._successes.copy(),
            "peak_force": self._peak_forces.copy(),
            "contact": self._in_contact.copy(),
        }

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Picture (height, width, 3) of the tactile image of each environment; None without `render_mode`."""
        self._check_usable()
        if self.render_mode is None or self._ended is None:
            return None
        axes = self._shown.shape[3:]
        return tuple(self._pictures.draw(self._shown.reshape(self.num_envs, self.scene.sensor.num_taxels, *axes)))

    def close_extras(self, **kwargs: Any) -> None:
        """Releases the device memory."""
        del self._simulator


def _log_softmax(logits: Array) -> Array:
    shifted = logits - logits.max(1, keepdims=True)
    terms = each(math.exp, shifted)
    total = terms[:, 0].copy()
    for column in range(1, logits.shape[1]):  # a fixed order of the sum
        total += terms[:, column]
    result: Array = shifted - each(math.log, total)[:, None]
    return result


def make_env(**kwargs: Any) -> EpisodicEnv:
    """One environment. `kwargs`: of TouchClassifyVectorEnv."""
    return EpisodicEnv(TouchClassifyVectorEnv(1, autoreset_mode=AutoresetMode.DISABLED, **kwargs))


make_vec = TouchClassifyVectorEnv
