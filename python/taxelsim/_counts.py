"""Counts of taxels as newtons."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import Readout

IMAGE_UNITS = ("counts", "newtons")


def newtons_of_counts(readout: Readout) -> npt.NDArray[np.float32]:
    """(saturation + 1): force (N) that reads each count on the nominal curve."""
    return np.array([_core.nominal_force(readout, counts) for counts in range(readout.saturation + 1)], np.float32)


class NewtonImage:
    """Counts that change in place, as newtons that change with update()."""

    def __init__(self, counts: npt.NDArray[np.int32], readout: Readout) -> None:
        self._counts = counts
        self._table = newtons_of_counts(readout)
        self._newtons = np.zeros(counts.shape, np.float32)
        self.array = self._newtons.view()  #: Read-only.
        self.array.flags.writeable = False

    def update(self) -> None:
        """Converts the present counts."""
        np.take(self._table, self._counts, out=self._newtons, mode="clip")  # which needs no buffer
