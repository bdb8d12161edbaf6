"""Arrays as tensors of other libraries, without a copy where that library can share the memory."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from . import _core
from ._arguments import checked_names
from .device_array import DeviceArray

Convert = Callable[[Any], Any]


def _is_writable(array: Any) -> bool:
    return isinstance(array, np.ndarray) and array.flags.writeable


def _shareable(array: Any) -> Any:
    """An array as an object of DLPack that every library takes."""
    return _core.dlpack(array) if isinstance(array, np.ndarray) else array


def _torch() -> Convert:
    torch = importlib.import_module("torch")

    def convert(array: Any) -> Any:
        return torch.from_numpy(array) if _is_writable(array) else torch.from_dlpack(_shareable(array))

    return convert


def _jax() -> Convert:
    from_dlpack = importlib.import_module("jax").dlpack.from_dlpack
    return lambda array: from_dlpack(_shareable(array))


def _warp() -> Convert:
    warp = importlib.import_module("warp")
    warp.init()
    return lambda array: warp.from_dlpack(_shareable(array))


_MAKERS: Mapping[str, Callable[[], Convert]] = {"numpy": lambda: lambda array: array, "torch": _torch, "jax": _jax, "warp": _warp}
LIBRARIES = tuple(_MAKERS)
"""Names of the libraries."""


def converter(library: str) -> Convert:
    """A function from NumPy arrays to tensors of a library. Raises InputError for another name, ImportError if it is not installed."""
    (name,) = checked_names("library", library, LIBRARIES)
    return _MAKERS[name]()


def converted(value: Any, convert: Convert) -> Any:
    """`value` with its arrays converted: an array, or a dict of values. Arrays of Python objects stay arrays of converted values."""
    if isinstance(value, Mapping):
        return {name: converted(part, convert) for name, part in value.items()}
    if isinstance(value, np.ndarray) and value.dtype == object:
        parts = np.empty_like(value)
        for i, part in enumerate(value):
            parts[i] = None if part is None else converted(part, convert)
        return parts
    return convert(value) if isinstance(value, (np.ndarray, DeviceArray)) else value
