"""What is shown: episodes of a data set, or of a scene that is simulated first."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._core import Device, Scene, load_scene
from .._log import logger
from ..dataset import Dataset
from ..dataset.provenance import Provenance
from ..errors import InputError
from ..pictures import TACTILE_IMAGE, TAXEL_COUNTS, range_of
from ..runs import generate
from .checks import size_warnings
from .scene_files import scene_of, sensor_of

DEFAULT_EPISODES = 3
_MAX_KNOTS = 4097  # of the curve from counts to newtons


@dataclass(frozen=True)
class Episode:
    """Frames of one episode by name of column, arrays (F, ...), and values of columns in meta/. F: number of frames."""

    number: int
    columns: Mapping[str, Any]
    sensor: _core.Sensor
    name: str = ""
    """Of the sensor, where several have columns of their own: each has an Episode."""

    def __len__(self) -> int:
        return len(self.columns["data/tactile_image"])

    @property
    def num_sensors(self) -> int:
        """Sensors of the robot."""
        return int(self.image.size // (len(self) * self.sensor.num_taxels))

    @property
    def object_index(self) -> int | None:
        """Index of the object in the scene; None for recorded contact points."""
        index = self.columns.get("meta/object")
        return None if index is None else int(index)

    @property
    def image(self) -> NDArray[Any]:
        """Tactile images, as in the data set."""
        return np.asarray(self.columns["data/tactile_image"])

    def per_sensor(self, name: str, shape: tuple[int, ...]) -> NDArray[Any] | None:
        """A column as (F, num_sensors, *shape); None if it is not recorded."""
        values = self.columns.get(name)
        return None if values is None else np.asarray(values).reshape(len(self), self.num_sensors, *shape)

    @property
    def forces(self) -> NDArray[np.float64]:
        """Normal forces (F, num_sensors, num_taxels), N: from ground truth if recorded, else from the counts by the nominal curve."""
        true = self.per_sensor("data/ground_truth/tactile_normal_force", (self.sensor.num_taxels,))
        if true is not None:
            return np.asarray(true, np.float64)
        readout = self.sensor.readout
        knots = np.linspace(0, readout.saturation, min(readout.saturation + 1, _MAX_KNOTS))
        newtons = [_core.nominal_force(readout, counts) for counts in knots]
        counts = self.image.reshape(len(self), self.num_sensors, self.sensor.num_taxels)
        return np.asarray(np.interp(counts, knots, newtons))


@dataclass(frozen=True)
class Source:
    """Episodes and their scene."""

    scene: Scene
    missing: set[int]
    """Objects whose mesh is not found."""
    episodes: list[Episode]
    ranges: Mapping[str, float]
    """Counts of the brightest colour by column."""


def _is_shown(name: str) -> bool:
    return "/jacobian/" not in name and name != "meta/episode_ends"


def _row_of(data: Dataset, number: int) -> int:
    """Row of an episode; without reading all numbers where the data set has all episodes, in order."""
    if 0 <= number < data.num_episodes and data["meta/episode"][number] == number:
        return number
    rows = np.flatnonzero(data["meta/episode"][:] == number)
    if not len(rows):
        numbers = data["meta/episode"][:]
        raise InputError(f"{data.folder}: episode {number} is not in the data set, whose episodes are {numbers.min()} to {numbers.max()}")
    return int(rows[0])


def _episodes(data: Dataset, scene: Scene, numbers: Sequence[int] | None) -> list[Episode]:
    for needed in ("data/time", "data/tactile_image"):
        if needed not in data:
            raise InputError(f"{data.folder}: no column {needed}: add tactile_image to `record` of the scene")
    columns = [name for name in data.columns if _is_shown(name)]
    rows = range(min(DEFAULT_EPISODES, data.num_episodes)) if numbers is None else [_row_of(data, number) for number in numbers]
    values = [data.episode(row, columns) for row in rows]
    sensor = sensor_of(scene, data.sensor)
    return [Episode(int(value["meta/episode"]), value, sensor, data.sensor or "") for value in values]


@contextmanager
def simulated(scene: Scene, numbers: Sequence[int] | None, device: Device | None) -> Iterator[Path]:
    """A temporary data set of some episodes of a scene; None: the first ones. Raises what generate() raises."""
    chosen = range(min(DEFAULT_EPISODES, scene.num_episodes)) if numbers is None else numbers
    with tempfile.TemporaryDirectory() as folder:
        generate(scene, folder, episodes=chosen, device=device, batch_size=len(chosen), num_slices=1)
        yield Path(folder)


def _source(folder: Path, isolated: bool, scene: Scene, missing: set[int], numbers: Sequence[int] | None, range: float | None) -> Source:
    """Each of several sensors with columns of their own has an Episode; those of one episode follow each other."""
    data = Dataset(folder, isolated=isolated)
    parts = [Dataset(folder, isolated=isolated, sensor=name) for name in data.sensors] or [data]
    groups = zip(*(_episodes(part, scene, numbers) for part in parts), strict=True)
    ranges: dict[str, float] = {}
    for name in (TACTILE_IMAGE, TAXEL_COUNTS):
        found = [range_of(part, name, range) for part in parts if name in part]
        if found:
            ranges[name] = max(found)
    return Source(scene, missing, [episode for group in groups for episode in group], ranges)


def open_source(
    path: Path, numbers: Sequence[int] | None, assets: Sequence[Path], device: Device | None, isolated: bool, range: float | None
) -> Source:
    """Episodes of a data set, or of a scene file. Raises InputError.

    numbers: of the episodes; None: the first ones. isolated: as Dataset(). range: counts of the brightest colour.
    """
    if numbers is not None and (not len(numbers) or len(set(numbers)) != len(numbers) or min(numbers) < 0):
        raise InputError(f"episodes: {', '.join(map(str, numbers)) or 'none'} is not allowed: different numbers from 0")
    for folder in assets:
        if not folder.is_dir():
            raise InputError(f"{folder}: not a folder; assets names a folder with meshes of the scene")
    if path.is_dir():
        scene, missing = scene_of(Provenance.of(path).scene, assets, path)
        warn(size_warnings(scene, missing))
        return _source(path, isolated, scene, missing, numbers, range)
    scene = load_scene(path)
    warn(size_warnings(scene, set()))  # first, since the simulation may refuse such objects
    with simulated(scene, numbers, device) as folder:
        return _source(folder, False, scene, set(), numbers, range)


def warn(lines: Sequence[str]) -> None:
    """Logs warnings."""
    for line in lines:
        logger.warning("%s", line)
