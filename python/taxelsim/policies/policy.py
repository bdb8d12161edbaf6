"""A policy, and its calls from the scheduler of evaluate() and generate()."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_actions
from .._core import OutputOptions, Scene
from .._log import warn_once
from ..environment import EnvironmentLayout, frame_of
from ..errors import InputError
from ..grasps import GraspLayout, grasp_frame_of
from .actions import ActionMap
from .batching import independent_of_batch
from .observations import AnyFrame, Layout, ObservationBuilder, outputs_of
from .onnx import OnnxPolicy


@dataclass(frozen=True)
class Policy:
    """A function of a batch of observations, and what it observes and commands.

    The function gets the observation of all instances whose control tick is due. It returns their actions (num_due, len(actions)): floating
    point, clipped to [-1, 1]. An exception that it raises ends the run and continues in the caller.
    """

    function: Callable[[Any], Any]
    """(observation) -> actions."""
    name: str = "policy"
    """Name in results; other than those of the scene's controllers."""
    identity: str = ""
    """Identity that a data set stores, such as the SHA-256 of a file. Required by generate()."""
    observations: str | Sequence[str] = "contact"
    """See taxelsim.policies.observations; the same for the next three."""
    image_unit: str = "counts"
    normalized: bool = False
    history: int = 1
    action: str | None = None
    """Actions command the "twist" of the sensor, or "joint_velocities" or "joint_positions" of a robot with joints. Default: "twist",
    in a scene of kind grasp "joint_velocities"."""
    actions: str | Sequence[str] | None = None
    """Components that the policy commands, out of taxelsim.policies.ACTIONS or the names of the joints. Default: all."""
    linear_scale: float | None = None
    """m/s at action 1. Default: the limit of the scene's first controller; for joint velocities that of each joint."""
    angular_scale: float | None = None
    """rad/s at action 1, with the same defaults."""
    check_batch: bool = True
    """Whether to check with the first observations that rows do not depend on the batch. False for a policy with memory."""


PolicyLike = Policy | OnnxPolicy | Callable[[Any], Any] | str | os.PathLike[str]


def as_policy(policy: PolicyLike, **changes: Any) -> Policy:
    """A Policy from a callable or from an ONNX file. changes: fields that replace its own; those that are None are ignored."""
    changes = {name: value for name, value in changes.items() if value is not None}
    if isinstance(policy, str | os.PathLike):
        policy = OnnxPolicy(policy)
    if isinstance(policy, OnnxPolicy):
        return Policy(**{"function": policy, "name": policy.name, "identity": policy.identity, **policy.settings, **changes})
    if isinstance(policy, Policy):
        return Policy(**{**vars(policy), **changes})
    if not callable(policy):
        raise InputError(f"policy: {type(policy).__name__} is not allowed: a callable or the name of an ONNX file")
    return Policy(**{"function": policy, "name": getattr(policy, "__name__", "policy"), **changes})


class PolicyCalls:
    """Answers the scheduler's requests for twists or joint velocities."""

    def __init__(self, policy: Policy, scene: Scene) -> None:
        self.policy = policy
        self._scene = scene
        self._actions = ActionMap(scene, policy.action, policy.actions, policy.linear_scale, policy.angular_scale)
        self._function = policy.function
        self._unchecked = policy.check_batch
        self._builders: dict[int, ObservationBuilder] = {}  # by first instance of a slice

    def __call__(self, arrays: Mapping[str, Any], instances: NDArray[np.int32], first_instance: int) -> NDArray[np.float64]:
        """Twists (num_due, 6) or joint velocities (num_due, num_joints) of the `instances` (num_due) of a slice.

        arrays: see frame_of() and grasp_frame_of(); valid during the call only.
        """
        if self._scene.kind == Scene.Kind.GRASP:
            return self._commands(grasp_frame_of(arrays), GraspLayout.of(self._scene), instances, first_instance)
        num_instances, num_sensors = arrays["X_WS"].shape[:2]
        layout = EnvironmentLayout(self._scene.sensor, num_sensors, arrays["joint_positions"].shape[1])
        return self._commands(frame_of(arrays, num_instances, num_sensors), layout, instances, first_instance)

    def checked_policy(self) -> Policy:
        """The policy as it was called: with the outcome of the check of the batch, and with an identity."""
        policy = self.policy
        changes = {"function": self._function, "check_batch": self._unchecked, "identity": policy.identity or policy.name}
        return Policy(**{**vars(policy), **changes})

    @property
    def by_joints(self) -> bool:
        """Whether it answers with joint velocities."""
        return self._actions.by_joints

    @property
    def outputs(self) -> OutputOptions:
        """Optional outputs of the frames that it is called with."""
        return outputs_of(self.policy.observations, self._scene)

    def _commands(self, frame: AnyFrame, layout: Layout, instances: NDArray[np.int32], first_instance: int) -> NDArray[np.float64]:
        if first_instance not in self._builders:
            self._builders[first_instance] = self._builder(layout)
        builder = self._builders[first_instance]
        started = np.zeros(len(frame.frame_numbers), np.bool_)
        started[instances] = frame.frame_numbers[instances] == 0
        builder.update(frame, started, rows=instances)
        observation = builder.observation(instances)
        if self._unchecked:
            self._check_batch(observation)
        found = self._function(observation)

        def name_of(row: int) -> str:
            instance = instances[row]
            return f"episode {frame.episodes[instance]} (instance {first_instance + instance})"

        actions = checked_actions(found, (len(instances), len(self._actions.names)), name_of)
        return self._actions.commands(actions, frame.joint_positions[instances])

    def _builder(self, layout: Layout) -> ObservationBuilder:
        policy = self.policy
        return ObservationBuilder(
            layout, policy.observations, image_unit=policy.image_unit, normalized=policy.normalized, history=policy.history
        )

    def _check_batch(self, observation: Any) -> None:
        self._unchecked = False
        self._function, note = independent_of_batch(self.policy.function, observation)
        if note:
            warn_once(f"{self.policy.name}: {note}")
