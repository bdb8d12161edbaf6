#!/usr/bin/env python3
"""Processor time of the contact features per frame, with a cylinder in contact and without contact.

    LP_NUM_THREADS=1 PYTHONPATH=build/release/python build/venv/bin/python bench/python/contact_feature_cost.py

Frames with and without contact features run in turns; the cost is the difference of their medians. Processor time includes that of the
driver's threads.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from report import ROOT

import taxelsim

RADIUS = 0.008  # m
DEPTH, HEIGHT = 0.0005, 0.005  # m, of the contact; above the skin where there is none


def simulators(device: taxelsim.Device, sensor: taxelsim.Sensor, num_instances: int, max_regions: int) -> list[taxelsim.Simulator]:
    """One simulator without contact features and one with them."""
    model = taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=RADIUS, length=0.04)])
    outputs = (taxelsim.OutputOptions(), taxelsim.OutputOptions(contact_features=True))
    return [
        taxelsim.Simulator(model, num_instances, outputs=chosen, max_regions=max_regions if chosen.contact_features else 0)
        for chosen in outputs
    ]


def cost(pair: list[taxelsim.Simulator], depth: float, rounds: int) -> float:
    """Median processor time of a frame's contact features, s."""
    num_instances = pair[0].num_instances
    random = np.random.default_rng(0)
    poses = np.zeros((num_instances, 7))
    poses[:, :2] = random.uniform(-0.005, 0.005, (num_instances, 2))
    poses[:, 2] = RADIUS - depth
    half = np.radians(random.uniform(-85, 85, num_instances)) / 2
    poses[:, 3:] = np.sqrt(0.5) * np.stack([np.cos(half), np.cos(half), np.sin(half), np.sin(half)], axis=1)
    times: list[list[float]] = [[], []]
    for simulator in pair:
        simulator.prepare()
        simulator.set_objects(0, poses)
        simulator.step(0.01)
        simulator.read()
    for _ in range(rounds):
        for which, simulator in enumerate(pair):
            start = time.process_time()
            simulator.step(0.01)
            simulator.read()
            times[which].append(time.process_time() - start)
    return float(np.median(times[1]) - np.median(times[0])) / num_instances


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sensor", default="wts0614", help="name of a shipped sensor")
    parser.add_argument("--instances", type=int, default=1024)
    parser.add_argument("--rounds", type=int, default=31)
    arguments = parser.parse_args()
    device = taxelsim.Device.open()
    sensor = taxelsim.load_sensor(ROOT / f"scenes/sensors/{arguments.sensor}.yaml")
    print("us per frame\nregions  contact  no contact")
    for max_regions in (0, 4):
        pair = simulators(device, sensor, arguments.instances, max_regions)
        found = [cost(pair, depth, arguments.rounds) * 1e6 for depth in (DEPTH, -HEIGHT)]
        print(f"{max_regions:7}  {found[0]:7.2f}  {found[1]:10.2f}", flush=True)


if __name__ == "__main__":
    main()
