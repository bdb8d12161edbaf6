"""Actions in [-1, 1] to twists of the sensor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_names, checked_positive

ACTIONS = ("v_x", "v_y", "v_z", "w_x", "w_y", "w_z")
"""Components of the twist of sensor 0 in its own frame S: linear velocity of its origin (m/s), then angular velocity (rad/s)."""


class TwistActions:
    """Maps actions (N, len(names)) in [-1, 1] to twists (N, 6). Components without an action are 0.

    linear_scale, angular_scale: the components at action 1, m/s and rad/s, > 0.
    """

    def __init__(self, names: str | Sequence[str], linear_scale: float, angular_scale: float) -> None:
        self.names = checked_names("actions", names, ACTIONS)
        checked_positive("linear_scale", linear_scale)
        checked_positive("angular_scale", angular_scale)
        self._columns = np.array([ACTIONS.index(name) for name in self.names])
        self._scales = np.where(self._columns < 3, float(linear_scale), float(angular_scale))

    @property
    def scales(self) -> NDArray[np.float64]:
        """(len(names)): m/s or rad/s of each component at action 1."""
        scales: NDArray[np.float64] = self._scales.copy()
        return scales

    def twists(self, actions: NDArray[Any]) -> NDArray[np.float64]:
        """Twists (N, 6) in S, m/s and rad/s, of actions (N, len(names)) that are finite and in [-1, 1]."""
        twists = np.zeros((len(actions), len(ACTIONS)))
        twists[:, self._columns] = actions * self._scales
        return twists
