"""A cluster of three nodes on this machine, on loopback, and a local S3 server."""

import logging
import os
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import taxelsim

from ..envs.conftest import write_scene

KIND = "software"


def write_sharded_scene(folder: Path, episodes_per_shard: int, num_frames: int | None = None) -> Path:
    """A scene with a task, as of the tests of environments, in small shards."""
    file = write_scene(folder, num_frames=num_frames)
    file.write_text(file.read_text().replace("episodes: 24,", f"episodes: 21, episodes_per_shard: {episodes_per_shard},"))
    return file


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> taxelsim.Scene:
    return taxelsim.load_scene(write_sharded_scene(tmp_path_factory.mktemp("scene"), 4))


@pytest.fixture(scope="session")
def cluster() -> Iterator[Any]:
    """Two nodes of one kind, and a head whose driver has other vectors: its values may differ in the last bit."""
    os.environ["RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"] = "0"  # loopback
    import ray
    from ray.cluster_utils import Cluster

    ray._private.ray_constants.ENABLE_RAY_CLUSTER = False
    # A killed node is noticed after 1 s instead of 15.
    quick = {"health_check_period_ms": 500, "health_check_failure_threshold": 2}
    head = {"num_cpus": 1, "include_dashboard": False, "_system_config": quick, "env_vars": {"LP_NATIVE_VECTOR_WIDTH": "128"}}
    made = Cluster(initialize_head=True, head_node_args=head)
    made.same = [add_node(made) for _ in range(2)]
    made.other = made.head_node
    made.wait_for_nodes()
    ray.init(address=made.address, log_to_driver=False, configure_logging=False)
    yield made
    ray.shutdown()
    made.shutdown()


@pytest.fixture(scope="session")
def s3() -> Iterator[dict[str, Any]]:
    """Options of fsspec for a server with the bucket `bucket`."""
    from moto.server import ThreadedMotoServer

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    options = {"endpoint_url": f"http://{host}:{port}", "key": "key", "secret": "secret", "client_kwargs": {"region_name": "us-east-1"}}
    urllib.request.urlopen(urllib.request.Request(f"http://{host}:{port}/bucket", method="PUT")).close()
    yield options
    server.stop()


def add_node(cluster: Any) -> Any:
    """A node of the kind of this process."""
    return cluster.add_node(num_cpus=1, resources={KIND: 1}, wait=False)


def replace_node(cluster: Any, node_id: str) -> None:
    """Kills what is left of a node and adds another. In the main thread only: Ray sets a handler of signals."""
    lost = next(node for node in cluster.same if node.node_id == node_id)
    cluster.remove_node(lost, allow_graceful=False)
    cluster.same[cluster.same.index(lost)] = add_node(cluster)


def files_of(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir() if not file.name.startswith(".")}
