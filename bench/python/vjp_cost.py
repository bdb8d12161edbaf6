#!/usr/bin/env python3
"""Processor time of gradients by pose and gains: on the host from the taxels' Jacobian, and on the device, Simulator.vjp().

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/vjp_cost.py

Of each sensor, --instances under a ball at random places, --depth deep, with area sampling. Medians of --repeats rounds, in which the kinds
take turns; on a software driver, whose threads belong to the process. Per instance, in us.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from report import ROOT, machine, write_json

import taxelsim

RADIUS = 0.008  # m
SENSORS = ("wts0614_soft_cover", "fingertip_sphere")
KINDS = ("frame", "frame, Jacobian read", "gradient on the host", "frame, Jacobian on the device", "gradient on the device")


class Presses:
    """A batch under a ball, with some outputs."""

    def __init__(self, model: taxelsim.Model, count: int, depth: float, outputs: taxelsim.OutputOptions) -> None:
        self.simulator = taxelsim.Simulator(model, count, outputs=outputs)
        self.poses = np.zeros((count, 7))
        self.poses[:, :2] = np.random.default_rng(0).uniform(-0.003, 0.003, (count, 2))
        self.poses[:, 2], self.poses[:, 3] = RADIUS - depth, 1

    def frame(self) -> taxelsim.Frame:
        self.poses[:, 0] += 1e-6
        self.simulator.set_objects(0, self.poses)
        self.simulator.step(0.001)
        return self.simulator.read()


def measure(model: taxelsim.Model, count: int, depth: float, repeats: int) -> np.ndarray:
    """Processor times (KINDS), s per instance."""
    options = ({}, {"taxel_jacobian": True}, {"vjp": True})
    plain, reads, asks = (Presses(model, count, depth, taxelsim.OutputOptions(**option)) for option in options)
    cotangent = np.random.default_rng(1).normal(size=plain.frame().tactile_image.shape).astype(np.float32)
    gain = np.full(cotangent.shape[1:], 0.9, np.float32)
    kinds = (
        plain.frame,
        reads.frame,
        lambda: taxelsim.vjp(reads.simulator.read(), cotangent, gain),
        asks.frame,
        lambda: asks.simulator.vjp(cotangent, gain),
    )
    times = np.empty((repeats, len(KINDS)))
    for repeat in range(-3, repeats):
        for k, kind in enumerate(kinds):
            begin = time.process_time()
            kind()
            if repeat >= 0:
                times[repeat, k] = (time.process_time() - begin) / count
    return np.median(times, axis=0)


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--instances", type=int, default=1024)
    parser.add_argument("--depth", type=float, default=0.0005, help="m")
    parser.add_argument("--repeats", type=int, default=31)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    device = taxelsim.Device.open()
    print(f"{device.info.name}, {arguments.instances} instances, processor time, us per instance")
    rows = []
    for name in SENSORS:
        sensor = taxelsim.load_sensor(ROOT / f"scenes/sensors/{name}.yaml").replace(depth_sampling=taxelsim.DepthSampling.AREA)
        model = taxelsim.Model(device, sensor, [taxelsim.Sphere(radius=RADIUS)])
        times = 1e6 * measure(model, arguments.instances, arguments.depth, arguments.repeats)
        row = {"sensor": name, "taxels": sensor.num_taxels, **dict(zip(KINDS, times.tolist(), strict=True))}
        rows.append(row)
        print(f"{name}, {sensor.num_taxels} taxels")
        for kind, value in zip(KINDS, times, strict=True):
            print(f"  {kind:32} {value:7.2f}", flush=True)
        print(f"  {6 * 4 * sensor.num_taxels} bytes of Jacobian, {4 * (6 + sensor.num_taxels)} of gradient")
    write_json(arguments.json, {**machine(device), "rows": rows})


if __name__ == "__main__":
    main()
