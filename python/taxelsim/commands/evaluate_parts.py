"""Options of `taxelsim evaluate --policy` for an evaluation in parts, as src/cli/evaluation_parts.h has them without a policy."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from .. import _core
from ..errors import InputError


def add_part_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds --episode-range, --part, --output and --merge."""
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--episode-range", metavar="A..B", help="plays these episodes only, both ends included, and writes verdicts to DIR")
    choice.add_argument("--part", metavar="K/N", help="plays part K of N of the episodes, K from 1; as --episode-range")
    choice.add_argument("--merge", type=Path, metavar="DIR", help="puts the parts in DIR together instead of playing")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="directory for the verdicts of a part; created if missing")


def chosen_episodes(options: argparse.Namespace, num_episodes: int) -> range | None:
    """The episodes that the options choose, empty for some parts if there are more parts than episodes; None without options."""
    if (options.output is None) != (options.episode_range is None and options.part is None):
        raise InputError("--output: needs --episode-range or --part, and these need --output")
    if options.episode_range is not None:
        first, last = _numbers(r"(\d+)\.\.(\d+)", options.episode_range, "--episode-range", "FIRST..LAST, such as 40..79, both included")
        if not first <= last < num_episodes:
            raise InputError(f"--episode-range: {options.episode_range} is not allowed: the scene has episodes 0 to {num_episodes - 1}")
        return range(first, last + 1)
    if options.part is None:
        return None
    part, num_parts = _numbers(r"(\d+)/(\d+)", options.part, "--part", "K/N, such as 3/16, K from 1 to N")
    if not 1 <= part <= num_parts:
        raise InputError(f"--part: {options.part} is not K/N, such as 3/16, K from 1 to N")
    return range(*_core.part_of_episodes(num_episodes, part, num_parts))


def _numbers(pattern: str, text: str, option: str, allowed: str) -> tuple[int, int]:
    found = re.fullmatch(pattern, text, re.ASCII)
    if found is None:
        raise InputError(f"{option}: {text} is not {allowed}")
    return int(found[1]), int(found[2])


def part_file(directory: Path, episodes: range) -> Path:
    """The file of the episodes, as the program names it."""
    return directory / f"episodes-{episodes.start:08}-{episodes.stop - 1:08}.json"


def part_files(directory: Path) -> list[Path]:
    """The files of all parts in a directory. InputError if there are none."""
    files = sorted(directory.glob("episodes-*.json"))
    if not files:
        raise InputError(f"{directory}: has no part of an evaluation (episodes-*.json)")
    return files
