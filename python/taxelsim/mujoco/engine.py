"""MjData and batches behind one interface, for the two-way coupling."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from .batch import Batch
from .poses import Array


class Engine(ABC):
    """Simulations that take generalized forces besides the caller's own qfrc_applied."""

    @property
    @abstractmethod
    def velocities(self) -> Array:
        """Joint velocities qvel (N, nv)."""

    @abstractmethod
    def accelerations(self, forces: Array) -> Array:
        """Joint accelerations qacc (N, nv) at the present state under further generalized forces (N, nv)."""

    @abstractmethod
    def step(self, forces: Array) -> None:
        """A time step under further generalized forces (N, nv). qfrc_applied is as before afterwards."""


class BatchEngine(Engine):
    """A mujoco.batch.Batch."""

    def __init__(self, batch: Any) -> None:
        self.batch = batch
        self.applied: Array = batch.bind("qfrc_applied")
        self.qvel: Array = batch.bind("qvel")
        self.qacc: Array = batch.bind("qacc")  # before the first call, which would otherwise leave it 0

    @property
    def velocities(self) -> Array:
        return self.qvel

    def accelerations(self, forces: Array) -> Array:
        self._call(forces, self.batch.forward)
        return self.qacc

    def step(self, forces: Array) -> None:
        self._call(forces, self.batch.step)

    def _call(self, forces: Array, function: Any) -> None:
        own = self.applied.copy()
        self.applied += forces
        try:
            function()
        finally:
            self.applied[:] = own


class DataEngine(Engine):
    """Several MjData."""

    def __init__(self, datas: Sequence[Any]) -> None:
        self.datas = datas

    @property
    def velocities(self) -> Array:
        return np.stack([data.qvel for data in self.datas])

    def accelerations(self, forces: Array) -> Array:
        self._call(forces, mujoco.mj_forward)
        return np.stack([data.qacc for data in self.datas])

    def step(self, forces: Array) -> None:
        self._call(forces, mujoco.mj_step)

    def _call(self, forces: Array, function: Any) -> None:
        for data, force in zip(self.datas, forces, strict=True):
            own = data.qfrc_applied.copy()
            data.qfrc_applied += force
            function(data.model, data)
            data.qfrc_applied[:] = own


def engine_of(source: Any) -> Engine:
    """The engine of what Attachment.observe() accepts."""
    if isinstance(source, Batch):
        return BatchEngine(source)
    return DataEngine(source if isinstance(source, Sequence) else [source])
