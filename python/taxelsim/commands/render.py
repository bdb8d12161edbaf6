"""`taxelsim render DIR --episode N -o FILE`: a video of an episode, MP4 or GIF, of the pictures that `taxelsim render` draws."""

from __future__ import annotations

import argparse
import itertools
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..program import PROGRAM
from ..video import MAX_RATES, Picture, check_video, save_video
from .running import run_command


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command(), or that of the program that draws the pictures."""
    options = _parser().parse_args(arguments)
    return run_command("render", lambda: _run(options))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim render", description=__doc__)
    add = parser.add_argument
    add("folder", metavar="DIR", help="data set")
    add("-o", "--output", required=True, type=Path, metavar="FILE", help="video to write: .mp4 or .gif; .png draws a picture of frames")
    add("--episode", required=True, type=int, metavar="N", help="number of the episode")
    add("--speed", type=float, default=1.0, metavar="X", help="1 (default) is real time, 0.1 ten times slower")
    add("--range", type=float, metavar="COUNTS", help="brightest colour; default: the 99.9th percentile of the data set")
    return parser


def _run(options: argparse.Namespace) -> None:
    if not 0 < options.speed < float("inf"):
        raise InputError(f"--speed: {options.speed} is not allowed: a finite number above 0")
    check_video(options.output)
    rate = MAX_RATES[options.output.suffix] / options.speed  # per second of the episode
    command = [str(PROGRAM), "render", options.folder, f"--episode={options.episode}", "--output=-", f"--rate={rate!r}"]
    if options.range is not None:
        command.append(f"--range={options.range!r}")
    with subprocess.Popen(command, stdout=subprocess.PIPE) as program:
        pictures = _pictures(program)
        first = list(itertools.islice(pictures, 2))
        if len(first) < 2:
            raise InputError(f"--episode {options.episode}: shows one frame, which is no video; -o FILE.png draws it")
        seconds = (first[1][0] - first[0][0]) / options.speed
        if not seconds > 0:
            raise InputError(f"{options.folder}: data/time of episode {options.episode} does not increase")
        count = save_video(options.output, (picture for _, picture in itertools.chain(first, pictures)), 1 / seconds)
    print(f"{options.output}: {count} frames, {count * seconds:.3g} s")


def _pictures(program: subprocess.Popen[bytes]) -> Iterator[tuple[float, Picture]]:
    """Times, s, and pictures that the program writes as PPM. Raises CalledProcessError if it fails, also half way."""
    stream = program.stdout
    assert stream is not None
    while (header := [stream.readline() for _ in range(4)])[-1].endswith(b"\n"):  # P6, # time T, WIDTH HEIGHT, 255
        width, height = map(int, header[2].split())
        pixels = stream.read(3 * width * height)
        if len(pixels) < 3 * width * height:
            break
        yield float(header[1].split()[-1]), np.frombuffer(pixels, np.uint8).reshape(height, width, 3)
    if program.wait() != 0:
        raise subprocess.CalledProcessError(program.returncode, program.args)
