"""Tactile images as colour pictures."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import Sensor
from ._files import write_whole
from .errors import InputError

# Anchors of a dark blue, green, yellow scale with rising luminance.
_ANCHORS = np.array([[20, 20, 60], [45, 75, 135], [30, 145, 140], [120, 205, 80], [253, 231, 37]], np.float64)
_COLOURS = np.stack([np.interp(np.linspace(0, 4, 256), np.arange(5), _ANCHORS[:, c]) for c in range(3)], -1).astype(np.uint8)

_TAXEL_PIXELS = 12  # width of a taxel in the picture
_MAX_PIXELS = 256  # largest side of a picture


def taxel_map(positions: NDArray[np.float64]) -> NDArray[np.intp]:
    """Index of the nearest taxel for every pixel (height, width). Rows of pixels go along x of S, columns along y.

    `positions` (taxels, 3): centres in S, m.
    """
    points = positions[:, :2]
    low, high = points.min(0), points.max(0)
    distances = np.linalg.norm(points[:, None] - points[None], axis=-1)
    np.fill_diagonal(distances, np.inf)
    pitch = float(np.median(distances.min(1))) if len(points) > 1 else 1.0
    low, high = low - pitch / 2, high + pitch / 2
    pixel = max(pitch / _TAXEL_PIXELS, float((high - low).max()) / _MAX_PIXELS)
    height, width = np.maximum(1, np.rint((high - low) / pixel)).astype(int)
    x = low[0] + (np.arange(height) + 0.5) * pixel
    y = low[1] + (np.arange(width) + 0.5) * pixel
    nearest = np.empty((height, width), np.intp)
    for row in range(height):  # one row at a time bounds the memory
        squares = (x[row] - points[:, 0]) ** 2 + (y[:, None] - points[:, 1]) ** 2
        nearest[row] = squares.argmin(1)
    return nearest


def colours_of(levels: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours (..., 3) of levels (...) from 0 to 1; levels beyond are clipped."""
    colours: NDArray[np.uint8] = _COLOURS[np.rint(np.clip(levels, 0, 1) * 255).astype(np.intp)]
    return colours


def pictures(counts: NDArray[Any], saturation: int, pixels: NDArray[np.intp]) -> NDArray[np.uint8]:
    """Pictures (N, height, width, 3) of images `counts` (N, taxels), from 0 to `saturation`. `pixels`: from taxel_map()."""
    return colours_of(counts.astype(np.float64) / saturation)[:, pixels]


def tactile_pictures(sensor: Sensor, images: NDArray[Any], largest: float | None = None) -> NDArray[np.uint8]:
    """Pictures (N, height, width, 3) of tactile images of a sensor.

    images: (N, rows, cols) or (N, taxels), such as Frame.tactile_image. largest: value of the brightest colour; default: the largest one.
    """
    values = np.asarray(images, np.float64).reshape(len(images), sensor.num_taxels)
    scale = max(1.0, float(values.max())) if largest is None else largest
    return pictures(values / scale, 1, taxel_map(sensor.taxel_positions))


def png_of(picture: NDArray[np.uint8]) -> bytes:
    """A picture (height, width, 3) as the bytes of a PNG file."""
    picture = np.asarray(picture, np.uint8)
    if picture.ndim != 3 or picture.shape[2] != 3:
        raise InputError(f"picture: shape (height, width, 3) expected, {picture.shape} found")

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = picture.shape
    lines = np.concatenate([np.zeros((height, 1), np.uint8), picture.reshape(height, -1)], axis=1)  # each begins with its filter: none
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits per channel, RGB
    chunks = chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(lines.tobytes(), 9)), chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def save_png(file: str | os.PathLike[str], picture: NDArray[np.uint8]) -> None:
    """Writes a picture (height, width, 3), whole or not at all. Raises IoError."""
    write_whole(Path(file), png_of(picture))
