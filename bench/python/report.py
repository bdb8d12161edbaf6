"""Description of the machine and statistics in result files, as bench/report.h writes them."""

from __future__ import annotations

import json
import os
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import taxelsim

ROOT = Path(__file__).parents[2]
_ENVIRONMENT = ("LP_NATIVE_VECTOR_WIDTH", "LP_NUM_THREADS", "VK_ICD_FILENAMES", "TAXELSIM_PLAIN", "TAXELSIM_VALIDATION")


def machine(device: taxelsim.Device) -> dict[str, Any]:
    """Device, driver, processor, number of cores, version, and environment variables that affect a driver."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return {
        "device": device.info.name,
        "driver": device.info.driver,
        "cpu": next((line.split(": ", 1)[1] for line in lines if line.startswith("model name")), "unknown"),
        "cores": os.cpu_count(),
        "taxelsim": taxelsim.__version__,
        # File names only: paths of a machine are irrelevant.
        "environment": {name: Path(os.environ[name]).name for name in _ENVIRONMENT if name in os.environ},
    }


def lowest_height(shape: Any, rotation: Sequence[float]) -> float:
    """Height (m) of the lowest point of an object with this rotation (w, x, y, z) over its origin."""
    w, x, y, z = rotation
    row = (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))
    point = taxelsim.lowest_point(shape, [float(value) for value in rotation])  # in the object's frame
    return sum(a * b for a, b in zip(row, point, strict=True))


def summary(values: Sequence[float]) -> dict[str, Any]:
    """Median, minimum, maximum and all values."""
    return {"median": statistics.median(values), "min": min(values), "max": max(values), "all": list(values)}


def ratio(values: Sequence[float], references: Sequence[float]) -> float:
    """Median of the ratios within a turn."""
    return statistics.median(value / reference for value, reference in zip(values, references, strict=True))


def write_json(file: Path | None, results: dict[str, Any]) -> None:
    """Writes `results`, if there is a file."""
    if file:
        file.write_text(json.dumps(results, indent=2) + "\n")
