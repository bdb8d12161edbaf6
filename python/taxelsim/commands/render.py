"""`taxelsim render DIR|SCENE --episode N -o FILE`: a video of an episode, MP4 or GIF, with all sensors of a hand."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from .._arguments import checked_positive
from .._core import DatasetReader, Device, load_scene
from .._log import logger
from .._pictures import EpisodePictures
from ..dataset.layout import sensors_of
from ..errors import InputError
from ..program import SCENES
from ..video import MAX_RATES, check_video, grid_of, save_video
from ..viewer.source import simulated
from .running import run_command

_ROUNDING = 1e-6  # relative, of the time between two frames
_MAX_WIDTH = 1920  # pixels, of a grid of sensors


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    options = _parser().parse_args(arguments)
    return run_command("render", lambda: _run(options))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim render", description=__doc__)
    add = parser.add_argument
    add("source", type=Path, metavar="DIR|SCENE", help="data set, or scene file: the episode is simulated and not kept")
    add("-o", "--output", required=True, type=Path, metavar="FILE", help="video to write: .mp4 or .gif; .png draws a picture of frames")
    add("--episode", required=True, type=int, metavar="N", help="number of the episode")
    add("--sensor", default="", metavar="NAME", help="sensor to draw, where columns are grouped by sensor; default: all")
    add("--speed", type=float, default=1.0, metavar="X", help="1 (default) is real time, 0.1 ten times slower")
    add("--assets", type=Path, action="append", default=[], metavar="DIR", help="folder with meshes of the scene; repeatable")
    add("--device", default="", metavar="NAME", help='simulates a scene: "cpu", "discrete", an index, or part of a name; default: the best')
    add("--range", type=float, metavar="COUNTS", help="brightest colour; default: the 99.9th percentile of the data set")
    return parser


def _run(options: argparse.Namespace) -> None:
    if not 0 <= options.episode < 1 << 64:
        raise InputError(f"--episode {options.episode}: {options.source} has no such episode")
    for name in ("speed", "range"):
        if (value := getattr(options, name)) is not None:
            checked_positive(f"--{name}", value)
    check_video(options.output)
    if not options.source.is_file():
        _draw(options, options.source, options.assets)
        return
    with simulated(load_scene(options.source), [options.episode], Device.open(options.device)) as folder:
        _draw(options, folder, [*options.assets, options.source.parent])


def _draw(options: argparse.Namespace, folder: Path, assets: Sequence[Path]) -> None:
    """Writes the video. folder: the data set. assets: folders with meshes of its scene, in addition to those of the package."""
    names, scale = _sensors_of(folder, options.sensor)
    scale = scale if options.range is None else options.range
    found = [EpisodePictures(str(folder), options.episode, scale, [*map(str, assets), str(SCENES)], name) for name in names]
    if missing := next((pictures.without_view for pictures in found if pictures.without_view), ""):
        logger.warning("%s: shows the tactile image alone: %s", options.output, missing)
    times = found[0].times()
    step = times[1] - times[0] if len(times) > 1 else math.inf
    if not step > 0:
        raise InputError(f"{options.source}: data/time of episode {options.episode} does not increase")
    # Every n-th frame, so that players leave out none.
    stride = max(1, math.ceil(min(options.speed / MAX_RATES[options.output.suffix] / step * (1 - _ROUNDING), len(times))))
    frames = range(0, len(times), stride)
    if len(frames) < 2:
        raise InputError(f"--episode {options.episode}: shows one frame, which is no video; -o FILE.png draws it")
    seconds = (times[stride] - times[0]) / options.speed
    drawn = (grid_of([pictures.draw(frame) for pictures in found], _MAX_WIDTH) for frame in frames)
    count = save_video(options.output, drawn, 1 / seconds)
    print(f"{options.output}: {count} frames, {count * seconds:.3g} s")


def _sensors_of(folder: Path, chosen: str) -> tuple[Sequence[str], float]:
    """Names of the sensors to draw, and the counts of the brightest colour of all of them; 0 for one sensor, which has its own."""
    reader = DatasetReader(folder, isolated=True)
    columns = [column.name for column in reader.columns]
    names = sensors_of(columns)
    if chosen or not names:
        return [chosen], 0.0
    shown = [next(name for name in (f"data/{sensor}/taxel_counts", f"data/{sensor}/tactile_image") if name in columns) for sensor in names]
    return names, max(map(reader.counts_range, shown))
