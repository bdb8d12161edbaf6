"""An export from the data set to the complete output."""

from __future__ import annotations

import dataclasses
import importlib
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from .. import __version__
from .._arguments import checked_positive
from ..errors import InputError
from .options import Options
from .source import Source

OnProgress = Callable[[int, int], object]  # frames done, frames of the export


@dataclass(frozen=True)
class Format:
    """A format: which module of this package writes it, and what that needs."""

    module: str
    packages: tuple[str, ...]  #: That are imported.
    options: tuple[str, ...]  #: Fields of Options that it has in addition to episodes.
    description: str


_VECTORS = ("state", "columns", "tactile_in_state")

FORMATS = {
    "lerobot": Format(
        "lerobot",
        ("pyarrow",),
        (*_VECTORS, "task", "tactile_key", "video", "range", "assets", "frame_rate", "layout", "wrench"),
        "a folder: LeRobotDataset v3.0",
    ),
    "zarr": Format("replay_buffer", ("zarr",), (*_VECTORS, "zarr_format"), "a folder: data/ and meta/episode_ends, as in Diffusion Policy"),
    "oxt": Format(
        "oxt",
        ("zarr",),
        ("columns", "task", "range", "assets", "place", "joints", "wrist", "camera"),
        "a folder: Open-X-Tactile, Zarr 2 as FTP-1 reads it",
    ),
    "robomimic": Format("robomimic", ("h5py",), (*_VECTORS, "next_observations"), "a file: HDF5 with data/demo_N"),
    "mcap": Format("ros2", ("mcap_ros2",), (), "a folder: one MCAP file with ROS 2 messages per episode"),
}


def export(
    folder: str | os.PathLike[str],
    out: str | os.PathLike[str],
    format_name: str,
    options: Options | None = None,
    on_progress: OnProgress | None = None,
) -> Source:
    """Exports a complete data set.

    folder: the data set; its checksums are verified.
    out: does not exist, or is an empty folder. Until it is complete it is called OUT.incomplete; the same export continues there.
    format_name: name of FORMATS.
    on_progress: called with the number of frames that are done and that of all.

    Throws InputError for bad input, a damaged data set, numbers that are not finite; IoError if the file system refuses; ImportError if a
    package is missing.
    """
    options = options or Options()
    chosen = _checked(format_name, options)
    _check_packages(format_name, (*chosen.packages, "av") if options.video else chosen.packages)
    source = Source(folder, options)
    done = 0

    def report(frames: int) -> None:
        nonlocal done
        done += frames
        if on_progress is not None:
            on_progress(done, source.num_frames)

    plan = {
        "taxelsim": __version__,
        "format": format_name,
        "options": dataclasses.asdict(options),
        "data set": {**source.identity(), "columns": list(source.data.columns)},
    }
    importlib.import_module(f".{chosen.module}", __package__).write(source, Path(out).absolute(), plan, report)
    return source


def _checked(format_name: str, options: Options) -> Format:
    if format_name not in FORMATS:
        raise InputError(f"format: {format_name!r} is not allowed: {', '.join(FORMATS)}")
    chosen = FORMATS[format_name]
    for field in dataclasses.fields(Options):
        if field.name not in ("episodes", "sensor", *chosen.options) and getattr(options, field.name) != field.default:
            raise InputError(f"{field.name}: not an option of format {format_name}")
    if options.range is not None:
        checked_positive("range", options.range)
        if "video" in chosen.options and not options.video:
            raise InputError("range: needs video")
    if options.zarr_format not in (2, 3):
        raise InputError(f"zarr_format: {options.zarr_format} is not allowed: 2 and 3")
    return chosen


def _check_packages(format_name: str, packages: Iterable[str]) -> None:
    for package in packages:
        try:
            importlib.import_module(package)
        except ImportError as error:
            raise ImportError(f"format {format_name} needs the package {package}: pip install 'taxelsim[export]'") from error
