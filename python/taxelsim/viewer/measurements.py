"""A measurement of a real sensor, as an episode of the viewer."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from .._core import load_sensor
from ..errors import InputError
from ..pictures import TACTILE_IMAGE
from ..recordings.measurement import DEFAULT_TAXELS, IMAGE_KINDS, TIME_UNITS, taxel_names
from ..recordings.tables import read_csv
from .scene_files import sha256_of
from .source import Episode

_KEY = re.compile(r'^(\w+): *("[^"\n]*"|[^#\n]*?) *(?:#.*)?$', re.MULTILINE)
_BRIGHTEST = 99.9  # percentile of all counts


def is_measurement(path: Path) -> bool:
    """Whether a file describes a measurement."""
    return path.is_file() and "measurement" in _keys(path)


def _keys(file: Path) -> dict[str, str]:
    """Keys of the first level of a YAML file that have a value on their line."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return {}
    return {key: value.strip('"') for key, value in _KEY.findall(text)}


def open_measurement(file: Path, range: float | None) -> tuple[Episode, Mapping[str, float]]:
    """All images of a measurement, and the counts of the brightest colour by column. range: these counts; None: from the images.

    Throws InputError for a measurement without images, and for one whose sensor is not a file.
    """
    keys = _keys(file)
    if keys["measurement"] not in IMAGE_KINDS:
        raise InputError(f"{file}: measurement: {keys['measurement']!r} has no images to view: {', '.join(IMAGE_KINDS)}")
    for key in ("sensor", "table"):
        if not keys.get(key) or keys[key].startswith("{"):
            raise InputError(f"{file}: {key}: the name of a file is needed to view a measurement")
    table = file.parent / keys["table"]
    sensor, recording = load_sensor(file.parent / keys["sensor"]), read_csv(table)
    if keys.get("sha256") not in (None, sha256_of(table)):
        raise InputError(f"{table}: its SHA-256 is not that in {file}")
    taxels = taxel_names(keys.get("taxel_columns", DEFAULT_TAXELS), sensor)
    others = [name for name in recording.names if name not in taxels.values()]
    blocks = list(recording.blocks((*taxels.values(), *others)))
    limit = sensor.readout.saturation
    images = [np.stack([block[name] for name in taxels.values()], axis=1).clip(0, limit).round().astype(np.uint16) for block in blocks]
    columns = {f"data/{name}": np.concatenate([block[name] for block in blocks]) for name in others}
    for unit, seconds in TIME_UNITS.items():
        if f"data/time_{unit}" in columns:
            columns["data/time"] = columns.pop(f"data/time_{unit}") * seconds
    columns[TACTILE_IMAGE] = np.concatenate(images)
    episode = Episode(0, columns, sensor)
    columns["data/total_force"] = episode.forces.sum(axis=(1, 2))
    largest = float(np.percentile(columns[TACTILE_IMAGE], _BRIGHTEST)) if range is None else range
    return episode, {TACTILE_IMAGE: max(largest, 1.0)}
