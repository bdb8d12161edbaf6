"""The RGB stream of an Open-X-Tactile export. The format needs one; a simulation of arrays has no camera, so that the stream is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..pictures import TACTILE_IMAGE, colours_of, range_of, taxel_map
from ..program import SCENES
from .features import column_of
from .oxt_layout import Layout
from .source import Source

ARRAYS, SCENE = "arrays", "scene"
_TAXEL_PIXELS = 4  # width of a taxel
_GAP = 4  # pixels between two arrays
_REDUCED = 4  # a pixel of SCENE is the mean of 4 x 4 pixels of `taxelsim render`


class Camera(Protocol):
    """Pictures of frames."""

    shape: tuple[int, int, int]
    about: dict[str, Any]  #: Metadata: the content of the pictures.

    def draw(self, first: int, end: int, columns: dict[str, NDArray[Any]]) -> NDArray[np.uint8]:
        """(end - first, height, width, 3) of the frames [first, end) with these columns."""
        ...


def camera_of(source: Source, layout: Layout) -> Camera:
    """The camera that the options name. Throws InputError."""
    cameras: Mapping[str, type[_Arrays | _Scene]] = {ARRAYS: _Arrays, SCENE: _Scene}
    name = source.options.camera
    if name not in cameras:
        raise InputError(f"camera: {name!r} is not allowed: {', '.join(cameras)}")
    return cameras[name](source, layout)


class _Arrays:
    """The arrays side by side in the colours of `taxelsim render`."""

    def __init__(self, source: Source, layout: Layout) -> None:
        columns = [column_of(pad.prefix, TACTILE_IMAGE) for pad in layout.pads]
        self._range = max(range_of(source.data, name, source.options.range) for name in dict.fromkeys(columns))
        self._pads = layout.pads
        self._maps = [taxel_map(pad.sensor.taxel_positions, _TAXEL_PIXELS) for pad in layout.pads]
        widths = [pixels.shape[1] for pixels in self._maps]
        self._lefts = [sum(widths[:index]) + index * _GAP for index in range(len(widths))]
        self.shape = (max(len(pixels) for pixels in self._maps), self._lefts[-1] + widths[-1], 3)
        names = ", ".join(pad.name for pad in layout.pads)
        self.about = {"shows": f"drawn, no camera: counts of the arrays {names} from left to right", "range_counts": self._range}

    def draw(self, first: int, end: int, columns: dict[str, NDArray[Any]]) -> NDArray[np.uint8]:
        pictures = np.zeros((end - first, *self.shape), np.uint8)
        for pad, pixels, left in zip(self._pads, self._maps, self._lefts, strict=True):
            counts = pad.values(columns, TACTILE_IMAGE).reshape(end - first, -1)
            colours = colours_of(counts * np.float32(1 / self._range))
            height, width = pixels.shape
            for channel in range(3):  # faster than all at once
                pictures[:, :height, left : left + width, channel] = np.take(colours[..., channel], pixels, axis=1)
        return pictures


class _Scene:
    """Sensor and object in 3-D with the tactile image, as `taxelsim render` draws an episode."""

    def __init__(self, source: Source, layout: Layout) -> None:
        self._source = source
        self._assets = [*map(str, source.options.assets), str(SCENES)]
        self._episode = -1
        self._pictures: Any = None  # of that episode
        self.shape = self._draw(0).shape
        self.about = {"shows": "drawn, no camera: sensor and object in 3-D, tactile image and curves, as `taxelsim render`"}

    def draw(self, first: int, end: int, columns: dict[str, NDArray[Any]]) -> NDArray[np.uint8]:
        return np.stack([self._draw(frame) for frame in range(first, end)])

    def _draw(self, frame: int) -> NDArray[np.uint8]:
        ends = self._source.ends
        episode = int(np.searchsorted(ends, frame, side="right"))
        if episode != self._episode:
            self._pictures, self._episode = self._open(episode), episode
        picture = self._pictures.draw(frame - int(ends[episode - 1] if episode else 0))
        height, width = (side // _REDUCED for side in picture.shape[:2])
        blocks = picture[: height * _REDUCED, : width * _REDUCED].reshape(height, _REDUCED, width, _REDUCED, 3)
        reduced: NDArray[np.uint8] = blocks.mean(axis=(1, 3)).round().astype(np.uint8)
        return reduced

    def _open(self, episode: int) -> Any:
        from .._pictures import EpisodePictures  # needs Cairo

        number, scale = self._source.episode_number(episode), self._source.options.range or 0.0
        pictures = EpisodePictures(str(self._source.data.folder), number, scale, self._assets)
        if pictures.without_view:
            raise InputError(f"camera: {SCENE} is not allowed: {pictures.without_view}; --camera {ARRAYS} draws any data set")
        return pictures
