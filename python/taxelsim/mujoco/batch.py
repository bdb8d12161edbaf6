"""The Batch of MuJoCo 4, and the part of it that poses need under MuJoCo 3, which has none."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._arrays import product

STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)
"""Components of a row of the state of a batch."""


class DataBatch:
    """Poses of `nsim` simulations under MuJoCo 3, computed one after the other in one MjData. Members as of Batch."""

    def __init__(self, model: Any, nsim: int) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        self.state: NDArray[np.float64] = np.zeros((nsim, mujoco.mj_stateSize(model, STATE)))
        self._bound: dict[str, NDArray[np.float64]] = {}

    def bind(self, name: str) -> NDArray[np.float64]:
        """Array (nsim, ...) of a field that mj_kinematics() computes, or site_xquat or geom_xquat. forward() writes it."""
        return self._bound.setdefault(name, np.zeros((len(self.state), *self._value(name).shape)))

    def forward(self, stage: int) -> None:
        """Computes the poses, which are all of the stage that Kinematics asks for."""
        for row, state in enumerate(self.state):
            mujoco.mj_setState(self._model, self._data, state, STATE)
            mujoco.mj_kinematics(self._model, self._data)
            for name, values in self._bound.items():
                values[row] = self._value(name)

    def _value(self, name: str) -> NDArray[np.float64]:
        kind, _, field = name.rpartition("_")
        if field != "xquat":
            return np.asarray(getattr(self._data, name))
        bodies, turn = (getattr(self._model, f"{kind}_{each}") for each in ("bodyid", "quat"))
        return product(self._data.xquat[bodies], turn)


try:
    from mujoco.batch import Batch as Batch
except ImportError:
    Batch = DataBatch


def require_batch(user: str) -> None:
    """Raises ImportError under MuJoCo 3. user: what steps a Batch, for the message."""
    if Batch is DataBatch:
        raise ImportError(f"{user} needs MuJoCo 4, {mujoco.__version__} found: pip install 'mujoco>=4,<5'")
