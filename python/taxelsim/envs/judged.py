"""The task of a scene as an environment needs it: errors of the reward, progress, lost contacts, infos."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .._core import TASK_MEASURES, Scene
from ..environment import EnvironmentFrame, Task, TaskState
from ..grasps import GraspFrame, GraspState, GraspTask

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class JudgedTask(Protocol):
    """Reads a task from the frame and the task state of a batch of N episodes."""

    max_lost_time: float  #: s, default: contact may stay lost for so long.
    tolerances: Array  #: (measures); NaN without a criterion.

    def errors(self, frame: Any, state: Any) -> Array:
        """Errors (N, measures), in the units of `tolerances`."""

    def is_lost(self, state: Any) -> Mask:
        """Whether contact is lost, (N)."""

    def forces(self, frame: Any, state: Any) -> Array:
        """Total force that the reward limits, (N), N."""

    def progress(self, state: Any, num_steps: int) -> Array:
        """Advance (N) since the preceding call over the one that completes the task in num_steps calls; 1 without such a demand."""

    def restart(self, mask: Mask) -> None:
        """Episodes of the environments in `mask` (N) begin."""

    def info(self, frame: Any, state: Any) -> dict[str, NDArray[Any]]:
        """Infos, (N, ...) each."""


class ServoTask:
    """The task of a scene of kind servo."""

    max_lost_time = 0.25

    def __init__(self, scene: Scene, num_envs: int) -> None:
        self._task = Task.of(scene)
        self._advanced = np.zeros(num_envs, np.float32)
        self.tolerances = np.array([self._task.tolerances.get(name, np.nan) for name in TASK_MEASURES])

    def errors(self, frame: EnvironmentFrame, state: TaskState) -> Array:
        """Returns the errors by TASK_MEASURES."""
        return state.errors

    def is_lost(self, state: TaskState) -> Mask:
        """Tests whether the sensor touches nothing."""
        return ~state.contact.astype(np.bool_)

    def forces(self, frame: EnvironmentFrame, state: TaskState) -> Array:
        """Returns the clean total force of sensor 0."""
        forces = frame.ground_truth.total_force
        return (forces if forces.ndim == 1 else forces[:, 0]).astype(np.float64)

    def progress(self, state: TaskState, num_steps: int) -> Array:
        """Compares the advance in `laps` or `travel` with the required one."""
        required = self._task.laps or self._task.travel
        if not required:
            return np.ones(len(self._advanced))
        advanced = (state.laps if self._task.laps else state.travel).copy()
        progress: Array = (advanced - self._advanced).astype(np.float64) * (num_steps / required)
        self._advanced = advanced
        return progress

    def restart(self, mask: Mask) -> None:
        """Sets the advance to 0."""
        self._advanced[mask] = 0

    def info(self, frame: EnvironmentFrame, state: TaskState) -> dict[str, NDArray[Any]]:
        """Returns contact, forces and errors."""
        info: dict[str, NDArray[Any]] = {
            "contact": state.contact.astype(np.bool_),
            "num_losses": state.num_losses.copy(),
            "peak_force": state.peak_force.copy(),
            "load_reached": frame.load_reached.astype(np.bool_),
        }
        for name in self._task.tolerances:
            info[f"{name}_error"] = state.errors[:, TASK_MEASURES.index(name)].copy()
        return info


class HandTask:
    """The task of a scene of kind grasp: each finger is a criterion. Its error is a multiple of its tolerance."""

    max_lost_time = np.inf

    def __init__(self, scene: Scene, num_envs: int) -> None:
        self._task = GraspTask.of(scene)
        self.tolerances = np.ones(len(self._task.fingers))
        self._num_envs = num_envs

    def errors(self, frame: GraspFrame, state: GraspState) -> Array:
        """Returns |F - F*| / (tolerance F*) of each finger."""
        errors: Array = np.abs(state.forces - frame.target_forces) / (self._task.tolerance * frame.target_forces)
        return errors

    def is_lost(self, state: GraspState) -> Mask:
        """Tests whether a finger has touched, and touches no longer."""
        lost: Mask = (state.were_in_contact & (state.forces == 0)).any(axis=1)
        return lost

    def forces(self, frame: GraspFrame, state: GraspState) -> Array:
        """Returns the largest clean total force of a finger."""
        largest: Array = state.forces.max(axis=1)
        return largest

    def progress(self, state: GraspState, num_steps: int) -> Array:
        """Returns 1: a grasp has no advance."""
        return np.ones(self._num_envs)

    def restart(self, mask: Mask) -> None:
        """Does nothing: this task keeps no state."""

    def info(self, frame: GraspFrame, state: GraspState) -> dict[str, NDArray[Any]]:
        """Returns contact, forces and errors of each finger."""
        return {
            "contact": state.forces > 0,
            "num_losses": state.num_losses.copy(),
            "peak_force": state.peak_forces.copy(),
            "force": state.forces.copy(),
            "force_error": np.abs(state.forces - frame.target_forces),
        }


def judged_task(scene: Scene, num_envs: int) -> JudgedTask:
    """The task of the scene. Raises InputError if it has none."""
    return HandTask(scene, num_envs) if scene.kind == Scene.Kind.GRASP else ServoTask(scene, num_envs)
