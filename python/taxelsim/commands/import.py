"""`taxelsim import SOURCE --sensor FILE --measurement KIND -o NAME.yaml`: a measurement for `characterize` and `compare`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ..errors import InputError
from ..recordings import KINDS, Measurement, Recording, read_bag, read_csv, read_lerobot, read_oxt, read_robomimic, write_measurement
from ..recordings.measurement import QUANTITIES, TIME_UNITS
from .running import run_command


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    options = _parser().parse_args(arguments)
    return run_command("import", lambda: _run(options))


KEYS = ("indenter", "load", "fixture", "mask", "pixel_mm", "temperature_degC")  # of the measurement file that options give


def _run(options: argparse.Namespace) -> None:
    recording = _recording(options)
    keys = {key: getattr(options, key) for key in KEYS if getattr(options, key) is not None}
    what = Measurement(
        kind=options.measurement,
        sensor=options.sensor,
        taxels=options.taxels,
        time=options.time or "",
        time_unit=options.time_unit or "",
        quantities=dict(options.column),
        taxel=options.taxel,
        falling=options.falling,
        unit=options.unit or "",
        scale=options.scale,
        keys=keys,
    )
    table = write_measurement(recording, what, options.out)
    print(f"wrote {options.out} and {table}")


def _recording(options: argparse.Namespace) -> Recording:
    """The recording of a folder or file, by what it holds."""
    source, episode = options.source, options.episode
    if not source.exists():
        raise InputError(f"{source}: no such file or folder")
    if options.topic and not is_bag(source):
        raise InputError("--topic: for bags of ROS only")
    if options.window and not (source / "meta/info.json").exists():
        raise InputError("--window: for folders of a LeRobotDataset only")
    if (source / ".zgroup").exists() or (source / "zarr.json").exists():
        return read_oxt(source, episode)
    if is_bag(source):
        if episode is not None:
            raise InputError("--episode: not for bags of ROS")
        return read_bag(source, options.topic)
    if source.suffix in (".hdf5", ".h5"):
        return read_robomimic(source, episode)
    if source.is_dir():
        return read_lerobot(source, episode, options.window)
    if episode is not None:
        raise InputError("--episode: not for CSV files")
    return read_csv(source, options.delimiter)


def is_bag(source: Path) -> bool:
    """Whether a path names a bag of ROS: MCAP, rosbag of ROS 1, or the folder of a rosbag2."""
    return source.suffix in (".mcap", ".bag") or (source / "metadata.yaml").exists()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim import", description=__doc__)
    add = parser.add_argument
    add(
        "source",
        metavar="SOURCE",
        type=Path,
        help="CSV, robomimic (.hdf5), MCAP or rosbag; folder of a rosbag2, a LeRobotDataset or Open-X-Tactile",
    )
    add("--sensor", required=True, type=Path, metavar="FILE", help="sensor file: the layout of the taxels")
    add("--measurement", required=True, metavar="KIND", help=f"one of {', '.join(KINDS)}")
    add("-o", "--out", required=True, type=Path, metavar="NAME.yaml", help="measurement to write; its table is NAME.csv")
    add("--taxels", default=Measurement.taxels, metavar="PATTERN", help="columns of the taxels, default %(default)s; also {taxel}")
    add("--episode", type=int, metavar="N", help="one episode, default all")
    add("--topic", action="append", default=[], metavar="NAME", help="bags: each message of the first is a row; repeatable")
    add("--window", action="append", default=[], metavar="FEATURE", help="LeRobotDataset: a feature whose first axis is time; repeatable")
    add("--time", metavar="COLUMN", help="column of the time; default none")
    add("--time-unit", choices=TIME_UNITS, help="default: as the recording states it, or as the name of the column ends (time_ms)")
    add("--column", type=_column, action="append", default=[], metavar="NAME=COLUMN", help=f"NAME: {', '.join(QUANTITIES)}; repeatable")
    add("--taxel", type=int, metavar="N", help="force_curve: the taxel that is pressed, in storage order")
    add("--falling", action="store_true", help="readings fall with force, as of a voltage divider")
    add("--unit", metavar="UNIT", help="of the readings: counts, or another one with --scale; default: as the recording states it")
    add("--scale", type=float, metavar="X", help="counts per unit of the readings; 1 for counts")
    add("--delimiter", default=",", metavar="C", help="of the CSV file, default a comma")
    add("--indenter", metavar="YAML", help='e.g. "{stamp: {size_mm: [10, 10]}}"')
    add("--load", metavar="N", help="weight in newtons")
    add("--fixture", metavar="NAME", help="stamps of one fixture have one pose")
    add("--mask", metavar="CSV", help="footprint_images: a picture of the footprint, relative to the measurement")
    add("--pixel-mm", dest="pixel_mm", metavar="MM", help="side of a pixel of the mask")
    add("--temperature", dest="temperature_degC", metavar="DEGC", help="of the sensor, degrees Celsius")
    return parser


def _column(text: str) -> tuple[str, str]:
    name, equals, column = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} is not allowed: NAME=COLUMN")
    return name, column
