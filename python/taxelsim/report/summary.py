"""Numbers of a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Scene, Sensor
from .._features import IMAGE_FEATURES
from ..dataset import Dataset
from ..dataset.provenance import Provenance
from ..errors import InputError
from ..pictures import TACTILE_IMAGE, range_of, shown_column
from ..viewer.scene_files import scene_of, sensor_of
from .sample import Sample

MAX_FRAMES = 1_000_000
"""Frames of a data set beyond which a report is computed from a sample."""

NUM_BINS = 40
ANGLE_BIN = 10  # deg, of gaps in the coverage of angles
VARIABLE_BINS = 10  # of gaps in the coverage of a random variable
QUANTILES = (0, 5, 50, 95, 100)  # percent
EXAMPLE_LEVELS = (10, 50, 90)  # percentiles of force that examples of an object show

_GROUPS = {"N": "force", "rad": "angle", "1": "angle", "m": "position", "m^2": "position"}
_MOMENTS = ("second_moments", "eigenvalues")
_DISTRIBUTIONS = (
    *((f"data/{name}", _GROUPS[unit]) for name, _, unit in IMAGE_FEATURES if name not in _MOMENTS),
    ("data/ground_truth/total_force", "force"),
    ("data/ground_truth/edge_angle", "angle"),
    ("data/ground_truth/exact_edge_angle", "angle"),
    ("data/saturated", "saturation"),
)
_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Distribution:
    """Values of a column, or of one component."""

    name: str
    unit: str
    group: str  #: force, angle, position, saturation or episode.
    count: int
    mean: float
    quantiles: tuple[float, ...]  #: By QUANTILES; the first and the last are the extremes.
    edges: NDArray[np.float64]  #: (NUM_BINS + 1).
    counts: NDArray[np.int64]  #: (NUM_BINS).

    @property
    def is_constant(self) -> bool:
        """All values are equal."""
        return self.quantiles[0] == self.quantiles[-1]

    @staticmethod
    def of(name: str, unit: str, group: str, values: NDArray[np.float64]) -> Distribution | None:
        """The distribution of values (K,); None without any."""
        if not values.size:
            return None
        numbers = values.astype(np.float64)
        counts, edges = np.histogram(numbers, NUM_BINS)
        quantiles = tuple(float(value) for value in np.percentile(numbers, QUANTILES))
        return Distribution(name, unit, group, numbers.size, float(numbers.mean()), quantiles, edges, counts)


@dataclass(frozen=True)
class Example:
    """An image of a stratum."""

    stratum: str
    force: float  #: Measured force, or sum of the counts where it is not recorded.
    unit: str
    image: NDArray[Any]  #: (num_taxels) counts, or (num_taxels, 3) of three-axis taxels.


@dataclass
class Summary:
    """What a report says about a data set."""

    folder: Path
    provenance: Provenance
    scene: Scene
    sensor: Sensor
    """The sensor that is shown."""
    sensor_name: str
    """With its place in the robot, where there are several."""
    num_frames: int
    num_episodes: int
    num_sampled_frames: int
    num_sampled_episodes: int
    columns: list[tuple[str, str, tuple[int, ...], str, str]]
    """Name, type, shape of a row, unit, description."""
    distributions: list[Distribution] = field(default_factory=list)
    objects: dict[str, int] = field(default_factory=dict)
    """Sampled episodes by name of the object."""
    out_of_reach: dict[str, int] = field(default_factory=dict)
    """Sampled episodes whose load the skin could not carry, by name of the object."""
    successes: int | None = None
    """Sampled episodes that met the task; None without one."""
    contact_frames: int = 0
    """Sampled frames with a taxel above 0."""
    saturated_frames: int = 0
    """Sampled frames with a taxel at the upper end of its range."""
    taxel_contacts: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    """(num_taxels), sampled frames in which the taxel is above 0."""
    examples: list[Example] = field(default_factory=list)
    range: float = 1
    """Counts of the brightest colour of the examples."""
    gaps: list[str] = field(default_factory=list)
    """What the sampled data lack, a sentence each."""


def summarize(data: Dataset, max_frames: int = MAX_FRAMES, assets: Sequence[Path] = (), range: float | None = None) -> Summary:
    """The numbers of a report. Raises InputError for a data set without tactile images.

    assets: folders with a URDF or taxel mesh of the scene; meshes of objects are not needed.
    range: counts of the brightest colour of examples; default: from the data set, as `taxelsim render` draws it.
    """
    from .coverage import gaps_of
    from .examples import examples_of

    if TACTILE_IMAGE not in data:
        raise InputError(f"{data.folder}: no column {TACTILE_IMAGE}; add tactile_image to `record` of the scene")
    provenance = Provenance.of(data.folder)
    sample = Sample(data, max_frames)
    names = [data[name] for name in data.columns]
    columns = [(column.name, str(column.dtype), column.shape[1:], column.unit, column.description) for column in names]
    scene, _ = scene_of(provenance.scene, assets, data.folder)
    sensor = sensor_of(scene, data.sensor)
    name = f"{data.sensor} of {', '.join(data.sensors)}: {sensor.name}" if data.sensor else sensor.name
    sizes = (data.num_frames, data.num_episodes, sample.num_frames, len(sample.episodes))
    summary = Summary(data.folder, provenance, scene, sensor, name, *sizes, columns)
    summary.distributions = _distributions(sample)
    _count_episodes(sample, summary)
    _count_images(sample, summary)
    summary.examples = examples_of(sample, summary)
    summary.range = range_of(data, shown_column(data), range)
    summary.gaps = gaps_of(sample, summary)
    return summary


def _distributions(sample: Sample) -> list[Distribution]:
    result: list[Distribution | None] = []
    for name, group in _DISTRIBUTIONS:
        if name not in sample.data:
            continue
        values, unit = sample.column(name), sample.data[name].unit
        if name.endswith("exact_edge_angle"):
            values = values[sample.column("data/ground_truth/exact_edge_known").astype(bool)]
        if name.endswith("center_of_pressure"):
            touched = values[values.any(-1)]  # 0 without contact
            result += [Distribution.of(f"{name} {axis}", unit, group, touched[..., k]) for k, axis in enumerate(_AXES)]
        else:
            result.append(Distribution.of(name, unit, group, values.ravel()))
    for name in sample.data.columns:
        column = sample.data[name]
        if name.startswith("meta/") and column.dtype.kind == "f" and len(column.shape) == 1:
            result.append(Distribution.of(name, column.unit, "episode", sample.column(name)))
    return [distribution for distribution in result if distribution is not None]


def _count_episodes(sample: Sample, summary: Summary) -> None:
    if "meta/success" in sample.data:
        summary.successes = int(sample.column("meta/success").sum())
    if "meta/object_name" not in sample.data:
        return
    names = sample.column("meta/object_name")
    reached = sample.column("meta/load_reached").astype(bool)
    for item in summary.scene.objects:
        summary.objects[item.name] = int((names == item.name).sum())
        summary.out_of_reach[item.name] = int((~reached & (names == item.name)).sum())


def _count_images(sample: Sample, summary: Summary) -> None:
    sensor = summary.sensor
    summary.taxel_contacts = np.zeros(sensor.num_taxels, np.int64)
    for block in sample.frames(TACTILE_IMAGE):
        images = block.reshape(len(block), -1, sensor.num_taxels)  # (B, num_sensors, num_taxels)
        touched = images > 0
        summary.contact_frames += int(touched.any((1, 2)).sum())
        summary.saturated_frames += int((images >= sensor.readout.saturation).any((1, 2)).sum())
        summary.taxel_contacts += touched.any(1).sum(0)
