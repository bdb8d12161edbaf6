#!/usr/bin/env python3
"""Rates of the Python package compared with C++ and with the program, in turns, in one run.

    cmake --preset bench -DTAXELSIM_BUILD_PYTHON=ON && cmake --build --preset bench
    PYTHONPATH=build/bench/python build/venv/bin/python bench/python/rates.py --json bench/results/python_rates-lavapipe.json

simulator: set_objects(), step(), read() of a batch, compared with the same loop in C++ (the program simulator_rate).
environment: VectorEnv.step() with a NumPy policy and with a 64-64 network by onnxruntime, compared with `taxelsim generate` of the scene.
startup: `import taxelsim`; time from the start of a process to its end for one frame, compared with `taxelsim frame`.

Ratios are medians of the ratios within a turn. The file is written after every part.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from report import ROOT, lowest_height, machine, ratio, summary, write_json

import taxelsim
from taxelsim.program import PROGRAM

HERE = Path(__file__).parent
SENSOR = ROOT / "scenes/sensors/wts0614_soft_cover.yaml"
KNOB = ROOT / "scenes/objects/knob_5k.obj"
SCENE = ROOT / "bench/scenes/edge_follow.yaml"
CASES = {"cylinder": "cylinder:0.008,0.04", "mesh": str(KNOB)}
STEP = 0.001  # s
DEPTH, DEPTH_SPREAD, NUM_DEPTHS = 0.0005, 1e-6, 256  # m, as in simulator_rate.cpp
LOAD = 5  # N, of the first frame


def output_of(command: Sequence[str | Path | int], environment: dict[str, str] | None = None) -> str:
    """Standard output of a command. Exits with its messages if it fails."""
    words = [str(word) for word in command]
    result = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **(environment or {})})
    if result.returncode != 0:
        sys.exit(f"rates.py: {' '.join(words)}: exit status {result.returncode}\n{result.stderr}")
    return result.stdout


class Loop:
    """set_objects(), step(), read() over poses that are made before."""

    def __init__(self, device: taxelsim.Device, case: str, num_instances: int, num_steps: int) -> None:
        rotation = taxelsim.axis_angle((1, 0, 0), np.pi / 2)
        shape = taxelsim.parse_object(CASES[case])
        self.simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(SENSOR), [shape]), num_instances)
        self.simulator.prepare()
        self.ids = np.zeros(num_instances, np.int32)
        self.poses = np.zeros((num_steps, num_instances, 7))
        steps, instances = np.meshgrid(np.arange(num_steps), np.arange(num_instances), indexing="ij")
        self.poses[..., 2] = -lowest_height(shape, rotation) - DEPTH - DEPTH_SPREAD * ((instances + steps) % NUM_DEPTHS)
        self.poses[..., 3:] = rotation
        self.run()
        frame = self.simulator.read()
        if not frame.tactile_image.any(axis=(1, 2)).all():
            sys.exit(f"rates.py: {case}: an instance has no contact")

    def run(self) -> None:
        for poses in self.poses:
            self.simulator.set_objects(self.ids, poses)
            self.simulator.step(STEP)
            self.simulator.read().tactile_image[-1, -1, -1]

    def rate(self) -> float:
        """Frames/s, after a loop that is not timed, as in simulator_rate.cpp."""
        self.run()
        start = time.perf_counter()
        self.run()
        return self.poses.shape[0] * self.poses.shape[1] / (time.perf_counter() - start)


def simulator_part(options: argparse.Namespace, device: taxelsim.Device) -> dict[str, Any]:
    """The batch from Python and from C++."""
    results: dict[str, Any] = {"num_instances": options.instances, "num_steps": options.steps}
    for case, text in CASES.items():
        loop = Loop(device, case, options.instances, options.steps)
        rates: dict[str, list[float]] = {"cpp": [], "python": []}
        for _ in range(options.repetitions):
            rates["cpp"].append(float(output_of([options.simulator_rate, text, options.instances, options.steps])))
            rates["python"].append(loop.rate())
        python, cpp = summary(rates["python"]), summary(rates["cpp"])
        results[case] = {"python": python, "cpp": cpp, "python_over_cpp": ratio(rates["python"], rates["cpp"])}
        row(f"Simulator, {case}", python["median"], f"C++ {cpp['median']:,.0f}", results[case]["python_over_cpp"])
    return results


def generate_rate(num_envs: int) -> float:
    """Frames/s that `taxelsim generate` reports for one episode per environment."""
    with tempfile.TemporaryDirectory() as folder:
        text = output_of([PROGRAM, "generate", SCENE, "-o", Path(folder) / "out", "--episodes", num_envs, "--batch-size", num_envs])
    found = re.search(r"at ([\d,]+) frames/s", text)
    if not found:
        sys.exit(f"rates.py: no rate in the output of generate: {text!r}")
    return float(found[1].replace(",", ""))


def environment_part(options: argparse.Namespace) -> dict[str, Any]:
    """VectorEnv.step() and generate."""
    policies = {"servo": "NumPy servo", "mlp": "64-64 network, onnxruntime"}
    script = [sys.executable, HERE / "environment_rate.py", SCENE, options.envs]
    rates: dict[str, list[float]] = {name: [] for name in ("generate", *policies)}
    details: dict[str, list[dict[str, float]]] = {name: [] for name in policies}
    for _ in range(options.turns):
        rates["generate"].append(generate_rate(options.envs))
        for name in policies:
            result = json.loads(output_of([*script, name, 1]))
            rates[name].append(result.pop("frames_per_second"))
            details[name].append(result)
    generate = summary(rates["generate"])
    results: dict[str, Any] = {"scene": SCENE.name, "num_envs": options.envs, "generate": generate}
    for name, title in policies.items():
        over = ratio(rates[name], rates["generate"])
        results[name] = {**summary(rates[name]), "over_generate": over, "details": details[name]}
        row(f"VectorEnv, {title}", results[name]["median"], f"generate {generate['median']:,.0f}", over)
    return results


def seconds_of(command: Sequence[str | Path | int], cache: str) -> float:
    """Time from the start of a process to its end."""
    start = time.perf_counter()
    output_of(command, {"MESA_SHADER_CACHE_DIR": cache})
    return time.perf_counter() - start


def startup_part(options: argparse.Namespace) -> dict[str, Any]:
    """Import and first frame."""
    script = "import time; start = time.perf_counter(); import taxelsim; print(time.perf_counter() - start)"
    imports = summary([float(output_of([sys.executable, "-c", script])) for _ in range(options.repetitions)])
    print(f"{'import taxelsim':44}{imports['median']:12.3f} s")
    commands: dict[str, list[str | Path | int]] = {
        "python": [sys.executable, HERE / "first_frame.py", SENSOR, KNOB, LOAD],
        "program": [PROGRAM, "frame", "--sensor", SENSOR, "--object", KNOB, "--rpy-deg", "0 0 90", "--load", LOAD],
    }
    results: dict[str, Any] = {"import_seconds": imports}
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
        caches = dict(zip(commands, (first, second), strict=True))
        results["first_frame_cold_seconds"] = {name: seconds_of(command, caches[name]) for name, command in commands.items()}
        warm: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(options.repetitions):
            for name, command in commands.items():
                warm[name].append(seconds_of(command, caches[name]))
    results["first_frame_warm_seconds"] = {name: summary(values) for name, values in warm.items()}
    results["first_frame_python_over_program"] = ratio(warm["python"], warm["program"])
    for name in commands:
        cold, median = results["first_frame_cold_seconds"][name], results["first_frame_warm_seconds"][name]["median"]
        print(f"{'first frame, ' + name:44}{median:12.3f} s with shader cache, {cold:.3f} s without")
    return results


def row(title: str, rate: float, reference: str, over: float) -> None:
    """Prints a line of the table."""
    print(f"{title:44}{rate:12,.0f} frames/s    {reference:>24} frames/s    {over:7.1%}", flush=True)


def main() -> None:
    """Runs the parts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", default="startup,simulator,environment", help="list, separated by commas; default: all")
    parser.add_argument("--simulator-rate", type=Path, default=ROOT / "build/bench/bench/simulator_rate", help="the program of that name")
    parser.add_argument("--instances", type=int, default=4096, help="of the simulator")
    parser.add_argument("--steps", type=int, default=150, help="of the simulator per repetition")
    parser.add_argument("--repetitions", type=int, default=5, help="of simulator and startup")
    parser.add_argument("--envs", type=int, default=2048, help="environments")
    parser.add_argument("--turns", type=int, default=3, help="of the environment")
    parser.add_argument("--json", type=Path, help="file of results to write")
    options = parser.parse_args()
    parts = options.parts.split(",")
    unknown = set(parts) - {"simulator", "environment", "startup"}
    if unknown:
        parser.error(f"--parts: {', '.join(sorted(unknown))} is not allowed: simulator, environment, startup")
    if "simulator" in parts and not options.simulator_rate.exists():
        parser.error(f"{options.simulator_rate} is missing: cmake --build --preset bench, or name it by --simulator-rate")
    device = taxelsim.Device.open()
    results: dict[str, Any] = {**machine(device), "parts": {}}
    print(f"{results['device']}, {results['driver']}")
    for part in parts:
        if part == "simulator":
            results["parts"][part] = simulator_part(options, device)
        else:
            results["parts"][part] = environment_part(options) if part == "environment" else startup_part(options)
        write_json(options.json, results)


if __name__ == "__main__":
    main()
