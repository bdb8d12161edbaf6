"""Arrays in the memory of a GPU."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked_names
from .errors import InputError

_LEGACY_DEFAULT_STREAM = 1  # DLPack's number of it, for CUDA
_NO_STREAM = -1


MEMORIES = ("host", "device", "cuda", "hip")
"""Where arrays can lie: with NumPy; "device": with the device, which for software Vulkan is the host; CUDA; HIP."""

Batch = _core.Simulator | _core.Environment


def platform_of(memory: str, device: _core.Device, image_unit: str = "counts") -> _core.Platform | None:
    """The interface of the GPU that has the arrays; None: the host has them.

    Raises InputError for a name that is not in MEMORIES, and for an image in newtons in the memory of a GPU.
    """
    (name,) = checked_names("memory", memory, MEMORIES)
    if name == "device":
        name = "host" if device.info.type == _core.DeviceType.CPU else "cuda"
    if name == "host":
        return None
    if image_unit != "counts":
        raise InputError(f"image_unit: {image_unit!r} is not allowed where memory is {memory!r}: 'counts'")
    return _core.Platform[name.upper()]


class DeviceArray:
    """A read-only array in the memory of a GPU, for libraries that speak DLPack: torch.from_dlpack(array) copies nothing.

    It shows newer numbers after a step, and keeps the memory of its simulator alive. Work that a library puts on the stream that it named
    waits for the last step, and the next step waits for that work. A library that names no stream gets the legacy default stream. A
    simulator remembers each stream. With one stream the device waits, with more the host waits too.
    """

    __slots__ = ("_array", "_batch", "dtype", "shape")

    def __init__(self, batch: Batch, array: Any, shape: tuple[int, ...], dtype: str) -> None:
        self._batch = batch
        self._array = array
        self.shape = shape  #: Sizes of the axes.
        self.dtype = np.dtype(dtype)  #: Type of an element.

    def __dlpack__(self, *, stream: int | None = None, **options: Any) -> Any:
        """A capsule of DLPack. stream: None, 1 or 2 (default streams), -1 (no wait), or a pointer. Raises InputError for another number."""
        number = _LEGACY_DEFAULT_STREAM if stream is None else stream
        if number < _NO_STREAM or number == 0:
            raise InputError(f"stream: {stream} is not allowed: None, -1, 1, 2 or the pointer of a stream")
        if number != _NO_STREAM:
            self._batch.add_consumer(number)
        return self._array.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        """Type of the device in DLPack, and its number."""
        device: tuple[int, int] = self._array.__dlpack_device__()
        return device

    def copy(self) -> npt.NDArray[Any]:
        """A copy in the memory of the host, which stays. Waits for the last step."""
        copied = np.empty(self.shape, self.dtype)
        self._batch.copy_to_host(self._array, copied.reshape(-1).view(np.uint8))
        return copied

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        raise InputError("an array in the memory of a GPU is not allowed here: array.copy(), or tensors() of a library for GPUs")

    def __repr__(self) -> str:
        return f"<taxelsim.DeviceArray {self.dtype}{self.shape}>"


def on_device(batch: Batch, arrays: dict[str, Any]) -> dict[str, Any]:
    """The result of arrays() of the extension module, with its tuples as DeviceArray."""
    return {
        name: on_device(batch, value) if isinstance(value, dict) else DeviceArray(batch, *value) if isinstance(value, tuple) else value
        for name, value in arrays.items()
    }
