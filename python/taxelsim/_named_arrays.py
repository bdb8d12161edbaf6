"""Base of the classes of taxelsim.frame: named arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import numpy.typing as npt

from ._tensors import converted, converter

if TYPE_CHECKING:
    from typing_extensions import Self

FloatArray = npt.NDArray[np.float32]
IntArray = npt.NDArray[np.int32]
BoolArray = npt.NDArray[np.bool_]


class Arrays:
    """Named arrays as attributes. Arrays that were not requested are missing."""

    __slots__ = ("__dict__", "__weakref__", "_absent")

    _absent: Mapping[str, str]
    _nested: ClassVar[Mapping[str, type[Arrays]]] = {}
    _requests: ClassVar[Mapping[str, str]] = {}  # field of OutputOptions by attribute

    def __init__(self, arrays: Mapping[str, Any], absent: Mapping[str, str] | None = None) -> None:
        """absent: why there are no arrays of these names."""
        object.__setattr__(self, "_absent", absent or {})
        for name, value in arrays.items():
            object.__setattr__(self, name, self._nested[name](value) if isinstance(value, Mapping) else value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} is read-only")

    def __getattr__(self, name: str) -> Any:
        if name in self._absent:
            raise AttributeError(f"{type(self).__name__} has no {name}: {self._absent[name]}")
        if name in self._requests:
            raise AttributeError(f"{name} was not requested: Simulator(..., outputs=OutputOptions({self._requests[name]}=True))")
        raise AttributeError(f"{type(self).__name__} has no attribute {name}; it has {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        """Names of the arrays and of the nested groups."""
        return iter(vars(self))

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)

    def __contains__(self, name: str) -> bool:
        return name in vars(self)

    def as_dict(self) -> dict[str, Any]:
        """The arrays by name; groups are dicts."""
        return {name: value.as_dict() if isinstance(value, Arrays) else value for name, value in vars(self).items()}

    def copy(self) -> Self:
        """The same arrays, copied: they do not change when the simulator steps."""
        return type(self)(_copied(self.as_dict()), self._absent)

    def tensors(self, library: str = "torch") -> Self:
        """The same arrays under the same names as tensors of "torch", "jax", "warp" or "numpy", on the CPU.

        They share the memory of the arrays, keep it alive, and show newer numbers after a step; do not write to them. JAX takes arrays for
        constant and copies those that do not begin at a multiple of 64 bytes: call this again after each step. Raises InputError for
        another name, ImportError if the library is not installed.
        """
        return type(self)(converted(self.as_dict(), converter(library)), self._absent)

    def __reduce__(self) -> tuple[type[Self], tuple[dict[str, Any], Mapping[str, str]]]:
        return type(self), (self.as_dict(), self._absent)

    def __repr__(self) -> str:
        parts = (f"{name}{value.shape}" if hasattr(value, "shape") else name for name, value in vars(self).items())
        return f"<taxelsim.{type(self).__name__}: {', '.join(parts)}>"


def _copied(arrays: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _copied(value) if isinstance(value, Mapping) else value.copy() for name, value in arrays.items()}
