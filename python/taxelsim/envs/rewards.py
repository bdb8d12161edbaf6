"""Reward of a step, from the errors of the scene's task."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_positive
from ..errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reward:
    """Parameters of the reward.

    With the errors e_m of the task's criteria and their tolerances t_m:

        tracking = mean over m and widths w of exp(-(e_m / (w t_m))^2)  0 without contact
        progress = clip(advance / required advance per step, 0, 1)      1 for tasks without `travel` and `laps`
        reward   = tracking (1 + progress) / 2 - lost_penalty [no contact] - force_penalty max(0, total force / force_limit - 1)

    `advance` is the path length, or the part of the lap, since the preceding step; the required one completes the
    task's `travel` or `laps` at the end of the episode. A reward is at most 1.
    """

    lost_penalty: float = 1.0  #: Per step without contact.
    force_penalty: float = 0.1  #: Per step and relative excess of the force.
    force_limit: float = 10.0  #: N, clean total force above which the excess counts.
    widths: tuple[float, ...] = (1.0,)  #: In tolerances. Wider ones reward progress far from the tolerance, where the narrow one is flat.

    def __post_init__(self) -> None:
        checked_positive("reward.force_limit", self.force_limit)
        for name in ("lost_penalty", "force_penalty"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError(f"reward.{name}: {value} is not allowed: a finite number of at least 0")
        if not self.widths:
            raise InputError("reward.widths: empty, at least one width allowed")
        for width in self.widths:
            checked_positive("reward.widths", width)

    def __call__(self, errors: Array, tolerances: Array, progress: Array, contact: NDArray[np.bool_], force: Array) -> Array:
        """Rewards (N). `errors` (N, measures) and `tolerances` (measures), NaN without a criterion; infinite errors count 0."""
        judged = np.isfinite(tolerances)
        with np.errstate(over="ignore"):
            relative = errors[:, judged, np.newaxis] / np.multiply.outer(tolerances[judged], self.widths)
            tracking = np.exp(-np.square(relative)).mean((-2, -1)) if judged.any() else np.ones(len(errors))
        excess = np.maximum(0, force / self.force_limit - 1)
        reward = np.where(contact, tracking, 0) * (1 + np.clip(progress, 0, 1)) / 2
        result: Array = reward - self.lost_penalty * ~contact - self.force_penalty * excess
        return result
