"""Sensors from places and normals of taxels."""

from __future__ import annotations

from os import PathLike

import numpy as np
import numpy.typing as npt

from .._arrays import to_array
from .._core import Sensor, check_sensor, load_sensor, taxel_patch
from ..errors import InputError
from ..program import SCENES
from .surface import Array

LIKE = SCENES / "sensors/fingertip_cylinder.yaml"
"""Sensor that gives skin, spread and electronics where none is named: a generic fingertip of 2.3 x 2.5 mm taxels."""

MAX_TAXELS = 4096
MAX_SPAN = 1.0  # m; the arrays of a hand or foot span less, in millimetres they span more
SAME_PLACE = 1e-6  # m

SensorLike = str | PathLike[str] | Sensor


def sensor_of(
    positions: npt.ArrayLike,
    normals: npt.ArrayLike,
    size: float | tuple[float, float] | None = None,
    *,
    name: str = "pattern",
    like: SensorLike = LIKE,
) -> Sensor:
    """A sensor of taxels with individual places.

    positions: (T, 3), m, middles of the taxels in S, on the undeformed outer skin; 1 to 4096 taxels.
    normals: (T, 3), directions out of the skin, of any length but 0.
    size: m, side of a taxel, or sides along its x and y; default: the median distance of a taxel from its nearest neighbour.
    like: sensor file, or Sensor, that gives skin, point spread function, readout, frame rate and samples per taxel.
        `gaussian` and `kernel` spread no force between such taxels, `skin_gaussian` does.

    Raises InputError for coordinates that span more than a metre, a normal of length 0, two taxels at one place, and settings of `like`
    that do not fit the taxels.
    """
    places = to_array("positions", positions, np.float64, [[(-1, "T"), 3]], per_instance=False)
    outward = to_array("normals", normals, np.float64, [[(len(places), "T"), 3]], per_instance=False)
    _check(places, outward)
    if size is None:
        if len(places) < 2:
            raise InputError("size: None is not allowed for one taxel: its side in m")
        size = float(np.median(nearest_distances(places)[0]))
    patches = [taxel_patch(f"taxel_{i}", list(p), list(n), size) for i, (p, n) in enumerate(zip(places, outward, strict=True))]
    template = like if isinstance(like, Sensor) else load_sensor(like)
    sensor = template.replace(name=name, patches=patches)
    check_sensor(sensor)
    return sensor


def _check(places: Array, normals: Array) -> None:
    if not 1 <= len(places) <= MAX_TAXELS:
        raise InputError(f"positions: {len(places)} taxels are not allowed: 1 to {MAX_TAXELS}")
    span = float(np.ptp(places, axis=0).max())
    if span > MAX_SPAN:
        raise InputError(f"positions: a span of {span:g} m is not allowed: at most {MAX_SPAN:g} m; other units than metres must be named")
    lengths = np.linalg.norm(normals, axis=1)
    if lengths.min() == 0:
        raise InputError(f"normals: length 0 of taxel {int(lengths.argmin())} is not allowed: a direction out of the skin")
    if len(places) > 1:
        distances, others = nearest_distances(places)
        if distances.min() < SAME_PLACE:
            first = int(distances.argmin())
            raise InputError(f"positions: taxels {first} and {int(others[first])} at one place are not allowed: at least 1 um apart")


def nearest_distances(places: Array) -> tuple[Array, npt.NDArray[np.intp]]:
    """Distance (T), m, of each taxel from its nearest neighbour, and the index (T) of that neighbour."""
    distances, others = np.empty(len(places)), np.empty(len(places), np.intp)
    for i, place in enumerate(places):  # one row at a time bounds the memory
        row = np.linalg.norm(places - place, axis=1)
        row[i] = np.inf
        others[i] = row.argmin()
        distances[i] = row[others[i]]
    return distances, others
