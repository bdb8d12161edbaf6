#!/usr/bin/env python3
"""Forces of an elastic layer under flat pins and spheres, with point and with area sampling, against closed forms.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/layer_pins.py

Taxels of 3.4 mm with 4 x 4 samples, law elastic_layer of 2 mm, E 1 MPa, no point spread, true forces at --places random places on a
taxel. Pins are 1 mm deep, spheres 0.3 mm. Lowest, mean and highest force in % of theory: Boussinesq's punch and Hertz's sphere on a
half-space, the integral equation of pin_force() on a bonded layer; the largest distance of the centre of pressure from the object's
middle, mm; and the mean number of iterations.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt
from report import ROOT, machine, write_json

import taxelsim

FloatArray = npt.NDArray[np.float64]
SENSOR = ROOT / "scenes/sensors/wts0614_elastic_layer.yaml"
MODULUS = 1e6  # Pa
LENGTH = 0.012  # m, of pins
PIN_DEPTH = 0.001  # m
SPHERE_DEPTH = 0.0003  # m
PINS = (0.0005, 0.001, 0.002)  # radii, m
SPHERES = (0.001, 0.002, 0.005, 0.02)


def sensor_of(poisson_ratio: float, bonded: bool, sampling: taxelsim.DepthSampling) -> taxelsim.Sensor:
    """The array with a layer of 2 mm."""
    base = taxelsim.ElasticLayer.Base.BONDED if bonded else taxelsim.ElasticLayer.Base.HALF_SPACE
    law = taxelsim.ElasticLayer(elastic_modulus=MODULUS, poisson_ratio=poisson_ratio, base=base, iterations=100, tolerance=1e-4)
    sensor = taxelsim.load_sensor(SENSOR)
    return sensor.replace(samples_per_taxel=4, psf=taxelsim.Psf(), depth_sampling=sampling, skin=sensor.skin.replace(law=law))


def pressed(device: taxelsim.Device, sensor: taxelsim.Sensor, shape: object, height: float, places: FloatArray) -> dict[str, FloatArray]:
    """Forces (N), distances of the centre of pressure (m) and iterations under a shape whose origin is at `height` (m)."""
    poses = np.zeros((len(places), 7))
    poses[:, :2], poses[:, 2], poses[:, 3] = places, height, 1
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [shape]), len(places))
    simulator.set_objects(0, poses)
    simulator.step(0.01)
    truth = simulator.read().ground_truth
    wrench = np.asarray(truth.contact_wrench, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = np.column_stack((wrench[:, 4], -wrench[:, 3])) / -wrench[:, 2:3]
    off = np.linalg.norm(centre - places, axis=1)
    return {"force": -wrench[:, 2], "off": off, "iterations": np.asarray(truth.contact_iterations, dtype=np.float64)}


def main() -> None:
    """Prints and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=int, default=60)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    places = np.random.default_rng(1).uniform(-0.0017, 0.0017, (options.places, 2))
    rows = []
    for bonded, poisson_ratio in ((False, 0.49), (True, 0.49), (True, 0.3)):
        plane = MODULUS / (1 - poisson_ratio**2)
        for sampling in (taxelsim.DepthSampling.POINT, taxelsim.DepthSampling.AREA):
            sensor = sensor_of(poisson_ratio, bonded, sampling)
            shapes = [("pin", r, taxelsim.Cylinder(radius=r, length=LENGTH), LENGTH / 2 - PIN_DEPTH) for r in PINS]
            if not bonded:
                shapes += [("sphere", r, taxelsim.Sphere(radius=r), r - SPHERE_DEPTH) for r in SPHERES]
            for kind, radius, shape, height in shapes:
                theory = 4 / 3 * plane * np.sqrt(radius) * SPHERE_DEPTH**1.5 if kind == "sphere" else 2 * radius * plane * PIN_DEPTH
                if bonded:
                    theory = taxelsim.pin_force(sensor.skin, 2 * radius, PIN_DEPTH)
                result = pressed(device, sensor, shape, height, places)
                percent = 100 * result["force"] / theory
                row = {
                    "base": "bonded" if bonded else "half_space",
                    "poisson_ratio": poisson_ratio,
                    "case": f"{kind} {1e3 * radius:g}",
                    "sampling": sampling.name.lower(),
                    "percent": [float(percent.min()), float(percent.mean()), float(percent.max())],
                    "centre": float(np.nanmax(result["off"])),
                    "iterations": float(result["iterations"].mean()),
                }
                rows.append(row)
                numbers = "".join(f"{value:8.1f}" for value in row["percent"])
                print(f"{row['base']:10} {poisson_ratio:4} {row['case']:10} {row['sampling']:5}{numbers}", end="")
                print(f"{1e3 * row['centre']:8.3f}{row['iterations']:6.1f}", flush=True)
    write_json(options.json, {**machine(device), "places": options.places, "rows": rows})


if __name__ == "__main__":
    main()
