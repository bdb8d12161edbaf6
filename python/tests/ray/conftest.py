"""A cluster of three nodes on this machine, on loopback, and a local S3 server."""

from __future__ import annotations

import logging
import os
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import taxelsim

KIND = "software"

SERVO = """format_version: 1
name: servo
kind: servo
sensor: {sensor}
objects: [{{cylinder: {{radius_mm: 8, length_mm: 60}}, orientation: {{rpy_deg: [90, 0, 0]}}}}]
episode: {{num_steps: 6, simulation_rate: 100, control_rate: 100}}
randomization: {{x_mm: [-3, 3], load: [0.5, 5]}}
controller:
  tactile_servo:
    total_force: {{kp: 2}}
record: [tactile_image, actions]
data_set: {{episodes: 21, seed: 1, episodes_per_shard: 4}}
"""


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> taxelsim.Scene:
    file = tmp_path_factory.mktemp("scene") / "servo.yaml"
    file.write_text(SERVO.format(sensor=(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve()))
    return taxelsim.load_scene(file)


@pytest.fixture(scope="session")
def cluster() -> Iterator[Any]:
    """Nodes: two of one kind; one of a driver with other vectors, whose values may differ in the last bit; this process has none."""
    os.environ["RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"] = "0"  # loopback
    import ray
    from ray.cluster_utils import Cluster

    ray._private.ray_constants.ENABLE_RAY_CLUSTER = False
    quick = {"health_check_period_ms": 500}  # a killed node is noticed after five periods, by default of 3 s
    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False, "_system_config": quick})
    made.same = [made.add_node(num_cpus=1, resources={KIND: 1}, wait=False) for _ in range(2)]
    made.other = made.add_node(num_cpus=1, env_vars={"LP_NATIVE_VECTOR_WIDTH": "128"}, wait=False)
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


def files_of(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir() if not file.name.startswith(".")}
