"""Patterns of taxels: from arrays and files of places and normals, on shapes, and on links of a URDF.

>>> from taxelsim import patterns
>>> sensor = patterns.load_pattern("glove.csv", unit="mm")
>>> placed = patterns.cover_shape(taxelsim.Capsule(radius=0.008, length=0.01), pitch=0.002, direction=(1, 0, 0))
>>> patterns.draw(placed.sensor)  # (height, width, 3), views along three axes
"""

from .drawing import draw
from .files import load_pattern
from .links import cover_link, grid_on_link
from .placement import Placed, cover_shape, grid_on_shape
from .taxels import sensor_of

__all__ = ["Placed", "cover_link", "cover_shape", "draw", "grid_on_link", "grid_on_shape", "load_pattern", "sensor_of"]
