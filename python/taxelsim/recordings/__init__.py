"""Recordings of real sensors as measurements for `characterize` and `compare` (docs/reference/measurements.md)."""

from .bags import read_bag
from .lerobot import read_lerobot
from .measurement import KINDS, Measurement, write_measurement
from .open_x_tactile import read_oxt
from .recording import Recording
from .robomimic import read_robomimic
from .tables import read_csv

__all__ = ["KINDS", "Measurement", "Recording", "read_bag", "read_csv", "read_lerobot", "read_oxt", "read_robomimic", "write_measurement"]
