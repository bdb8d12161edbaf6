"""Data sets on disk (docs/reference/data_set.md). Needs the package h5py."""

from .column import Column
from .dataset import Dataset
from .windows import Windows

__all__ = ["Column", "Dataset", "Windows"]
