"""Policies: any function of a batch of observations, and networks in ONNX files."""

from .actions import ACTIONS, COMMANDS
from .batching import PaddedPolicy, independent_of_batch, rows_depend_on_batch
from .observations import FEATURES, OBSERVATIONS, SCALES
from .onnx import OnnxPolicy
from .policy import Policy
from .statistics import Comparison, compare, wilson_interval

__all__ = [
    "ACTIONS",
    "COMMANDS",
    "FEATURES",
    "OBSERVATIONS",
    "SCALES",
    "Comparison",
    "OnnxPolicy",
    "PaddedPolicy",
    "Policy",
    "compare",
    "independent_of_batch",
    "rows_depend_on_batch",
    "wilson_interval",
]
