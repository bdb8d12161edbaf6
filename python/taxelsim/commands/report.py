"""`taxelsim report DIR`: a data set as a page of HTML that needs no other file, and its card for the Hugging Face Hub."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from .._files import require_folder, write_whole
from ..dataset.dataset import dataset_of_one_sensor
from ..errors import InputError
from ..report import MAX_FRAMES, card_of, page_of, summarize
from ..report.card import checked_license
from .running import run_command


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the subcommand."""
    add = parser.add_argument
    add("folder", type=Path, metavar="DIR", help="data set")
    add("-o", "--output", type=Path, metavar="FILE.html", help="page to write; default report.html without --card")
    add("--card", type=Path, metavar="README.md", help="card to write")
    add(
        "--license",
        default="unknown",
        metavar="ID",
        help="of the card, as the Hub names licences: cc-by-4.0, apache-2.0, ...; default unknown",
    )
    add("--sensor", metavar="NAME", help="sensor of a data set of kind grasp; default: the first")
    add("--max-frames", type=int, default=MAX_FRAMES, metavar="N", help=f"samples a larger data set; default {MAX_FRAMES:,}")
    add("--range", type=float, metavar="COUNTS", help="brightest colour of the examples; default: the 99.9th percentile of the data set")
    add("--assets", type=Path, action="append", default=[], metavar="DIR", help="folder with a URDF or taxel mesh of the scene; repeatable")


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    parser = argparse.ArgumentParser(prog="taxelsim report", description=__doc__)
    add_arguments(parser)
    options = parser.parse_args(arguments)
    return run_command("report", lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    if options.max_frames < 1:
        raise InputError(f"--max-frames: {options.max_frames} is not allowed: at least 1")
    checked_license(options.license)
    page = options.output or (None if options.card else Path("report.html"))
    for file in filter(None, (page, options.card)):
        require_folder(file)
    summary = summarize(dataset_of_one_sensor(options.folder, options.sensor), options.max_frames, options.assets, options.range)
    texts = [(page, page_of(summary))] if page else []
    texts += [(options.card, card_of(summary, options.license))] if options.card else []
    for file, text in texts:
        write_whole(file, text.encode())
        print(f"wrote {file}", file=sys.stderr)
