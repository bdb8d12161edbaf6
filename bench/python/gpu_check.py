"""Arrays in the memory of a GPU: the numbers of the host, the order of streams, rates. Needs torch, with CUDA unless --memory is "device".

python gpu_check.py [--instances 4096] [--seconds 2] [--memory cuda] [--json FILE]

Ends with 1 if a number differs. scripts/gpu_check builds, tests and runs this.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch
from report import ROOT, machine, summary, write_json

import taxelsim
from taxelsim.envs.tasks import make_vec

DT = 0.01  # s
SENSORS = ("wts0614", "wts0614_soft_cover", "uskin_like_4x4", "fingertip_sphere", "wts0614_elastic_layer")
KNOB = ROOT / "scenes/objects/knob_5k.obj"
LYING = tuple(taxelsim.axis_angle((1, 0, 0), np.pi / 2))
DEPTH = 0.0005  # m
NUM_STEPS = 50  # that feedback() takes
PUBLISHED = 0.461e-6  # s a frame, TacSL's tactile part at 32,768 environments of 10 x 10 taxels (arXiv 2408.06506, table III)


def flat(frame: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Arrays by name."""
    for name in frame:
        yield from flat(frame[name], f"{prefix}{name}.") if hasattr(frame[name], "as_dict") else [(prefix + name, frame[name])]


def poses_of(count: int, step: int, height: float, rotation: tuple[float, ...] = (1, 0, 0, 0)) -> np.ndarray:
    """(count, 7): places over the array, which slide with the steps."""
    places = np.random.default_rng(1).uniform(-0.008, 0.008, (count, 2)) + 5e-5 * step
    return np.column_stack([places, np.full(count, height), np.tile(rotation, (count, 1))])


def host_copy(value: Any) -> np.ndarray:
    """An array of a frame on the host."""
    return np.array(value) if isinstance(value, np.ndarray) else value.copy()


def check_numbers(device: taxelsim.Device, memory: str) -> dict[str, Any]:
    """Every array, with inputs in memory of the GPU, against the host's; and against software Vulkan, if there is one."""
    cpus = [info for info in taxelsim.list_devices() if info.type == taxelsim.DeviceType.CPU and info.uuid != device.info.uuid]
    software = taxelsim.Device.open(cpus[0].index) if cpus else None
    results: dict[str, Any] = {}
    for name in SENSORS:
        options = dict.fromkeys(("contact_features", "clean_contact_features", "clean_tactile_jacobian"), True)
        frames = []
        for opened, where in ((device, "host"), (device, memory), (software, "host")):
            if opened is None:
                continue
            model = taxelsim.Model(opened, ROOT / f"scenes/sensors/{name}.yaml", [taxelsim.Sphere(radius=0.01)])
            simulator = taxelsim.Simulator(model, 512, outputs=taxelsim.OutputOptions(**options), memory=where)
            inputs = simulator.inputs.tensors("torch") if where != "host" else simulator.inputs
            for step in range(3):
                poses = poses_of(512, step, 0.01 - DEPTH)
                inputs.ids[:] = 0
                inputs.poses[:] = torch.from_numpy(poses) if where != "host" else poses
                simulator.step(DT)
                frame = simulator.read()
            frames.append({key: host_copy(value) for key, value in flat(frame)})
        differing = [key for key, value in frames[0].items() if not np.array_equal(value, frames[1][key])]
        results[name] = {"arrays": len(frames[0]), "differ_from_host": differing}
        if software is not None:
            forces = [frame["ground_truth.tactile_normal_force"] for frame in (frames[0], frames[2])]
            equal = [key for key, value in frames[0].items() if np.array_equal(value, frames[2][key])]
            results[name]["equal_to_software"] = len(equal)
            results[name]["largest_difference_of_forces"] = float(np.abs(forces[0] - forces[1]).max() / np.abs(forces[1]).max())
        print(f"numbers, {name}: {results[name]}")
    return results


def feedback(simulator: taxelsim.Simulator, waits: bool) -> np.ndarray:
    """Depths that follow the measured force, written by PyTorch, under other work on the same stream. Returns the last forces."""
    inputs, frame = simulator.inputs.tensors("torch"), simulator.read().tensors("torch")
    simulator.reset()
    device = inputs.poses.device
    busy = torch.ones(512, 512, device=device)
    inputs.ids[:] = 0
    inputs.poses[:] = torch.from_numpy(poses_of(simulator.num_instances, 0, 0.01 - DEPTH)).to(device)
    for _ in range(NUM_STEPS):
        simulator.step(DT)
        simulator.read()
        if waits and device.type == "cuda":
            torch.cuda.synchronize()
        for _ in range(4):
            busy = busy @ busy / 512
        inputs.poses[:, 2] += 1e-5 * (frame.total_force.double() - 1.0).clamp(-1, 1)
        if waits and device.type == "cuda":
            torch.cuda.synchronize()
    return host_copy(simulator.read().total_force)


def rate(step: Callable[[], Any], items: int, seconds: float) -> dict[str, Any]:
    """Items per second in turns of a fifth of the time each."""

    def wait() -> None:
        if torch.cuda.is_available():
            torch.cuda.synchronize()

    for _ in range(5):
        step()
    rates = []
    for _ in range(5):
        wait()
        begun, count = time.perf_counter(), 0
        while time.perf_counter() - begun < seconds / 5:
            step()
            count += 1
        wait()
        rates.append(count * items / (time.perf_counter() - begun))
    return summary(rates)


def frame_rates(model: taxelsim.Model, height: float, rotation: tuple[float, ...], count: int, memory: str, seconds: float) -> dict[str, Any]:
    """Frames/s from new poses to all outputs: poses from the host and arrays there; both in memory of the GPU; the device alone."""
    poses = [poses_of(count, step, height, rotation) for step in range(8)]
    host = taxelsim.Simulator(model, count, device_clock=True)
    host.set_objects(0, poses[0])
    number = 0

    def on_host() -> None:
        nonlocal number
        host.set_objects(0, poses[number % 8])
        number += 1
        host.step(DT)
        host.read()

    shared = taxelsim.Simulator(model, count, memory=memory)
    inputs, frame = shared.inputs.tensors("torch"), shared.read().tensors("torch")
    tensors = [torch.from_numpy(values).to(inputs.poses.device) for values in poses]
    inputs.ids[:] = 0

    def on_device() -> None:
        nonlocal number
        inputs.poses[:] = tensors[number % 8]
        number += 1
        shared.step(DT)
        shared.read()
        frame.tactile_image.sum()  # a consumer

    results = {"host": rate(on_host, count, seconds), "tensors": rate(on_device, count, seconds)}
    times = []
    for _ in range(20):
        on_host()
        times.append(host.timing.total)
    alone = count / float(np.median(times))
    results["device_alone"] = alone
    results["tensors_over_host"] = results["tensors"]["median"] / results["host"]["median"]
    results["tensors_over_device_alone"] = results["tensors"]["median"] / alone
    return results


def environment_rate(device: taxelsim.Device, count: int, memory: str, seconds: float) -> dict[str, Any]:
    """Environment steps/s of EdgeFollow with a 64-64 network that sees the tactile image."""
    envs = make_vec("EdgeFollow", count, device=device, backend="torch", memory=memory, observations="tactile_image", normalized=True)
    observation = envs.reset(seed=1)[0]
    size, num_actions = int(np.prod(observation.shape[1:])), envs.single_action_space.shape[0]
    layers = (torch.nn.Linear(size, 64), torch.nn.Tanh(), torch.nn.Linear(64, 64), torch.nn.Tanh(), torch.nn.Linear(64, num_actions))
    network = torch.nn.Sequential(*layers, torch.nn.Tanh()).to(observation.device)

    def step() -> None:
        nonlocal observation
        with torch.no_grad():
            observation = envs.step(0.1 * network(observation.flatten(1)))[0]

    return rate(step, count, seconds)


def main() -> None:
    """Prints and writes the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--instances", type=int, default=4096)
    parser.add_argument("--seconds", type=float, default=2.0, help="of each rate")
    parser.add_argument("--memory", default="cuda", choices=["cuda", "hip", "device"])
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    results: dict[str, Any] = {"machine": machine(device), "memory": options.memory, "numbers": check_numbers(device, options.memory)}
    model = taxelsim.Model(device, ROOT / "scenes/sensors/wts0614.yaml", [taxelsim.Sphere(radius=0.01)])
    orders = [feedback(taxelsim.Simulator(model, options.instances, memory=options.memory), waits) for waits in (True, False, False)]
    results["order_of_streams"] = all(np.array_equal(orders[0], order) for order in orders)
    print(f"order of streams: {'right' if results['order_of_streams'] else 'WRONG'} after {NUM_STEPS} steps of feedback")
    knob = taxelsim.parse_object(str(KNOB))
    height = -float(taxelsim.lowest_point(knob, LYING)[1]) - DEPTH
    small = model.sensor.replace(patches=[model.sensor.patches[0].replace(num_rows=10, num_cols=10)], samples_per_taxel=4)
    cases = {
        "wts0614, 5,120 triangles": (taxelsim.Model(device, model.sensor, [knob]), options.instances),
        "10 x 10 taxels, 5,120 triangles": (taxelsim.Model(device, small, [knob]), 8 * options.instances),
    }
    for name, (case, count) in cases.items():
        results[name] = {"instances": count, **frame_rates(case, height, LYING, count, options.memory, options.seconds)}
        print(f"{name}, {count} instances: " + ", ".join(f"{key} {value['median'] if isinstance(value, dict) else value:,.3g}" for key, value in results[name].items() if key != "instances"))  # fmt: skip  # noqa: E501
    results["10 x 10 taxels, 5,120 triangles"]["published_seconds_a_frame"] = PUBLISHED
    results["EdgeFollow"] = {"environments": 2 * options.instances, "steps": environment_rate(device, 2 * options.instances, options.memory, options.seconds)}  # fmt: skip  # noqa: E501
    print(f"EdgeFollow, {2 * options.instances} environments: {results['EdgeFollow']['steps']['median']:,.0f} environment steps/s")
    write_json(options.json, results)
    sys.exit(0 if results["order_of_streams"] and not any(row["differ_from_host"] for row in results["numbers"].values()) else 1)


if __name__ == "__main__":
    main()
