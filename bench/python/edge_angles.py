#!/usr/bin/env python3
"""Error of the edge angle on strips whose taxels differ in gain, with and without a calibration of the gains.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/edge_angles.py

Cylinders lie across the array at up to 85 degrees to its long side, within 5 mm of its middle, under 1 to 4 N. The gains of an array are
log-normal. A calibration presses a plate on the array five times: noise of the sensor, the paper's scatter between presses (a gain
common to a press, 1.5 between the largest and the smallest of five) and, as between repeated presses of a real matrix, 4 % per taxel.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray
from report import ROOT

import taxelsim

RADII = (0.002, 0.005, 0.010, 0.020)  # m
NUM_ARRAYS, NUM_STRIPS = 3, 512
NUM_PRESSES, PRESS_SCATTER, REPEAT_SCATTER = 5, 0.174, 0.04
PLATE_LOAD = 40.0  # N
FEATURES = ("edge_angle", "windowed_edge_angle", "ridge_edge_angle")


def strips(random: np.random.Generator) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Objects, poses, loads (N) and edge angles (rad) of the strips."""
    which = random.integers(0, len(RADII), NUM_STRIPS)
    yaw = random.uniform(-85, 85, NUM_STRIPS)
    poses = np.zeros((NUM_STRIPS, 7))
    poses[:, :2] = random.uniform(-0.005, 0.005, (NUM_STRIPS, 2))
    poses[:, 2] = np.array(RADII)[which]
    half = np.radians(yaw) / 2
    # From z to y by a turn about x, then by the yaw about z.
    poses[:, 3:] = np.sqrt(0.5) * np.stack([np.cos(half), np.cos(half), np.sin(half), np.sin(half)], axis=1)
    return which, poses, random.uniform(1, 4, NUM_STRIPS), np.radians(90 + yaw)


def calibrated(device: taxelsim.Device, sensor: taxelsim.Sensor, seed: int) -> NDArray[np.float64]:
    """Gains of an array from presses of a plate, relative to their mean."""
    plate = taxelsim.Model(device, sensor, [taxelsim.HalfSpace()])
    simulator = taxelsim.Simulator(plate, NUM_PRESSES, seed=seed)
    random = np.random.default_rng(seed)
    for press in range(NUM_PRESSES):
        simulator.reset(press, press, gain=float(np.exp(PRESS_SCATTER * random.standard_normal())), gain_spread=REPEAT_SCATTER)
    simulator.set_objects(0, np.tile([0, 0, 0, 1, 0, 0, 0.0], (NUM_PRESSES, 1)))
    simulator.set_loads(np.full(NUM_PRESSES, PLATE_LOAD))
    simulator.step(0.01)
    # Forces by the nominal curve, over what an even pressure would bring to each taxel, by the sensor with equal gains.
    even = taxelsim.Simulator(
        taxelsim.Model(device, sensor.replace(readout=sensor.readout.replace(taxel_gain=[], noise=0)), [taxelsim.HalfSpace()]), 1
    )
    even.set_objects(0, np.array([[0, 0, 0, 1, 0, 0, 0.0]]))
    even.set_loads(np.array([PLATE_LOAD]))
    even.step(0.01)
    slope = sensor.readout.curve[0]
    images = simulator.read().tactile_image.reshape(NUM_PRESSES, -1) / slope + sensor.readout.trigger
    nominal = even.read().tactile_image.reshape(-1) / slope + sensor.readout.trigger
    gains: NDArray[np.float64] = np.median(images / images.mean(axis=1, keepdims=True), axis=0) / (nominal / nominal.mean())
    return gains / gains.mean()


def errors(device: taxelsim.Device, sensor: taxelsim.Sensor, seed: int) -> dict[str, NDArray[np.float64]]:
    """Absolute errors of the edge angles of one array, degrees."""
    which, poses, loads, angles = strips(np.random.default_rng(seed))
    model = taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=radius, length=0.12) for radius in RADII])
    simulator = taxelsim.Simulator(model, NUM_STRIPS, seed=seed, outputs=taxelsim.OutputOptions(contact_features=True))
    simulator.set_objects(which, poses)
    simulator.set_loads(loads)
    simulator.step(0.01)
    contact = simulator.read().contact.as_dict()
    found = {name: contact[name][:, 0] for name in FEATURES}
    return {name: np.abs(np.degrees((value - angles + np.pi / 2) % np.pi - np.pi / 2)) for name, value in found.items()}


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sensor", default="wts0614_soft_cover", help="name of a shipped sensor of one patch")
    parser.add_argument("--noise", type=float, default=17, help="counts")
    parser.add_argument(
        "--scatter", type=float, nargs="+", default=[0.0, 0.1, 0.3, 0.47], help="standard deviation of the logarithm of a gain"
    )
    arguments = parser.parse_args()
    device = taxelsim.Device.open()
    base = taxelsim.load_sensor(ROOT / f"scenes/sensors/{arguments.sensor}.yaml")
    print("median, 95 % quantile of the error, deg\nscatter  calibrated  " + "  ".join(f"{name:>20}" for name in FEATURES))
    for scatter in arguments.scatter:
        for is_calibrated in (False, True):
            parts: dict[str, list[NDArray[np.float64]]] = {name: [] for name in FEATURES}
            for array in range(NUM_ARRAYS):
                gains = np.exp(scatter * np.random.default_rng(1000 + array).standard_normal(base.num_taxels))
                readout = base.readout.replace(taxel_gain=list(gains), noise=arguments.noise)
                sensor = base.replace(readout=readout)
                if is_calibrated:
                    known = calibrated(device, sensor, 2000 + array)
                    sensor = base.replace(readout=readout.replace(calibrated_gain=list(known)))
                for name, values in errors(device, sensor, array).items():
                    parts[name].append(values)
            row = [np.concatenate(parts[name]) for name in FEATURES]
            cells = [f"{np.median(values):.2f}, {np.quantile(values, 0.95):.1f}".rjust(20) for values in row]
            print(f"{scatter:7}  {'yes' if is_calibrated else 'no':>10}  " + "  ".join(cells), flush=True)


if __name__ == "__main__":
    main()
