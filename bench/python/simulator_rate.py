#!/usr/bin/env python3
"""Rate of taxelsim.Simulator from Python beside that of the same loop in C++, in turn, in one run.

    cmake --preset bench -DTAXELSIM_BUILD_PYTHON=ON && cmake --build --preset bench
    PYTHONPATH=build/bench/python build/venv/bin/python bench/python/simulator_rate.py --json bench/results/python_simulator_rate.json

Prints frames/s of both, medians over the repetitions, and their ratio. Also the time of `import taxelsim`.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import taxelsim

ROOT = Path(__file__).parents[2]
CASES = {"cylinder": "cylinder:0.008,0.04", "mesh": str(ROOT / "scenes/objects/knob_5k.obj")}
STEP = 0.001  # s
DEPTH, DEPTH_SPREAD, NUM_DEPTHS = 0.0005, 1e-6, 256  # m, as in simulator_rate.cpp


class Loop:
    """set_objects(), step(), read() over poses that are made before."""

    def __init__(self, device: taxelsim.Device, case: str, num_instances: int, num_steps: int) -> None:
        rotation = taxelsim.axis_angle((1, 0, 0), np.pi / 2)
        shape = taxelsim.parse_object(CASES[case])
        sensor = taxelsim.load_sensor(ROOT / "scenes/sensors/wts0614.yaml")
        self.simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [shape]), num_instances)
        self.simulator.prepare()
        self.ids = np.zeros(num_instances, np.int32)
        self.poses = np.zeros((num_steps, num_instances, 7))
        steps, instances = np.meshgrid(np.arange(num_steps), np.arange(num_instances), indexing="ij")
        self.poses[..., 2] = -taxelsim.lowest_point(shape, rotation)[2] - DEPTH - DEPTH_SPREAD * ((instances + steps) % NUM_DEPTHS)
        self.poses[..., 3:] = rotation
        self.run()

    def run(self) -> float:
        """Frames/s."""
        start = time.perf_counter()
        for poses in self.poses:
            self.simulator.set_objects(self.ids, poses)
            self.simulator.step(STEP)
            self.simulator.read().tactile_image[-1, -1, -1]
        return self.poses.shape[0] * self.poses.shape[1] / (time.perf_counter() - start)


def import_seconds() -> float:
    """Of a new process with warm file caches."""
    script = "import time; start = time.perf_counter(); import taxelsim; print(time.perf_counter() - start)"
    return statistics.median(
        float(subprocess.run([sys.executable, "-c", script], check=True, capture_output=True).stdout) for _ in range(5)
    )


def main() -> None:
    """Runs all cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "build/bench/bench/simulator_rate", help="the C++ side")
    parser.add_argument("--instances", type=int, default=4096)
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    results: dict[str, object] = {"device": device.info.name, "driver": device.info.driver, "num_instances": options.instances}
    for case, text in CASES.items():
        loop = Loop(device, case, options.instances, options.steps)
        command = [options.program, text, str(options.instances), str(options.steps)]
        rates: dict[str, list[float]] = {"cpp": [], "python": []}
        for _ in range(options.repetitions):
            rates["cpp"].append(float(subprocess.run(command, check=True, capture_output=True).stdout))
            rates["python"].append(loop.run())
        medians = {name: statistics.median(values) for name, values in rates.items()}
        results[case] = {**rates, "medians": medians, "ratio": medians["python"] / medians["cpp"]}
        print(f"{case}: C++ {medians['cpp']:,.0f}, Python {medians['python']:,.0f} frames/s, {medians['python'] / medians['cpp']:.1%}")
    results["import_seconds"] = import_seconds()
    print(f"import taxelsim: {results['import_seconds']:.2f} s")
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
