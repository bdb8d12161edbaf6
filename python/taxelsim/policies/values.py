"""The operations of observations: on arrays of NumPy, and on tensors in the memory of a GPU."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray


class NumpyValues:
    """Arrays of NumPy."""

    def live(self, array: Any) -> Any:
        """An array of a frame, whose memory the next step changes."""
        return array

    def constant(self, array: NDArray[Any]) -> Any:
        """An array that does not change."""
        return array

    def entries(self, table: NDArray[Any], indices: Any) -> Any:
        """The entries of a table that stays."""
        return table[indices]

    def scaled(self, values: Any, scale: Any) -> Any:
        """`values` over `scale`, float32."""
        return np.divide(values, scale, dtype=np.float32)

    def zeros(self, shape: tuple[int, ...], like: Any) -> Any:
        """Zeros of the type of `like`."""
        return np.zeros(shape, like.dtype)

    def where(self, rows: NDArray[np.bool_], values: Any, others: Any) -> Any:
        """`values` in these rows, `others` elsewhere."""
        return np.where(self.rows(rows).reshape(-1, *[1] * (values.ndim - 1)), values, others)

    def rows(self, rows: Any) -> Any:
        """An index of rows: a mask, numbers or a slice."""
        return rows

    def copy(self, values: Any) -> Any:
        """A copy."""
        return values.copy()


class TorchValues(NumpyValues):
    """Tensors of PyTorch where the array of a frame lies. The numbers are those of NumPy."""

    def __init__(self) -> None:
        self._torch = importlib.import_module("torch")
        self._tables: dict[int, Any] = {}
        self.device: Any = None  #: of the tensors, from the first frame on

    def live(self, array: Any) -> Any:
        tensor = self._torch.from_dlpack(array)
        self.device = tensor.device
        return tensor

    def constant(self, array: NDArray[Any]) -> Any:
        return self._torch.from_numpy(np.asarray(array)).to(self.device)

    def entries(self, table: NDArray[Any], indices: Any) -> Any:
        if id(table) not in self._tables:
            self._tables[id(table)] = self.constant(table)
        return self._tables[id(table)][indices.long()]

    def scaled(self, values: Any, scale: Any) -> Any:
        # A tensor of one number on the GPU: by a number of the host PyTorch multiplies by the rounded reciprocal.
        return values.to(self._torch.float32) / self.constant(scale)

    def zeros(self, shape: tuple[int, ...], like: Any) -> Any:
        return like.new_zeros(shape)

    def where(self, rows: NDArray[np.bool_], values: Any, others: Any) -> Any:
        return self._torch.where(self.rows(rows).reshape(-1, *[1] * (values.ndim - 1)), values, others)

    def rows(self, rows: Any) -> Any:
        return rows if isinstance(rows, slice) else self.constant(rows)

    def copy(self, values: Any) -> Any:
        return values.clone()
