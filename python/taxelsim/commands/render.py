"""`taxelsim render DIR --episode N -o FILE`: a video of an episode, MP4 or GIF, of the pictures of its WebP."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from .._arguments import checked_positive
from .._log import logger
from .._pictures import EpisodePictures
from ..errors import InputError
from ..program import SCENES
from ..video import MAX_RATES, check_video, save_video
from .running import run_command

_ROUNDING = 1e-6  # relative, of the time between two frames


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    options = _parser().parse_args(arguments)
    return run_command("render", lambda: _run(options))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim render", description=__doc__)
    add = parser.add_argument
    add("folder", metavar="DIR", help="data set")
    add("-o", "--output", required=True, type=Path, metavar="FILE", help="video to write: .mp4 or .gif; .png draws a picture of frames")
    add("--episode", required=True, type=int, metavar="N", help="number of the episode")
    add("--sensor", default="", metavar="NAME", help="sensor to draw, where columns are grouped by sensor; default: the first")
    add("--speed", type=float, default=1.0, metavar="X", help="1 (default) is real time, 0.1 ten times slower")
    add("--assets", type=Path, action="append", default=[], metavar="DIR", help="folder with meshes of the scene; repeatable")
    add("--range", type=float, metavar="COUNTS", help="brightest colour; default: the 99.9th percentile of the data set")
    return parser


def _run(options: argparse.Namespace) -> None:
    speed = checked_positive("--speed", options.speed)
    scale = 0.0 if options.range is None else checked_positive("--range", options.range)
    if not 0 <= options.episode < 1 << 64:
        raise InputError(f"--episode {options.episode}: {options.folder} has no such episode")
    check_video(options.output)
    pictures = EpisodePictures(options.folder, options.episode, scale, [*map(str, options.assets), str(SCENES)], options.sensor)
    if pictures.without_view:
        logger.warning("%s: shows the tactile image alone: %s", options.output, pictures.without_view)
    times = pictures.times()
    step = times[1] - times[0] if len(times) > 1 else math.inf
    if not step > 0:
        raise InputError(f"{options.folder}: data/time of episode {options.episode} does not increase")
    # Every n-th frame, so that players leave out none.
    stride = max(1, math.ceil(min(speed / MAX_RATES[options.output.suffix] / step * (1 - _ROUNDING), len(times))))
    frames = range(0, len(times), stride)
    if len(frames) < 2:
        raise InputError(f"--episode {options.episode}: shows one frame, which is no video; -o FILE.png draws it")
    seconds = (times[stride] - times[0]) / speed
    count = save_video(options.output, map(pictures.draw, frames), 1 / seconds)
    print(f"{options.output}: {count} frames, {count * seconds:.3g} s")
