"""`taxelsim export DIR --format NAME -o OUT`: writes a data set in the format of another tool."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path

from ..export import FORMATS, Options, export
from ..progress_line import ProgressLine
from .running import run_command


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    options = _parser().parse_args(arguments)
    return run_command("export", lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    progress = ProgressLine("frames")
    try:
        source = export(options.folder, options.out, options.format, _options_of(options), progress.show)
    except KeyboardInterrupt:
        progress.end()
        print(f"taxelsim export: interrupted; run the same command again, {options.out} is not complete", file=sys.stderr)
        raise
    finally:
        progress.end()
    print(f"{options.out}: {source.num_episodes:,} episodes, {source.num_frames:,} frames, format {options.format}")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim export", description=__doc__)
    add = parser.add_argument
    formats = "; ".join(f"{name}: {chosen.description}" for name, chosen in FORMATS.items())
    add("folder", metavar="DIR", help="folder of a complete data set")
    add("--format", required=True, metavar="NAME", help=formats)
    add("-o", "--out", required=True, type=Path, metavar="OUT", help="must not exist; called OUT.incomplete until it is complete")
    add("--episodes", type=_range, metavar="A..B", help="only these episodes, both ends included; default: all")
    add("--sensor", metavar="NAME", help="exports only this sensor of a data set of kind grasp; default: all")
    add("--state", type=_names, default=(), metavar="NAMES", help="columns of the state; default: joint positions and pose of the sensor")
    add("--columns", type=_names, default=(), metavar="NAMES", help="further columns, e.g. data/total_force,data/center_of_pressure")
    add("--tactile-in-state", action="store_true", help="appends the tactile image to the state, for policies that read nothing else")
    add(
        "--task",
        default=Options.task,
        metavar="TEXT",
        help="lerobot, oxt: text of the task, with {scene} and {object}; default %(default)r",
    )
    add("--tactile-key", default=Options.tactile_key, metavar="NAME", help="lerobot: name of the tactile image, default %(default)s")
    add("--video", action="store_true", help="lerobot: the tactile image as a video as well, of three-axis taxels with arrows")
    add("--range", type=float, metavar="COUNTS", help="lerobot, oxt: brightest colour; default: 99.9th percentile of the data set")
    add(
        "--assets",
        action="append",
        default=[],
        metavar="DIR",
        help="lerobot --video, oxt: folder that holds a taxel mesh or URDF of the scene",
    )
    add(
        "--frame-rate", type=float, metavar="HZ", help="lerobot: frames/s; touch at the rate of the data set becomes a window of each frame"
    )
    add("--layout", default=Options.layout, metavar="NAME", help="lerobot: points adds place, normal and force of each taxel")
    add("--wrench", action="store_true", help="lerobot: adds the wrench of contact")
    add("--place", type=_names, default=(), metavar="SENSOR=[SIDE:]AREA", help="oxt: functional areas of sensors, e.g. left=0,right=1")
    add("--joints", type=_names, default=(), metavar="NAMES", help="oxt: NAME of the arm, NAME=SLOT of the hand, e.g. jaw=28; or none")
    add("--wrist", type=_names, default=(), metavar="SENSORS", help="oxt: sensors whose poses stand for the wrists")
    add("--camera", default=Options.camera, metavar="NAME", help="oxt: RGB stream, arrays (default) or scene, which is slow")
    add("--zarr-format", type=int, default=2, metavar="N", help="zarr: version of the format, 2 (default) or 3, which has shards")
    add("--next-observations", action="store_true", help="robomimic: writes next_obs, which offline reinforcement learning needs")
    return parser


def _options_of(options: argparse.Namespace) -> Options:
    return Options(
        episodes=options.episodes,
        sensor=options.sensor,
        state=options.state,
        columns=options.columns,
        tactile_in_state=options.tactile_in_state,
        task=options.task,
        tactile_key=options.tactile_key,
        video=options.video,
        range=options.range,
        assets=tuple(options.assets),
        frame_rate=options.frame_rate,
        layout=options.layout,
        wrench=options.wrench,
        place=options.place,
        joints=options.joints,
        wrist=options.wrist,
        camera=options.camera,
        zarr_format=options.zarr_format,
        next_observations=options.next_observations,
    )


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(","))


def _range(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d+)\.\.(\d+)", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not allowed: a range such as 0..99")
    return int(found[1]), int(found[2])
