"""Measurement files: a table (CSV), and a YAML file that describes it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_positive
from .._core import Sensor, load_sensor
from ..errors import InputError
from ..export.staging import new_file
from .recording import Recording

KINDS = ("images", "stamp_images", "point_images", "footprint_images", "uniform_press", "step_response", "force_curve")
QUANTITIES = ("x_m", "x_mm", "y_m", "y_mm", "yaw_rad", "yaw_deg", "force_N", "force_mN", "pressure_Pa", "pressure_kPa", "press")
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


@dataclass(frozen=True)
class Measurement:
    """What the columns of a recording mean."""

    kind: str  #: One of KINDS.
    sensor: Path  #: Sensor file.
    taxels: str = "r{row}_c{col}"  #: Pattern of the names of the taxels' columns: {row} and {col} of one grid, {taxel} in storage order.
    time: str = ""  #: Column of the time. Its first value becomes 0.
    time_unit: str = "s"
    quantities: Mapping[str, str] = field(default_factory=dict)  #: Columns of positions and forces by their name in the table (QUANTITIES).
    taxel: int | None = None  #: force_curve: the taxel that is pressed.
    falling: bool = False  #: Readings fall with force: counts are what a reading is below the largest one of its taxel.
    scale: float = 1.0  #: Counts per unit of the readings.
    keys: Mapping[str, str] = field(default_factory=dict)  #: Further keys of the YAML file (indenter, load, ...), as text.


def write_measurement(recording: Recording, what: Measurement, out: Path) -> Path:
    """Writes `out` (YAML), and the table next to it with the same name and .csv. Returns the table. Throws InputError and IoError."""
    if what.kind not in KINDS:
        raise InputError(f"measurement: {what.kind!r} is not allowed: {', '.join(KINDS)}")
    if out.suffix != ".yaml":
        raise InputError(f"{out}: a file NAME.yaml expected")
    table = out.with_suffix(".csv")
    for file in (out, table):
        if file.exists():
            raise InputError(f"{file}: exists; choose another output or remove it")
    if not out.parent.is_dir():
        raise InputError(f"{out}: its folder {out.parent} does not exist")
    if what.time_unit not in TIME_UNITS:
        raise InputError(f"time_unit: {what.time_unit!r} is not allowed: {', '.join(TIME_UNITS)}")
    checked_positive("scale", what.scale)
    for key, value in what.keys.items():
        if len(value.splitlines()) != 1:
            raise InputError(f"{key}: {value!r} is not allowed: one line")
    sensor = load_sensor(what.sensor)
    columns = _table_of(recording, what, sensor)
    lines = [",".join(columns), *(",".join(f"{value:.10g}" for value in row) for row in np.stack(list(columns.values()), axis=1))]
    keys = {"measurement": what.kind, "sensor": json.dumps(os.path.relpath(what.sensor, out.parent)), "table": json.dumps(table.name)}
    if len(sensor.patches) > 1 and what.kind not in ("step_response", "force_curve"):
        keys["taxel_columns"] = '"t{taxel}"'
    content = "format_version: 1\n" + "".join(f"{key}: {value}\n" for key, value in {**keys, **what.keys}.items())
    for file, text in ((table, "\n".join(lines) + "\n"), (out, content)):  # the table first: the YAML file makes it a measurement
        with new_file(file) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return table


def _table_of(recording: Recording, what: Measurement, sensor: Sensor) -> dict[str, NDArray[np.float64]]:
    """Columns of the table by name."""
    columns: dict[str, NDArray[np.float64]] = {}
    if what.time:
        times = recording.column(what.time) * TIME_UNITS[what.time_unit]
        if (np.diff(times) <= 0).any():
            row = int(np.argmax(np.diff(times) <= 0)) + 1
            raise InputError(f"{recording.source}: {what.time}: row {row} is not later than the row before; choose one episode, or no time")
        columns["time_s"] = times - times[0]
    for name, source in what.quantities.items():
        if name not in QUANTITIES:
            raise InputError(f"column: {name!r} is not allowed: {', '.join(QUANTITIES)}")
        columns[name] = recording.column(source)
    names = _taxel_names(what.taxels, sensor)
    counts = {name: _counts(recording.column(source), what) for name, source in names.items()}
    if what.kind == "step_response":
        return {**columns, "counts": np.sum(list(counts.values()), axis=0)}
    if what.kind != "force_curve":
        return {**columns, **counts}
    if what.taxel is None or not 0 <= what.taxel < len(names):
        raise InputError(f"taxel: {what.taxel} is not allowed: 0 to {len(names) - 1} for force_curve")
    return {**columns, "taxel": np.full(len(next(iter(counts.values()))), float(what.taxel)), "counts": counts[list(names)[what.taxel]]}


def _taxel_names(pattern: str, sensor: Sensor) -> dict[str, str]:
    """Columns of the recording by names of the table, in storage order."""
    if len(sensor.patches) > 1:
        return {f"t{index}": _filled(pattern, taxel=index) for index in range(sensor.num_taxels)}
    grid = sensor.patches[0]
    places = [(row, col) for row in range(grid.num_rows) for col in range(grid.num_cols)]
    return {f"r{row}_c{col}": _filled(pattern, row=row, col=col, taxel=index) for index, (row, col) in enumerate(places)}


def _filled(pattern: str, **values: int) -> str:
    try:
        name = pattern.format(**values)
    except (LookupError, ValueError) as error:
        raise InputError(f"taxels: {pattern!r} is not allowed: {{{'}, {'.join(values)}}}") from error
    if name == pattern:
        raise InputError(f"taxels: {pattern!r} found; it names one column: use {{{'}, {'.join(values)}}}")
    return name


def _counts(readings: NDArray[np.float64], what: Measurement) -> NDArray[np.float64]:
    return (readings.max() - readings if what.falling else readings) * what.scale
