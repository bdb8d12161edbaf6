#!/usr/bin/env python3
r"""Measures what several processes make of a run of `taxelsim generate` or `evaluate`, compared with one process, in turns.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/workers_rate.py build/release/bin/taxelsim \
        [--command generate] [--episodes N] [--workers N] [--pairs N] [--threads N] [--cold] [--json FILE]

A pair is one run with `--workers 1` and one with `--workers N`, the first of them alternating. All times are of whole processes, from start
to end, with the compilation of kernels that the driver's cache holds. The processor time includes the workers. Ratios are medians of
the ratios within a pair. `--cold` gives each run an empty cache of the driver and of kernels.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

from report import ROOT, machine, write_json

import taxelsim

SCENES = {"generate": ROOT / "scenes/edge_servo.yaml", "evaluate": ROOT / "scenes/tasks/align_edge.yaml"}


def run(arguments: argparse.Namespace, workers: int, folder: Path) -> tuple[float, float]:
    """Times of one run in s: by the clock, and of all processors."""
    out = folder / "out"
    command = [arguments.program, "--log-level", "warning", arguments.command, str(SCENES[arguments.command])]
    command += ["--episodes", str(arguments.episodes), "--workers", str(workers)]
    command += ["-o", str(out)] if arguments.command == "generate" else []
    environment = dict(os.environ)
    if workers == 1 and arguments.threads:
        environment["LP_NUM_THREADS"] = str(arguments.threads)
    if arguments.cold:
        cache = folder / "cache"
        shutil.rmtree(cache, ignore_errors=True)
        environment |= {"XDG_CACHE_HOME": str(cache), "MESA_SHADER_CACHE_DIR": str(cache / "mesa")}
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, env=environment)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - start
    shutil.rmtree(out, ignore_errors=True)
    if status != 0:
        raise SystemExit(f"{' '.join(command)}: failed")
    return seconds, usage.ru_utime + usage.ru_stime


def main() -> None:
    """Runs the pairs and prints their medians."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--command", choices=sorted(SCENES), default="generate")
    parser.add_argument("--episodes", type=int, default=4096)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--cold", action="store_true")
    parser.add_argument("--threads", type=int, default=0, help="driver threads of the one process; default: what the program sets")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    pairs: list[dict[int, tuple[float, float]]] = []
    with tempfile.TemporaryDirectory() as folder:
        if not arguments.cold:
            run(arguments, 1, Path(folder))  # fills the caches
        for number in range(arguments.pairs):
            order = (1, arguments.workers) if number % 2 == 0 else (arguments.workers, 1)
            pairs.append({workers: run(arguments, workers, Path(folder)) for workers in order})
            for workers in order:
                print(
                    "{} processes: {:.2f} s, {:.2f} s of processors, load {:.1f}".format(workers, *pairs[-1][workers], os.getloadavg()[0])
                )
    rate = statistics.median(pair[1][0] / pair[arguments.workers][0] for pair in pairs)
    work = statistics.median(pair[arguments.workers][1] / pair[1][1] for pair in pairs)
    print(f"{arguments.workers} processes make {rate:.2f} times what one makes, with {work:.2f} times its processor time")
    results = {
        **machine(taxelsim.Device.open()),
        "command": arguments.command,
        "episodes": arguments.episodes,
        "workers": arguments.workers,
        "cold": arguments.cold,
        "threads_of_one_process": arguments.threads or "default",
        "rate": rate,
        "processor_time": work,
        "pairs": [{str(workers): times for workers, times in pair.items()} for pair in pairs],
    }
    write_json(arguments.json, results)


if __name__ == "__main__":
    main()
