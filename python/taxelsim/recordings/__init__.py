"""Recordings of real sensors as measurements for `characterize` and `compare` (docs/reference/measurements.md)."""

from .measurement import KINDS, Measurement, write_measurement
from .recording import Recording, read_csv, read_lerobot

__all__ = ["KINDS", "Measurement", "Recording", "read_csv", "read_lerobot", "write_measurement"]
