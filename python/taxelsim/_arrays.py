"""Checks of arrays that callers hand in: one line says what was found, what is expected, and what was probably meant."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import InputError

# A dimension of an expected shape: its size and the symbol that stands for it in messages, or a fixed number.
Dimension = int | tuple[int, str]

QUATERNION_TOLERANCE = 1e-3
"""Largest deviation of the length of a rotation from 1, as in C++ (kQuaternionTolerance)."""


def _size(dimension: Dimension) -> int:
    return dimension if isinstance(dimension, int) else dimension[0]


def _text(shape: Sequence[object]) -> str:
    return "(" + ", ".join(str(size) for size in shape) + ("," if len(shape) == 1 else "") + ")"


def shape_text(shape: Sequence[Dimension]) -> str:
    """The expected shape with symbols and sizes: "(N, 7) = (4096, 7)"."""
    symbols = [size if isinstance(size, int) else size[1] for size in shape]
    if any(_size(dimension) < 0 for dimension in shape):
        return _text(symbols)
    sizes = _text([_size(dimension) for dimension in shape])
    return sizes if symbols == [_size(dimension) for dimension in shape] else f"{_text(symbols)} = {sizes}"


def _suggestion(found: tuple[int, ...], shape: Sequence[Dimension]) -> str:
    """What the caller probably meant: the same axes in another order, or an array without its batch axis."""
    expected = tuple(_size(dimension) for dimension in shape)
    if min(expected, default=0) < 0:
        return "; did you mean array.T?" if _fits(found[::-1], shape) else ""
    if len(found) == len(expected) and sorted(found) == sorted(expected):
        if len(found) == 2 or found == expected[::-1]:
            return "; did you mean array.T? The instances are the first axis"
        if found == (*expected[1:], expected[0]):
            return "; did you mean np.moveaxis(array, -1, 0)? The instances are the first axis"
        return "; did you mean another order of axes? The instances are the first axis"
    if found == expected[1:] and expected[0] == 1:
        return "; did you mean array[np.newaxis]? The instances are the first axis"
    if found == expected[1:] and found:
        return "; did you mean np.tile(array, (num_instances," + " 1," * (len(found) - 1) + " 1))? The instances are the first axis"
    if int(np.prod(found)) == int(np.prod(expected)):
        return f"; did you mean array.reshape{_text(expected)}?"
    return ""


def _first_bad(finite: npt.NDArray[np.bool_], value: npt.NDArray[Any], per_instance: bool) -> str:
    index = tuple(int(i) for i in np.unravel_index(int(np.argmin(finite)), finite.shape))
    place = f"instance {index[0]}" if per_instance else f"index {index if len(index) != 1 else index[0]}"
    return f"{value[index]} of {place}"


def to_numpy(name: str, value: Any) -> Any:
    """A tensor of PyTorch as an array over its memory, without its gradient; other values as they are.

    Raises InputError for a tensor that is not on the CPU, or whose type NumPy lacks.
    """
    if not hasattr(value, "detach"):
        return value
    try:
        return value.detach().numpy()
    except (TypeError, RuntimeError):
        raise InputError(f"{name}: a tensor of {value.dtype} on {value.device} is not allowed: of a type of NumPy, on the CPU") from None


def to_array(
    name: str,
    value: npt.ArrayLike,
    dtype: npt.DTypeLike,
    shapes: Sequence[Sequence[Dimension]],
    *,
    per_instance: bool = True,
    drop_slots: bool = False,
) -> npt.NDArray[Any]:
    """`value` as a contiguous array of `dtype` with one of `shapes`, without a copy if it is one. A negative size allows any length.

    per_instance: whether the first axis are the instances, which messages name. drop_slots: whether a second axis of length 1 is dropped.

    Raises InputError for another shape, for numbers that `dtype` cannot hold, and for NaN and infinity.
    """
    try:
        found = np.asarray(to_numpy(name, value))
    except ValueError:
        raise InputError(f"{name}: rows of different lengths; expected {' or '.join(map(shape_text, shapes))}") from None
    if drop_slots and found.ndim > 1 and found.shape[1] == 1:
        found = found[:, 0]
    target = np.dtype(dtype)
    kinds = "iu" if target.kind in "iu" else "b" if target.kind == "b" else "fiu"
    if found.dtype.kind not in kinds and not (found.size == 0 and found.dtype.kind == "f"):
        wanted = {"i": "integers", "u": "integers", "b": "booleans", "f": "real numbers"}[target.kind]
        advice = "; did you mean array.astype(int)?" if target.kind in "iu" and found.dtype.kind == "f" else ""
        raise InputError(f"{name}: dtype {found.dtype} is not allowed: {wanted}{advice}")
    if not any(_fits(found.shape, shape) for shape in shapes):
        expected = " or ".join(shape_text(shape) for shape in shapes)
        advice = next(filter(None, (_suggestion(found.shape, shape) for shape in shapes)), "")
        raise InputError(f"{name}: shape {_text(found.shape)} is not allowed: {expected}{advice}")
    if found.dtype.kind == "f":
        is_finite = np.isfinite(found)
        if not is_finite.all():
            raise InputError(f"{name}: {_first_bad(is_finite, found, per_instance)} is not finite")
    if target.kind in "iu" and found.size > 0:
        limits = np.iinfo(target)
        in_range = (found >= limits.min) & (found <= limits.max)
        if not in_range.all():
            raise InputError(f"{name}: {_first_bad(in_range, found, per_instance)} is not allowed: {limits.min} to {limits.max}")
    return np.ascontiguousarray(found, dtype=target)


def _fits(found: tuple[int, ...], shape: Sequence[Dimension]) -> bool:
    return len(found) == len(shape) and all(_size(d) < 0 or size == _size(d) for size, d in zip(found, shape, strict=True))


def mesh_arrays(vertices: npt.ArrayLike, triangles: npt.ArrayLike) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]:
    """Vertices (V, 3) and triangles (T, 3) of a mesh, checked."""
    checked = to_array("vertices", vertices, np.float32, [[(-1, "V"), 3]], per_instance=False)
    return checked, to_array("triangles", triangles, np.uint32, [[(-1, "T"), 3]], per_instance=False)


def rotation_matrices(rotations: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(N, 3, 3) of unit quaternions (N, 4), w first."""
    w, x, y, z = rotations.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def product(p: npt.NDArray[np.float64], q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Products of quaternions (..., 4), w first."""
    pw, px, py, pz = np.moveaxis(p, -1, 0)
    qw, qx, qy, qz = np.moveaxis(q, -1, 0)
    parts = (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )
    return np.stack(parts, axis=-1)
