"""Warnings about inputs of a Simulator that leave its arrays at zero. Only the first frame is checked, so that others cost nothing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ._core import Sensor
from ._log import warn_once
from .frame import Frame

FAR = 1.0
"""m from the taxels; what lies beyond was probably placed in millimetres."""


class FirstFrame:
    """What a Simulator has been given so far."""

    def __init__(self, sensor: Sensor, setter: str) -> None:
        self._sensor = sensor
        self._setter = setter
        self._is_given = self._has_step = False
        self._nearest: float | None = None  # m; None: nothing is near on purpose, all slots are empty

    def given(self, positions: npt.NDArray[np.float64]) -> None:
        """Objects or contact points (K, 3), m, in S, without those of empty slots."""
        self._is_given = True
        self._nearest = None
        if len(positions) == 0:
            return
        taxels = self._sensor.taxel_positions
        beyond = np.maximum(0, np.maximum(taxels.min(0) - positions, positions - taxels.max(0)))
        self._nearest = float(np.linalg.norm(beyond, axis=1).min())

    def step(self) -> None:
        self._has_step = True

    def read(self, frame: Frame) -> bool:
        """Warns of what looks wrong. Returns whether there was a frame."""
        if not self._has_step:
            warn_once("read() before the first step(): all arrays are 0")
        elif not self._is_given:
            warn_once(f"step() before {self._setter}(): nothing touches the sensor, all forces are 0")
        elif self._nearest is not None and self._nearest > FAR and not frame.ground_truth.total_force.any():
            warn_once(
                f"{self._setter}(): what is nearest is {self._nearest:.3g} m from the taxels, nothing touches; "
                "are positions in millimetres? They are in metres"
            )
        return self._has_step
