#!/usr/bin/env python3
"""Computes the table of docs/notes/scaling.md: 1e9 and 1e12 frames on 1,000 nodes, from measured costs and assumptions.

    python3 bench/python/scaling_plan.py

MEASURED has costs of scenes/edge_servo.yaml on the machine of docs/notes/scaling.md, ASSUMED what a cluster has. Change them for your own.
A time is that of the one resource that its row names, as if all others were free; the largest one is the bottleneck.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Measured:
    """Costs of one shard of 256 episodes, 51,200 frames, or of one task."""

    frames: int = 51_200
    shard_bytes: float = 10.4e6
    frames_per_core: float = 75e3  # frames per CPU s of one process
    setup: float = 1.55  # CPU s of a task before its first frame: driver pipelines, probe
    task: float = 2.9e-3  # s of the calling process per task of Ray
    directory_operations: int = 15  # open, rename, fsync, lookup, lock of a shared directory, per shard
    s3_puts: int = 3  # PUT and LIST, per shard
    s3_gets: int = 7  # GET and HEAD, per shard
    view_bytes: float = 5.5e3  # of dataset.h5, per shard
    view_time: float = 0.46e-3  # CPU s to write it, per shard
    view_memory: float = 44e3  # bytes of memory to write it, per shard
    hash_rate: float = 2.0e9  # bytes per CPU s of SHA-256


@dataclass(frozen=True)
class Assumed:
    """A cluster, and prices in US dollars."""

    nodes: int = 1000
    cores: int = 16  # per node, a worker each
    network: float = 1.25e9  # bytes/s of a node
    file_server: float = 10e9  # bytes/s of a shared file system
    file_operations: float = 20e3  # metadata operations/s of it
    put_rate: float = 3500.0  # requests/s of one prefix of S3, as its documentation says
    get_rate: float = 5500.0
    core_hour: float = 0.04
    gigabyte_month: float = 0.023
    million_puts: float = 5.0
    million_gets: float = 0.4
    node_hours_per_loss: float = 1000.0


@dataclass(frozen=True)
class Plan:
    """One way to make a number of frames."""

    frames: float
    scale: int = 1  # frames of a shard, in units of the shipped scene
    shards_per_directory: float = 1e6
    task_seconds: float = 50.0


MEASURED = Measured()
ASSUMED = Assumed()
PLANS = (
    Plan(1e9),
    Plan(1e12, task_seconds=10.0),
    Plan(1e12, scale=10, shards_per_directory=1e5),
)


def duration(seconds: float) -> str:
    """s, min, h or days."""
    for limit, unit, name in ((120, 1, "s"), (7200, 60, "min"), (172_800, 3600, "h")):
        if seconds < limit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds / 86_400:.3g} days"


def size(amount: float) -> str:
    """Bytes, decimal."""
    power = min(4, int(math.log10(max(amount, 1)) / 3))
    return f"{amount / 1000**power:.3g} {('B', 'kB', 'MB', 'GB', 'TB')[power]}"


def column(plan: Plan) -> dict[str, str]:
    """Rows of the table for one plan."""
    m, a = MEASURED, ASSUMED
    workers = a.nodes * a.cores
    frames = m.frames * plan.scale
    shards = math.ceil(plan.frames / frames)
    directories = math.ceil(shards / plan.shards_per_directory)
    in_directory = math.ceil(shards / directories)
    total = shards * m.shard_bytes * plan.scale
    compute = plan.frames / m.frames_per_core  # CPU s
    per_task = max(1, min(round(plan.task_seconds * m.frames_per_core / frames), math.ceil(shards / workers)))
    tasks = math.ceil(shards / per_task)
    setup = tasks * m.setup
    puts, gets = shards * m.s3_puts, shards * m.s3_gets
    busy = (compute + setup) / workers
    losses = a.nodes * busy / 3600 / a.node_hours_per_loss
    operations = shards * m.directory_operations
    requests = puts / 1e6 * a.million_puts + gets / 1e6 * a.million_gets
    return {
        "frames": f"{plan.frames:.0e}",
        "frames of a shard": f"{frames:,}",
        "bytes": size(total),
        "shards": f"{shards:,}",
        "directories": f"{directories:,}",
        "files": f"{2 * shards + 4 * directories:,}",
        "size of each dataset.h5": size(in_directory * m.view_bytes),
        "memory to write each dataset.h5": size(in_directory * m.view_memory),
        "CPU time to write each dataset.h5": duration(in_directory * m.view_time),
        "tasks": f"{tasks:,}",
        "simulation, all workers": duration(compute / workers),
        "setup of tasks, all workers": duration(setup / workers),
        "one calling process of Ray, sending tasks": duration(tasks * m.task),
        "network of the nodes, upload and read back": duration(2 * total / (a.nodes * a.network)),
        "shared file system, bytes": duration(total / a.file_server),
        "shared file system, metadata operations": f"{operations:,} in {duration(operations / a.file_operations)}",
        "S3, requests, a prefix per directory": f"{puts + gets:,} in {duration(max(puts / a.put_rate, gets / a.get_rate) / directories)}",
        "verification by `finish` of one directory on one node": duration(total / directories / min(a.network, a.cores * m.hash_rate)),
        "verification of all, a node per directory": duration(
            total / directories / min(a.network, a.cores * m.hash_rate) * math.ceil(directories / a.nodes)
        ),
        "nodes lost on the way": f"{losses:.2g}",
        "work lost with them": f"{100 * losses * a.cores * plan.task_seconds / (compute + setup):.2g} %",
        "cost of processors": f"${(compute + setup) / 3600 * a.core_hour:,.2f}",
        "cost of S3 requests": f"${requests:,.2f}",
        "cost of S3 storage per month": f"${total / 1e9 * a.gigabyte_month:,.2f}",
    }


def main() -> None:
    """Prints the table in Markdown."""
    columns = [column(plan) for plan in PLANS]
    print("| | " + " | ".join(("A", "B", "C")) + " |\n|---|" + "---:|" * len(columns))
    for name in columns[0]:
        print(f"| {name} | " + " | ".join(rows[name] for rows in columns) + " |")


if __name__ == "__main__":
    main()
