"""Data sets on disk (docs/data_set.md). Needs the package h5py."""

from .column import Column
from .dataset import Dataset
from .windows import Windows

__all__ = ["Column", "Dataset", "Windows"]
