"""Messages that a node in another process loses, and their latency, on loopback: an array of 84 taxels at 1 kHz, four topics.

python ros2_rate.py [--rate HZ] [--seconds S] [--json FILE]

The frames are simulated first: the bridge is measured, not the simulator. The latency of a message is the time of its receipt in Python less
its stamp, which is taken before the frame is serialised. Needs cyclonedds and rosbags.
"""

import argparse
import os
import pickle
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from report import ROOT, machine, write_json

import taxelsim
from taxelsim.ros2.bridge import Bridge
from taxelsim.ros2.topics import topics_of

NODE = ROOT / "python/tests/ros2/node.py"
DOMAIN = 91
NUM_POSES = 50


def frames_of(device: taxelsim.Device) -> list[taxelsim.Frame]:
    """Frames of a cylinder that is pressed deeper, all with contact."""
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=0.008, length=0.04)]))
    frames = []
    for k in range(NUM_POSES):
        simulator.set_objects(0, [[0, 0, 0.0079 - 1e-5 * k, np.sqrt(0.5), np.sqrt(0.5), 0, 0]])
        simulator.step(0.001)
        frames.append(simulator.read().copy())
    return frames


def publish(bridge: Bridge, frames: list[taxelsim.Frame], rate: float, count: int) -> dict[str, float]:
    """Publishes `count` frames, one each 1 / rate, none left out. Gives the latest start of a frame and the share of a processor."""
    worst = 0.0
    used, begun = time.process_time(), time.perf_counter()
    for k in range(count):
        late = time.perf_counter() - begun - k / rate
        if late < 0:
            time.sleep(-late)
        worst = max(worst, late)
        bridge.publish(frames[k % len(frames)])
    seconds = time.perf_counter() - begun
    return {"seconds": seconds, "latest_start_ms": 1e3 * worst, "processor_share": (time.process_time() - used) / seconds}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rate", type=float, default=1000.0)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    count = round(options.rate * options.seconds)
    device = taxelsim.Device.open()
    frames = frames_of(device)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    words = [word for topic in topics_of(sensor) for word in (topic.schema.replace("/", "/msg/"), f"/tactile/{topic.name}")]
    with tempfile.TemporaryDirectory() as folder, Bridge(sensor, domain=DOMAIN) as bridge:
        file = Path(folder, "out")
        command = [sys.executable, NODE, "stamps", str(DOMAIN), file, str(count), *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as node:
            assert node.stdout is not None
            os.set_blocking(node.stdout.fileno(), False)
            while not node.stdout.readline():
                bridge.publish(frames[0], stamp=0)
                time.sleep(0.02)
            published = publish(bridge, frames, options.rate, count)
            assert node.wait(300) == 0
        messages = pickle.loads(file.read_bytes())["messages"]
    latencies = 1e-6 * np.concatenate([[receipt - stamp for stamp, receipt, _ in topic] for topic in messages.values()])
    percentiles = dict(zip(("median", "p99", "max"), np.percentile(latencies, (50, 99, 100)).tolist(), strict=True))
    results = {
        "taxels": sensor.num_taxels,
        "rate_hz": options.rate,
        "topics": list(messages),
        "messages": count * len(messages),
        "lost": {name: count - len({stamp for stamp, _, _ in topic}) for name, topic in messages.items()},
        "latency_ms": percentiles,
        **published,
    }
    print(results)
    write_json(options.json, {"machine": machine(device), "load_average": os.getloadavg()[0], "results": results})


main()
