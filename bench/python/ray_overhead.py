#!/usr/bin/env python3
"""Measures what Ray adds to a task, and one and two workers on a scene.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/ray_overhead.py [--episodes N] [--json FILE]

Empty tasks give the time and the processor time that Ray takes for a task: sending, scheduling, result, and the loop that sends again what
is lost. A cluster that does nothing gives the processor time of Ray's own processes per second. Together, over a task of 10 s, they are
the share that Ray adds. The second part generates a scene in one process and with one and two workers of a local cluster. Processor time
includes Ray's processes and the start of workers; it depends less on other programs than the time by the clock.
"""

import argparse
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import ray
from report import machine, write_json

import taxelsim
import taxelsim.ray
from taxelsim.ray.cluster import connected
from taxelsim.ray.node import Outcome
from taxelsim.ray.tasks import TASK_SECONDS, Tasks

NUM_TASKS = 500
IDLE_SECONDS = 20.0
TICKS = os.sysconf("SC_CLK_TCK")


def empty(_: object, item: int) -> Outcome:
    """A task that does nothing."""
    return Outcome(node="", value=item)


def cpu_seconds() -> float:
    """Processor time of this process and of all that descend from it, with children that have ended."""
    total, parents, times = 0.0, {}, {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents[int(folder.name)] = int(fields[1])
        times[int(folder.name)] = sum(map(int, fields[11:15])) / TICKS
    for process in times:
        ancestor = process
        while ancestor > 1 and ancestor != os.getpid():
            ancestor = parents.get(ancestor, 0)
        total += times[process] if ancestor == os.getpid() else 0.0
    return total


def per_task() -> dict[str, float]:
    """s, CPU s of an empty task, one after another on one worker, and CPU s of an idle cluster per second."""
    with connected(None, num_cpus=1):
        tasks = Tasks(empty, taxelsim.ray.Workers())
        tasks.run(None, range(10), lambda *_: None)
        begin, cpu = time.monotonic(), cpu_seconds()
        tasks.run(None, range(NUM_TASKS), lambda *_: None)
        seconds, cpu = time.monotonic() - begin, cpu_seconds() - cpu
        idle = cpu_seconds()
        time.sleep(IDLE_SECONDS)
        idle = (cpu_seconds() - idle) / IDLE_SECONDS
    return {"seconds": seconds / NUM_TASKS, "cpu_seconds": cpu / NUM_TASKS, "idle_cpu_per_second": idle}


def generated(scene: taxelsim.Scene, root: Path, num_workers: int) -> dict[str, float]:
    """Wall s and CPU s of a data set; without Ray if num_workers is 0."""
    out = root / "out"
    begin, cpu = time.monotonic(), cpu_seconds()
    if num_workers == 0:
        taxelsim.generate(scene, out)
        seconds, cpu = time.monotonic() - begin, cpu_seconds() - cpu
    else:
        with connected(None, num_cpus=num_workers):
            begin = time.monotonic()
            taxelsim.ray.generate(scene, out, on_progress=lambda *_: None)
            seconds, cpu = time.monotonic() - begin, cpu_seconds() - cpu
    shutil.rmtree(out)
    return {"workers": num_workers, "seconds": seconds, "cpu_seconds": cpu}


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=4096)
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    task = per_task()
    share = task["seconds"] / TASK_SECONDS + task["idle_cpu_per_second"]
    print(f"Ray {ray.__version__}: an empty task takes {1e3 * task['seconds']:.2f} ms, {1e3 * task['cpu_seconds']:.2f} ms of CPU time")
    print(f"idle cluster: {100 * task['idle_cpu_per_second']:.2f} % of one processor")
    print(f"share of a task of {TASK_SECONDS:.0f} s on one processor: {100 * share:.2f} %", flush=True)
    scene = taxelsim.load_scene(taxelsim.SCENES / "edge_servo.yaml", num_episodes=options.episodes)
    rows = []
    with tempfile.TemporaryDirectory() as root:
        for num_workers in (0, 1, 2):
            rows.append(generated(scene, Path(root), num_workers))
            print("{workers} workers: {seconds:.1f} s, {cpu_seconds:.1f} s of CPU time".format(**rows[-1]), flush=True)
    if options.json:
        write_json(options.json, {**machine(taxelsim.Device.open()), "ray": ray.__version__, "task": task, "share": share, "runs": rows})


if __name__ == "__main__":
    sys.exit(main())
