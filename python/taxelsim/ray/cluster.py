"""The cluster that runs the tasks, and its nodes."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import ray
import ray._private.ray_constants

from ..errors import InputError

_LOOPBACK = "127.0.0.1"
_CLUSTER_VARIABLE = "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"  # 0: Ray addresses its own machine by loopback, and listens there only

_log = logging.getLogger("taxelsim")


@dataclass(frozen=True)
class Workers:
    """What a task needs of a node. A node runs as many tasks at once as it has room for."""

    kind: str | None = None
    """Name of a Ray resource, of which a task takes 1: `ray start --resources '{"h100": 8}'` on the nodes of one kind of device.
    Default: all nodes, of which those that compute other values are refused."""
    cpus: float = 1.0
    """Logical processors, > 0. A software driver uses as many threads, at least one."""
    gpus: float = 0.0
    """Ray's GPUs, >= 0. Ray chooses no Vulkan device: see docs/how_to/clusters.md."""

    @property
    def threads(self) -> int:
        """Threads of a software driver."""
        return max(1, int(self.cpus))

    def needs(self) -> dict[str, float]:
        """Amount of each resource that a task takes. Raises InputError for values out of range."""
        if not self.cpus > 0 or not self.gpus >= 0:
            raise InputError(f"workers: {self.cpus} processors and {self.gpus} GPUs are not allowed: more than 0 and at least 0")
        needs = {"CPU": self.cpus} | ({"GPU": self.gpus} if self.gpus else {})
        return needs | ({self.kind: 1.0} if self.kind else {})

    def options(self, refused: Mapping[str, str]) -> dict[str, Any]:
        """Options of a Ray task that avoids the refused nodes."""
        options: dict[str, Any] = {"num_cpus": self.cpus, "num_gpus": self.gpus, "max_retries": 0, "scheduling_strategy": "SPREAD"}
        if self.kind:
            options["resources"] = {self.kind: 1}
        if refused:
            options["label_selector"] = {"ray.io/node-id": f"!in({', '.join(sorted(refused))})"}
        return options


def slots(workers: Workers, refused: Mapping[str, str]) -> int:
    """Tasks that the nodes that are alive can run at once."""
    needs = workers.needs()
    nodes = (node["Resources"] for node in ray.nodes() if node["Alive"] and node["NodeID"] not in refused)
    return sum(int(min(node.get(name, 0.0) / amount for name, amount in needs.items())) for node in nodes)


@contextmanager
def connected(address: str | None, num_cpus: int | None) -> Iterator[None]:
    """Connects to a cluster, or starts one on this machine and stops it at the end. Keeps a connection that this process has already.

    Joining waits for Ray's own time limit. Raises InputError if no cluster answers at the address.
    """
    if num_cpus is not None and num_cpus < 1:
        raise InputError(f"num_cpus: {num_cpus} is not allowed: at least 1")
    if num_cpus is not None and (address is not None or ray.is_initialized()):
        raise InputError("num_cpus: belongs to a local cluster, and this is another one")
    if ray.is_initialized():
        if address is not None:
            raise InputError(f"address: {address} found, and this process is connected to a cluster already")
        yield
        return
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # Ray sends nothing to its makers
    if address is None:
        _start_local(num_cpus)
    else:
        try:
            ray.init(address=address, log_to_driver=False, configure_logging=False)
        except (ConnectionError, ValueError, RuntimeError) as error:
            raise InputError(f"address: no Ray cluster answers at {address}: {' '.join(str(error).split())}") from error
    try:
        yield
    finally:
        ray.shutdown()


def _start_local(num_cpus: int | None) -> None:
    """Starts a cluster on this machine that listens on loopback only, without Ray's dashboard."""
    constants = ray._private.ray_constants
    before = os.environ.get(_CLUSTER_VARIABLE), constants.ENABLE_RAY_CLUSTER
    os.environ[_CLUSTER_VARIABLE] = "0"
    constants.ENABLE_RAY_CLUSTER = False  # read from the variable when Ray was imported
    try:
        ray.init(address="local", num_cpus=num_cpus, include_dashboard=False, log_to_driver=False, configure_logging=False)
    finally:
        constants.ENABLE_RAY_CLUSTER = before[1]
        del os.environ[_CLUSTER_VARIABLE]
        if before[0] is not None:
            os.environ[_CLUSTER_VARIABLE] = before[0]
    address = ray.nodes()[0]["NodeManagerAddress"]
    if address != _LOOPBACK:
        _log.warning("Ray listens on all addresses of this machine, not on loopback only: its node is %s", address)
