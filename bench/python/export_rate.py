#!/usr/bin/env python3
"""Measures `taxelsim export` on one core: frames per second of processor time, and peak memory for a part of a data set and for all of it.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/export_rate.py DIR [--json FILE]

DIR: a data set, e.g. of `taxelsim generate scenes/edge_servo.yaml --episodes 16384`. Processor time includes the start of Python (0.3 s)
and the verification of checksums. Memory is the resident set, with pages of uncompressed shards that the kernel may drop.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from report import machine, write_json

import taxelsim

FORMATS = ("lerobot", "zarr", "robomimic")
PARTS = (16, 1)  # of the episodes: a sixteenth, all


def measured(folder: Path, name: str, num_episodes: int, out: Path) -> tuple[float, float, int]:
    """CPU s, wall s, peak bytes of an export of the first episodes."""
    command = [sys.executable, "-m", "taxelsim", "export", str(folder), "--format", name, "-o", str(out)]
    command += ["--episodes", f"0..{num_episodes - 1}"]
    begin = os.times().elapsed
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)}: exit status {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, os.times().elapsed - begin, usage.ru_maxrss << 10


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    data = taxelsim.Dataset(options.folder)
    rows = []
    print("| format | frames | CPU s | wall s | frames/s of CPU time | peak MiB |\n|---|---|---|---|---|---|")
    for name in FORMATS:
        for part in PARTS:
            episodes = max(1, data.num_episodes // part)
            frames = int(data.episode_ends[episodes - 1])
            with tempfile.TemporaryDirectory(dir=options.folder.parent) as root:
                cpu, wall, peak = measured(options.folder, name, episodes, Path(root) / "out")
            print(f"| {name} | {frames:,} | {cpu:.1f} | {wall:.1f} | {frames / cpu:,.0f} | {peak / 2**20:.0f} |", flush=True)
            rows.append({"format": name, "frames": frames, "cpu_seconds": cpu, "wall_seconds": wall, "peak_bytes": peak})
    if options.json:
        write_json(options.json, {**machine(taxelsim.Device.open()), "exports": rows})


if __name__ == "__main__":
    main()
