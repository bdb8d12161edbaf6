"""Exports of data sets to the formats of other tools (docs/how_to/export.md): LeRobot, Zarr, robomimic, MCAP."""

from .options import Options
from .run import FORMATS, Format, export

__all__ = ["FORMATS", "Format", "Options", "export"]
