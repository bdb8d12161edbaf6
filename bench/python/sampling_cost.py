#!/usr/bin/env python3
"""Processor time of a frame with point and with area sampling, and their ratio.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/sampling_cost.py

The sensor wts0614 under the objects of the benchmark and a stamp, --instances at random places, --depth deep, and well above the skin.
Medians of --repeats steps, in pairs; on a software driver, whose threads belong to the process.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from report import ROOT, machine, write_json

import taxelsim

SENSOR = ROOT / "scenes/sensors/wts0614_soft_cover.yaml"
KNOB = ROOT / "scenes/objects/knob_5k.obj"
LYING = tuple(taxelsim.axis_angle((1, 0, 0), np.pi / 2))
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def objects() -> dict[str, tuple[object, tuple[float, ...]]]:
    """Shapes with their orientations."""
    return {
        "cylinder, lying": (taxelsim.Cylinder(radius=0.008, length=0.04), LYING),
        "sphere": (taxelsim.Sphere(radius=0.008), UPRIGHT),
        "box": (taxelsim.Box(size=[0.0105, 0.0105, 0.01]), UPRIGHT),
        "5,120 triangles": (taxelsim.parse_object(str(KNOB)), LYING),
    }


def height_over_lowest(shape: object, rotation: tuple[float, ...]) -> float:
    """Of the origin over the lowest point of the rotated shape, m."""
    w, x, y, z = rotation
    down = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
    return -float(down @ taxelsim.lowest_point(shape, list(rotation)))


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--instances", type=int, default=512)
    parser.add_argument("--depth", type=float, default=0.0005, help="m")
    parser.add_argument("--repeats", type=int, default=31)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    device = taxelsim.Device.open()
    sensor = taxelsim.load_sensor(SENSOR)
    rows = []
    print(f"{device.info.name}, {arguments.instances} instances, processor time of a frame, us")
    for name, (shape, rotation) in objects().items():
        for depth in (arguments.depth, -0.05):
            poses = np.zeros((arguments.instances, 7))
            poses[:, :2] = np.random.default_rng(0).uniform(-0.003, 0.003, (arguments.instances, 2))
            poses[:, 2] = height_over_lowest(shape, rotation) - depth
            poses[:, 3:] = rotation
            simulators = []
            for sampling in (taxelsim.DepthSampling.POINT, taxelsim.DepthSampling.AREA):
                model = taxelsim.Model(device, sensor.replace(depth_sampling=sampling), [shape])
                simulators.append(taxelsim.Simulator(model, arguments.instances))
            times = np.empty((arguments.repeats, 2))
            for repeat in range(-3, arguments.repeats):
                poses[:, 0] += 1e-5
                for k, simulator in enumerate(simulators):
                    simulator.set_objects(0, poses)
                    begin = time.process_time()
                    simulator.step(0.001)
                    simulator.read()
                    if repeat >= 0:
                        times[repeat, k] = (time.process_time() - begin) / arguments.instances
            point, area = 1e6 * np.median(times, axis=0)
            ratio = float(np.median(times[:, 1] / times[:, 0]))
            place = "in contact" if depth > 0 else "untouched"
            rows.append({"object": name, "place": place, "point_us": point, "area_us": area, "ratio": ratio})
            print(f"{name:16} {place:11} {point:7.2f} {area:7.2f}  x {ratio:.2f}", flush=True)
    write_json(arguments.json, {**machine(device), "rows": rows})


if __name__ == "__main__":
    main()
