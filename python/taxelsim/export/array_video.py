"""Tactile images as videos of a LeRobot data set: one per sensor, with the pictures of taxelsim.pictures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..dataset.provenance import Provenance
from ..errors import InputError
from ..pictures import TACTILE_IMAGE, TactilePictures, colours_of, noise_of, range_of, shown_column
from ..video import mp4_encoder
from ..viewer.scene_files import scene_of, sensor_of
from .features import image_shape, shown_sensors
from .source import Block, Source
from .staging import new_file
from .statistics import QUANTILES, Statistics

KEY = "observation.images.tactile"
NUM_LEVELS = 256  # of the colour scale
PICTURES = 64  # that are drawn at once
# A key frame every second frame, as lerobot writes them: readers access frames at random. One thread gives the same bytes on all machines.
_OPTIONS = {"crf": "18", "preset": "veryfast", "g": "2", "bf": "0", "threads": "1"}


class ArrayVideo:
    """Pictures of the arrays, (height, width, 3) of uint8, with the scale of the data set; arrows are the shear of three-axis taxels."""

    def __init__(self, source: Source, rate: float) -> None:
        """Throws InputError if the scene has a file for its array that no folder of the option `assets` has."""
        folder = source.data.folder
        scene, _ = scene_of(Provenance.of(folder).scene, [Path(name) for name in source.options.assets], folder)
        if shown_sensors(source.data) != ("",):
            raise InputError(f"{folder}: video: choose a sensor: {', '.join(source.data.sensors)}")
        sensor = sensor_of(scene, source.data.sensor)
        num_sensors, *taxels = image_shape(source.data)
        if math.prod(taxels) != sensor.num_taxels:
            raise InputError(f"{folder}: video: {TACTILE_IMAGE} has {math.prod(taxels)} taxels of a sensor, its scene {sensor.num_taxels}")
        self.keys = [KEY] if num_sensors == 1 else [f"{KEY}_{sensor}" for sensor in range(num_sensors)]
        self._rate = rate
        self._column = shown_column(source.data)
        self._pictures = TactilePictures(sensor, range_of(source.data, self._column, source.options.range), noise_of(scene))
        self._colours = colours_of(np.linspace(0, 1, NUM_LEVELS))

    def feature(self) -> dict[str, Any]:
        """The entry of meta/info.json, the same for all videos. The encoder makes odd sides even."""
        height, width = (side + side % 2 for side in self._pictures.pixels.shape)
        info = {"height": height, "width": width, "codec": "h264", "pix_fmt": "yuv420p", "is_depth_map": False, "fps": self._rate}
        info = {f"video.{name}": value for name, value in info.items()} | {"video.channels": 3, "has_audio": False}
        return {"dtype": "video", "shape": [height, width, 3], "names": ["height", "width", "channels"], "info": info}

    def about(self) -> dict[str, Any]:
        """For meta/taxelsim.json: what the videos show, and the counts of the brightest colour."""
        return {"video": {"column": self._column, "range": self._pictures.range}}

    def counts(self, block: Block) -> NDArray[Any]:
        """What the videos show, (F, num_sensors, num_taxels), of three-axis taxels (F, num_sensors, num_taxels, 3)."""
        axes = () if self._column == TACTILE_IMAGE else (3,)
        return block.values[self._column].reshape(block.num_frames, len(self.keys), -1, *axes)

    @contextmanager
    def files(self, folder: Path, name: str) -> Iterator[Callable[[NDArray[Any]], None]]:
        """A function that appends frames with these counts to the files FOLDER/KEY/NAME, which appear at the end."""
        with ExitStack() as stack:
            names = [stack.enter_context(new_file(folder / key / name)) for key in self.keys]
            encoders = [stack.enter_context(mp4_encoder(str(file), self._rate, _OPTIONS)) for file in names]

            def add(counts: NDArray[Any]) -> None:
                for first in range(0, len(counts), PICTURES):
                    for sensor, encode in enumerate(encoders):
                        for picture in self._pictures.draw(counts[first : first + PICTURES, sensor]):
                            encode(picture)

            yield add

    def statistics(self, counts: NDArray[Any], ends: NDArray[np.int64]) -> dict[str, Statistics]:
        """Of the three colours (E, 3) over all taxels of an episode, without arrows, from 0 to 1, for each video.

        ends: (E), frames up to its end.
        """
        result = {}
        normal = counts if self._column == TACTILE_IMAGE else counts[..., 2]
        levels = np.rint(np.clip(normal / self._pictures.range, 0, 1) * (NUM_LEVELS - 1)).astype(np.uint8)
        for sensor, key in enumerate(self.keys):
            episodes = np.split(levels[:, sensor], ends[:-1])
            occurrences = [np.bincount(frames.ravel(), minlength=NUM_LEVELS) for frames in episodes]
            result[key] = {**_measures(np.stack(occurrences), self._colours / 255), "count": np.diff(ends, prepend=0)[:, None]}
        return result


def _measures(counts: NDArray[np.int64], colours: NDArray[np.float64]) -> Statistics:
    """counts: (E, NUM_LEVELS), how often each colour occurs. colours: (NUM_LEVELS, 3)."""
    shares = counts / counts.sum(axis=1, keepdims=True)
    mean = shares @ colours
    seen = counts[:, :, None] > 0
    measures = {"min": np.where(seen, colours, np.inf).min(axis=1), "max": np.where(seen, colours, -np.inf).max(axis=1), "mean": mean}
    measures["std"] = np.sqrt(np.maximum(shares @ colours**2 - mean**2, 0))
    order = np.argsort(colours, axis=0)  # (NUM_LEVELS, 3)
    below = shares[:, order].cumsum(axis=1)  # (E, NUM_LEVELS, 3), share up to a colour
    for name, quantile in QUANTILES.items():
        place = np.minimum((below < quantile).sum(axis=1), NUM_LEVELS - 1)
        measures[name] = np.take_along_axis(colours, np.take_along_axis(order, place, axis=0), axis=0)
    return measures
