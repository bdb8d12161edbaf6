#!/usr/bin/env python3
"""Measures `taxelsim export` on one core: frames per second of processor time, and peak memory for a part of a data set and for all of it.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/export_rate.py DIR [--json FILE] [--formats lerobot-video ...]
    ... export_rate.py DIR --formats oxt --parts 8 1 --options "--place left=0,right=1 --joints jaw=28"

DIR: a data set, e.g. of `taxelsim generate scenes/edge_servo.yaml --episodes 16384`, or of bench/scenes/two_pads_grasp.yaml for oxt.
Processor time includes the start of Python (0.3 s)
and the verification of checksums. Two peaks of memory: the resident set, with pages of uncompressed shards that the kernel may drop, and
the anonymous part of it, which it may not.
"""

import argparse
import os
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from report import machine, write_json

import taxelsim

FORMATS = ("lerobot", "zarr", "robomimic", "lerobot-video", "oxt")
PERIOD = 0.01  # s, between two looks at the memory


def anonymous_bytes(process: int) -> int:
    """Anonymous resident memory; 0 of a process that has ended."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next((int(line.split()[1]) << 10 for line in lines if line.startswith("RssAnon:")), 0)


def measured(folder: Path, name: str, num_episodes: int, out: Path, options: list[str]) -> tuple[float, float, int, int]:
    """CPU s, wall s, peak bytes and peak anonymous bytes of an export of the first episodes."""
    kind, _, video = name.partition("-")
    command = [sys.executable, "-m", "taxelsim", "export", str(folder), "--format", kind, "-o", str(out)]
    command += ["--episodes", f"0..{num_episodes - 1}"] + (["--video"] if video else []) + options
    begin = os.times().elapsed
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    anonymous = 0
    while (end := os.wait4(process.pid, os.WNOHANG))[0] == 0:
        anonymous = max(anonymous, anonymous_bytes(process.pid))
        time.sleep(PERIOD)
    _, status, usage = end
    if status != 0:
        sys.exit(f"{' '.join(command)}: exit status {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, os.times().elapsed - begin, usage.ru_maxrss << 10, anonymous


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=FORMATS[:3], metavar="NAME")
    parser.add_argument("--parts", nargs="+", type=int, default=(16, 1), metavar="N", help="of the episodes; default: a sixteenth, all")
    parser.add_argument("--options", type=shlex.split, default=[], metavar="WORDS", help="further options of `taxelsim export`")
    options = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    data = taxelsim.Dataset(options.folder)
    rows = []
    print("| format | frames | CPU s | wall s | frames/s of CPU time | peak MiB | anonymous MiB |\n|---|---|---|---|---|---|---|")
    for name in options.formats:
        for part in options.parts:
            episodes = max(1, data.num_episodes // part)
            frames = int(data.episode_ends[episodes - 1])
            with tempfile.TemporaryDirectory(dir=options.folder.parent) as root:
                cpu, wall, peak, anonymous = measured(options.folder, name, episodes, Path(root) / "out", options.options)
            print(
                f"| {name} | {frames:,} | {cpu:.1f} | {wall:.1f} | {frames / cpu:,.0f} | {peak / 2**20:.0f} | {anonymous / 2**20:.0f} |",
                flush=True,
            )
            rows.append(
                {
                    "format": name,
                    "frames": frames,
                    "cpu_seconds": cpu,
                    "wall_seconds": wall,
                    "peak_bytes": peak,
                    "anonymous_bytes": anonymous,
                }
            )
    if options.json:
        write_json(options.json, {**machine(taxelsim.Device.open()), "exports": rows})


if __name__ == "__main__":
    main()
