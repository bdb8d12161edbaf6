"""Tactile images as colour pictures."""

from __future__ import annotations

import io
import math
import os
import struct
import zlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arguments import checked_positive
from ._core import Scene, Sensor
from ._files import write_whole
from .device_array import DeviceArray
from .errors import InputError

if TYPE_CHECKING:
    from .dataset import Dataset

TACTILE_IMAGE, TAXEL_COUNTS = "data/tactile_image", "data/taxel_counts"

ARROW_TAXELS = 2.0
"""Length, in taxels, of an arrow with the counts of the brightest colour."""

_COLOURS = np.array(_core.value_colours(), np.uint8)

_TAXEL_PIXELS = 12  # width of a taxel in the picture
_ARROW_PIXELS = 32  # the same of a three-axis taxel, which has room for an arrow
_MAX_PIXELS = 256  # largest side of a picture

_ARROW_COLOUR = (230, 60, 60)
# Of a taxel: width of an arrow, length of its head, and length below which none is drawn.
_ARROW_WIDTH, _HEAD, _SHORTEST_ARROW = 0.08, 0.3, 0.15


@dataclass(frozen=True)
class _Grid:
    """The pixels of a picture: rows go along x of S, columns along y."""

    low: NDArray[np.float64]  #: (2), m, of the first corner.
    pitch: float  #: m, from a taxel to the next.
    pixel: float  #: m, side of a pixel.
    shape: tuple[int, int]  #: Rows and columns.

    @staticmethod
    def of(positions: NDArray[np.float64], taxel_pixels: int) -> _Grid:
        points = positions[:, :2]
        distances = np.linalg.norm(points[:, None] - points[None], axis=-1)
        np.fill_diagonal(distances, np.inf)
        pitch = float(np.median(distances.min(1))) if len(points) > 1 else 1.0
        low, high = points.min(0) - pitch / 2, points.max(0) + pitch / 2
        pixel = max(pitch / taxel_pixels, float((high - low).max()) / _MAX_PIXELS)
        height, width = np.maximum(1, np.rint((high - low) / pixel)).astype(int)
        return _Grid(low, pitch, pixel, (int(height), int(width)))


def taxel_chart(sensor: Sensor) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres (num_taxels, 2), m, and unit vectors along x and y (num_taxels, 2, 2) of the taxels in pictures.

    Those of S, but a list of taxels, such as a curved fingertip, is unrolled along its skin, as in all figures.
    """
    if len(sensor.patches) == 1 or any(patch.num_rows * patch.num_cols != 1 for patch in sensor.patches):
        return sensor.taxel_positions[:, :2], taxel_axes(sensor)[:, :, :2]
    from ._pictures import taxel_outlines  # of Cairo

    outlines = taxel_outlines(sensor)
    sides = np.stack([outlines[:, 3] - outlines[:, 0], outlines[:, 1] - outlines[:, 0]], axis=1)
    return outlines.mean(axis=1), sides / np.linalg.norm(sides, axis=-1, keepdims=True)


def taxel_map(positions: NDArray[np.float64], taxel_pixels: int = _TAXEL_PIXELS) -> NDArray[np.intp]:
    """Index of the nearest taxel for every pixel (height, width). Rows of pixels go along x of S, columns along y.

    positions: (taxels, 2) or (taxels, 3), centres, m; see taxel_chart(). taxel_pixels: width of a taxel; less if the picture would be
        too large.
    """
    grid = _Grid.of(positions, taxel_pixels)
    x, y = (grid.low[axis] + (np.arange(count) + 0.5) * grid.pixel for axis, count in enumerate(grid.shape))
    nearest = np.empty(grid.shape, np.intp)
    for row, place in enumerate(x):  # one row at a time bounds the memory
        squares = (place - positions[:, 0]) ** 2 + (y[:, None] - positions[:, 1]) ** 2
        nearest[row] = squares.argmin(1)
    return nearest


def colours_of(levels: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours (..., 3) of levels (...) from 0 to 1; levels beyond are clipped."""
    colours: NDArray[np.uint8] = _COLOURS[np.rint(np.clip(levels, 0, 1) * 255).astype(np.intp)]
    return colours


def taxel_axes(sensor: Sensor) -> NDArray[np.float64]:
    """Unit vectors along x and y of the patch of each taxel (num_taxels, 2, 3), in S."""
    rows = []
    for patch in sensor.patches:
        axes = np.array([patch.X_SP.transform(axis) for axis in ([1, 0, 0], [0, 1, 0])]) - patch.X_SP.position
        rows.append(np.repeat(axes[None], patch.num_rows * patch.num_cols, 0))
    return np.concatenate(rows)


def shown_column(data: Dataset) -> str:
    """The column that pictures of a data set show: the counts of three-axis taxels where they are recorded, else the tactile image."""
    return TAXEL_COUNTS if TAXEL_COUNTS in data else TACTILE_IMAGE


def range_of(data: Dataset, column: str, range: float | None = None) -> float:
    """Counts of the brightest colour of pictures of a data set: `range`, else the 99.9th percentile of the column, beyond noise.

    As `taxelsim render` draws them. Raises InputError for a `range` that is not above 0.
    """
    return (
        _core.DatasetReader(data.folder, isolated=True).counts_range(data[column].path)
        if range is None
        else checked_positive("range", range)
    )


def noise_of(scene: Scene) -> float:
    """Counts, the largest standard deviation of the noise that the scene adds to its sensor's own."""
    return scene.randomization.get("noise", (0, 0))[1]


class TactilePictures:
    """Draws images of a sensor with one scale: a colour per taxel, and arrows for the shear of three-axis taxels.

    range: counts of the brightest colour. None: the largest range of what was drawn so far, beyond noise. It never shrinks, so that
        pictures do not flicker.
    noise: counts, standard deviation, in addition to the sensor's own.
    """

    def __init__(self, sensor: Sensor, range: float | None = None, noise: float = 0) -> None:
        self._is_fixed = range is not None
        self.range = 1.0 if range is None else checked_positive("range", range)
        readout = sensor.readout
        self._noise = math.hypot(readout.noise, readout.bias, noise)
        self._axes_noise = math.hypot(max(readout.three_axis.noise), noise) if readout.three_axis else 0.0
        self._least_shear = _core.SHEAR_DEVIATIONS * self._axes_noise
        self._sensor = sensor

    @cached_property
    def pixels(self) -> NDArray[np.intp]:
        """Index of the taxel of every pixel (height, width)."""
        return taxel_map(taxel_chart(self._sensor)[0], _ARROW_PIXELS if self._sensor.readout.three_axis else _TAXEL_PIXELS)

    @cached_property
    def _arrows(self) -> _Arrows:
        return _Arrows(self._sensor)

    def draw(self, counts: NDArray[Any]) -> NDArray[np.uint8]:
        """Pictures (N, height, width, 3) of counts (N, num_taxels), or of three-axis taxels (N, num_taxels, 3)."""
        normal = np.ascontiguousarray(counts[..., 2] if counts.ndim == 3 else counts, np.float64)
        if not self._is_fixed:
            noise = self._axes_noise if counts.ndim == 3 else self._noise
            self.range = max(self.range, _core.counts_range(normal.ravel(), noise))
        drawn = colours_of(normal / self.range)[:, self.pixels]
        if counts.ndim == 3:
            shear = counts[..., :2]
            shown = np.where(np.linalg.norm(shear, axis=-1, keepdims=True) >= self._least_shear, shear, 0) / self.range
            for picture, arrows in zip(drawn, shown, strict=True):
                self._arrows.draw(picture, arrows)
        return drawn


class _Arrows:
    """Arrows in the pictures of a sensor, two taxels long where the shear has the counts of the brightest colour."""

    def __init__(self, sensor: Sensor) -> None:
        positions, axes = taxel_chart(sensor)
        grid = _Grid.of(positions, _ARROW_PIXELS)
        self._taxel = grid.pitch / grid.pixel  # pixels
        self._middles = (positions - grid.low) / grid.pixel  # (T, 2), rows and columns
        self._axes = axes * (ARROW_TAXELS * self._taxel)  # (T, 2, 2)
        self._width = max(1, round(_ARROW_WIDTH * self._taxel))
        offsets = np.arange(self._width) - (self._width - 1) / 2
        self._brush = np.stack(np.meshgrid(offsets, offsets), -1).reshape(-1, 2)  # pixels of a point of a line

    def draw(self, picture: NDArray[np.uint8], shear: NDArray[np.float64]) -> None:
        """Draws arrows of shear (T, 2), relative to the range, into a picture."""
        vectors = np.einsum("ta,taf->tf", shear, self._axes)
        lengths = np.linalg.norm(vectors, axis=1)
        seen = lengths >= _SHORTEST_ARROW * self._taxel
        if not seen.any():
            return
        vectors, lengths, starts = vectors[seen], lengths[seen, None], self._middles[seen]
        back = -vectors / lengths * np.minimum(_HEAD * self._taxel, 0.6 * lengths)
        across = 0.6 * back[:, ::-1] * [1, -1]
        ends = starts + vectors
        begins, lines = np.stack([starts, ends, ends]), np.stack([vectors, back + across, back - across])  # (3, T, 2)
        steps = int(min(lengths.max(), 2 * _MAX_PIXELS) / self._width) * 2 + 2  # of a line, half its width apart
        points = begins[..., None, :] + lines[..., None, :] * np.linspace(0, 1, steps)[:, None]
        rows, columns = np.floor(points.reshape(-1, 1, 2) + self._brush).astype(np.intp).reshape(-1, 2).T
        inside = (rows >= 0) & (rows < picture.shape[0]) & (columns >= 0) & (columns < picture.shape[1])
        picture[rows[inside], columns[inside]] = _ARROW_COLOUR


class SensorPictures:
    """Draws all sensors of a scene side by side, in the order of the robot. range: see TactilePictures."""

    def __init__(self, scene: Scene, range: float | None = None) -> None:
        sensors = dict(scene.sensors) or {"": scene.sensor}
        self._sensors = {name: (sensor, TactilePictures(sensor, range, noise_of(scene))) for name, sensor in sensors.items()}
        self.draws_axes = any(sensor.readout.three_axis is not None for sensor in sensors.values())  #: needs Frame.taxel_counts.

    def draw(self, frame: Any) -> list[NDArray[np.uint8]]:
        """A picture (height, width, 3) of each instance. frame: EnvironmentFrame or GraspFrame of N instances."""
        num_instances = len(frame.frame_numbers)
        drawn = []
        for name, (sensor, pictures) in self._sensors.items():
            axes = (3,) if sensor.readout.three_axis is not None else ()
            counts = (frame.sensors[name] if name else frame)["taxel_counts" if axes else "tactile_image"]
            if isinstance(counts, DeviceArray):
                counts = counts.copy()
            images = pictures.draw(counts.reshape(-1, sensor.num_taxels, *axes))
            drawn += list(images.reshape(num_instances, -1, *images.shape[1:]).swapaxes(0, 1))  # by sensor: (N, height, width, 3)
        height = max(images.shape[1] for images in drawn)
        padded = [np.pad(images, ((0, 0), (0, height - images.shape[1]), (0, 0), (0, 0))) for images in drawn]
        return list(np.concatenate(padded, axis=2))


def tactile_pictures(sensor: Sensor, images: NDArray[Any], range: float | None = None) -> NDArray[np.uint8]:
    """Pictures (N, height, width, 3) of tactile images of a sensor.

    images: (N, rows, cols) or (N, taxels), such as Frame.tactile_image; of three-axis taxels (N, ..., 3), such as Frame.taxel_counts.
    range: counts of the brightest colour; default: the 99.9th percentile of the images, beyond the sensor's noise.
    """
    values = np.asarray(images, np.float64)
    axes = (3,) if values.size == 3 * len(images) * sensor.num_taxels else ()
    return TactilePictures(sensor, range).draw(values.reshape(len(images), sensor.num_taxels, *axes))


def colour_map() -> Any:
    """The colours of tactile pictures, from dark to bright, as a colormap of matplotlib. Raises ImportError without matplotlib."""
    from matplotlib.colors import ListedColormap

    return ListedColormap(_COLOURS / 255, "taxelsim")


def draw_taxels(axes: Any, sensor: Sensor, values: NDArray[Any], range: float | None = None) -> Any:
    """Draws one value per taxel, such as one tactile image, on axes of matplotlib, and returns the AxesImage, for a colour bar.

    x runs downwards and y to the right, in mm, as in tactile_pictures(): of S, or along the skin of a list of taxels, such as a curved tip.
    values: (num_rows, num_cols) or (num_taxels).
    range: value of the brightest colour, > 0; default: the largest value. Raises ImportError without matplotlib.
    """
    positions = taxel_chart(sensor)[0]
    grid = _Grid.of(positions, _TAXEL_PIXELS)
    (top, left), (bottom, right) = 1e3 * grid.low, 1e3 * (grid.low + grid.pixel * np.array(grid.shape))
    picture = np.ravel(values)[taxel_map(positions)]
    axes.set(xlabel="y (mm)", ylabel="x (mm)")
    limit = picture.max() if range is None else checked_positive("range", range)
    return axes.imshow(picture, colour_map(), vmin=0, vmax=limit, extent=(left, right, bottom, top), interpolation="nearest")


def png_of(picture: NDArray[np.uint8]) -> bytes:
    """A picture (height, width, 3) as the bytes of a PNG file."""
    picture = np.asarray(picture, np.uint8)
    if picture.ndim != 3 or picture.shape[2] != 3:
        raise InputError(f"picture: shape {picture.shape} is not allowed: (height, width, 3)")

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


def save_figure(file: str | os.PathLike[str], figure: Any) -> None:
    """Writes a figure of matplotlib as a PNG file with 256 colours, a third as large as savefig() does, whole or not at all.

    Raises IoError, and ImportError without Pillow, which matplotlib needs.
    """
    from PIL import Image

    drawn, reduced = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png")
    Image.open(drawn).convert("RGB").quantize(256).save(reduced, "PNG", optimize=True)
    write_whole(Path(file), reduced.getvalue())
