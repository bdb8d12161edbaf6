"""Measurement files: a table (CSV), and a YAML file that describes it."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._arguments import checked_positive
from .._core import Sensor, load_sensor
from ..errors import InputError
from ..export.staging import new_file
from .recording import Block, Recording

KINDS = ("images", "stamp_images", "point_images", "footprint_images", "uniform_press", "step_response", "force_curve")
IMAGE_KINDS = KINDS[:5]  # rows of the table are images
DEFAULT_TAXELS = "r{row}_c{col}"
QUANTITIES = ("x_m", "x_mm", "y_m", "y_mm", "yaw_rad", "yaw_deg", "force_N", "force_mN", "pressure_Pa", "pressure_kPa", "press")
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
COUNTS = "counts"


@dataclass(frozen=True)
class Measurement:
    """What the columns of a recording mean."""

    kind: str  #: One of KINDS.
    sensor: Path  #: Sensor file.
    taxels: str = DEFAULT_TAXELS  #: Pattern of the names of the taxels' columns: {row} and {col} of one grid, {taxel} in storage order.
    time: str = ""  #: Column of the time. Its first value becomes 0.
    time_unit: str = ""  #: One of TIME_UNITS. Empty: as the recording states it, or as the name of the column ends, such as time_ms.
    quantities: Mapping[str, str] = field(
        default_factory=dict
    )  #: Columns of positions and forces by their name in the table (QUANTITIES); with a minus in front the other sign.
    taxel: int | None = None  #: force_curve: the taxel that is pressed.
    falling: bool = False  #: Readings fall with force: counts are what a reading is below the largest one of its taxel.
    unit: str = ""  #: Unit of the readings: counts, or another one with a scale. Empty: the recording states it.
    scale: float | None = None  #: Counts per unit of the readings. None: 1, for readings in counts.
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
    for key, value in what.keys.items():
        if len(value.splitlines()) != 1:
            raise InputError(f"{key}: {value!r} is not allowed: one line")
    sensor = load_sensor(what.sensor)
    rows = _Table(recording, what, sensor).rows()
    keys = {"measurement": what.kind, "sensor": json.dumps(os.path.relpath(what.sensor, out.parent)), "table": json.dumps(table.name)}
    if len(sensor.patches) > 1 and what.kind not in ("step_response", "force_curve"):
        keys["taxel_columns"] = '"t{taxel}"'
    content = "format_version: 1\n" + "".join(f"{key}: {value}\n" for key, value in {**keys, **what.keys}.items())
    with new_file(table) as temporary, temporary.open("w", encoding="utf-8") as stream:
        for number, block in enumerate(rows):
            if number == 0:
                stream.write(",".join(block) + "\n")
            np.savetxt(stream, np.stack(list(block.values()), axis=1), fmt="%.10g", delimiter=",")
        stream.flush()
    with new_file(out) as temporary:  # after the table: the YAML file makes it a measurement
        temporary.write_text(content, encoding="utf-8")
    return table


class _Table:
    """The table of a measurement, in blocks of rows."""

    def __init__(self, recording: Recording, what: Measurement, sensor: Sensor) -> None:
        """Throws InputError for columns and units that the recording does not have."""
        self._recording, self._what = recording, what
        self._taxels = taxel_names(what.taxels, sensor)
        wrong = next((name for name in what.quantities if name not in QUANTITIES), None)
        if wrong is not None:
            raise InputError(f"column: {wrong!r} is not allowed: {', '.join(QUANTITIES)}")
        if what.kind == "force_curve" and (what.taxel is None or not 0 <= what.taxel < len(self._taxels)):
            raise InputError(f"taxel: {what.taxel} is not allowed: 0 to {len(self._taxels) - 1} for force_curve")
        self._seconds = TIME_UNITS[_time_unit(recording, what)] if what.time else 0.0
        self._scale = _scale(recording, what, next(iter(self._taxels.values())))
        self._quantities = {
            name: (source.removeprefix("-"), -1.0 if source.startswith("-") else 1.0) for name, source in what.quantities.items()
        }
        time = [what.time] if what.time else []
        self._columns = tuple(dict.fromkeys((*time, *(source for source, _ in self._quantities.values()), *self._taxels.values())))

    def rows(self) -> Iterator[Block]:
        """Columns of the table by name. Reads a recording with falling readings twice, for the largest reading of each taxel."""
        largest: dict[str, float] = {}
        if self._what.falling:
            for block in self._recording.blocks(tuple(self._taxels.values())):
                largest = {name: max(largest.get(name, -np.inf), float(values.max())) for name, values in block.items()}
        times: tuple[float, float, int] | None = None  # of the first and of the last row, and number of rows so far
        for block in self._recording.blocks(self._columns):
            columns: Block = {}
            if self._what.time:
                found = block[self._what.time] * self._seconds
                first, last, rows = times or (float(found[0]), -np.inf, 0)
                falls = np.flatnonzero(np.diff(found, prepend=last) <= 0)
                if len(falls):
                    raise InputError(
                        f"{self._recording.source}: {self._what.time}: row {rows + falls[0]} is not later than the row before; "
                        "choose one episode, or no time"
                    )
                times = first, float(found[-1]), rows + len(found)
                columns["time_s"] = found - first
            columns |= {name: sign * block[source] for name, (source, sign) in self._quantities.items()}
            counts = {name: self._counts(block[source], largest.get(source)) for name, source in self._taxels.items()}
            yield columns | self._readings(counts)

    def _counts(self, readings: NDArray[np.float64], largest: float | None) -> NDArray[np.float64]:
        return (readings if largest is None else largest - readings) * self._scale

    def _readings(self, counts: Block) -> Block:
        """Columns with the readings, for the kind of measurement."""
        if self._what.kind == "step_response":
            return {"counts": np.sum(list(counts.values()), axis=0)}
        if self._what.kind != "force_curve":
            return counts
        pressed = counts[list(counts)[self._what.taxel or 0]]
        return {"taxel": np.full(len(pressed), float(self._what.taxel or 0)), "counts": pressed}


def _time_unit(recording: Recording, what: Measurement) -> str:
    stated = recording.unit_of(what.time) or next((unit for unit in TIME_UNITS if what.time.endswith(f"_{unit}")), "")
    unit = what.time_unit or stated
    if not unit:
        raise InputError(f"{recording.source}: the unit of {what.time} is not stated: --time-unit {', '.join(TIME_UNITS)}")
    if unit not in TIME_UNITS:
        raise InputError(f"time_unit: {unit!r} is not allowed: {', '.join(TIME_UNITS)}")
    return unit


def _scale(recording: Recording, what: Measurement, taxel: str) -> float:
    """Counts per unit of the readings."""
    stated = recording.unit_of(taxel)
    unit = what.unit or stated
    if not unit:
        raise InputError(f"{recording.source}: the unit of {taxel} is not stated: --unit counts, or another one with --scale")
    if stated and unit != stated:
        raise InputError(f"{recording.source}: unit: {unit!r} is not allowed: {taxel} is in {stated}")
    if what.scale is None and unit != COUNTS:
        raise InputError(f"{recording.source}: {taxel} is in {unit}: --scale, counts per {unit}, is needed")
    return 1.0 if what.scale is None else checked_positive("scale", what.scale)


def taxel_names(pattern: str, sensor: Sensor) -> dict[str, str]:
    """Columns of the recording by names of the table, in storage order. Throws InputError."""
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
