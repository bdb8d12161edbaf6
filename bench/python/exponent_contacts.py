#!/usr/bin/env python3
"""Errors of the force of small contacts under pressure = stiffness x depth^exponent, with point and with area sampling.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/exponent_contacts.py

Taxels of 3.4 mm with 4 x 4 samples. Worst of --places random places, %, 0.3 mm deep, against the integral over the contact.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from report import ROOT, machine, write_json

import taxelsim

SENSOR = ROOT / "scenes/sensors/wts0614_soft_cover.yaml"
STIFFNESS = 1e8  # Pa/m at a depth of 1 mm
DEPTH = 3e-4  # m
RINGS = 20000  # of the integrals


def volume_of(radius: float, exponent: float) -> float:
    """Integral of depth^exponent over the contact of a sphere."""
    edge = np.sqrt(2 * radius * DEPTH - DEPTH**2)
    rings = edge * (np.arange(RINGS) + 0.5) / RINGS
    return float((2 * np.pi * rings * (DEPTH - radius + np.sqrt(radius**2 - rings**2)) ** exponent).sum() * edge / RINGS)


def main() -> None:
    """Prints and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=int, default=200)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    base = taxelsim.load_sensor(SENSOR).replace(psf=taxelsim.Psf())
    rng = np.random.default_rng(5)
    poses = np.zeros((options.places, 7))
    poses[:, :2] = rng.uniform(-0.0017, 0.0017, (options.places, 2))
    poses[:, 3] = 1
    radii = (0.001, 0.002, 0.004, 0.008)
    shapes = [taxelsim.Cylinder(radius=0.0005, length=0.01), *(taxelsim.Sphere(radius=radius) for radius in radii)]
    names, lifts = ["pin 0.5", *(f"sphere {1e3 * radius:g}" for radius in radii)], (0.005, *radii)
    rows = []
    print(f"{'exponent':>9}{'sampling':>9}" + "".join(f"{name:>10}" for name in names))
    for exponent in (1.0, 1.5, 2.0, 3.0):
        law = taxelsim.Winkler(normal_contact_stiffness=STIFFNESS * 1e-3 ** (1 - exponent), normal_exponent=exponent)
        volumes = [np.pi * 0.0005**2 * DEPTH**exponent, *(volume_of(radius, exponent) for radius in radii)]
        for sampling in (taxelsim.DepthSampling.POINT, taxelsim.DepthSampling.AREA):
            sensor = base.replace(depth_sampling=sampling, skin=base.skin.replace(law=law))
            simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, shapes), options.places)
            errors = []
            for number, (lift, volume) in enumerate(zip(lifts, volumes, strict=True)):
                poses[:, 2] = lift - DEPTH
                simulator.set_objects(number, poses)
                simulator.step(0.01)
                force = -np.asarray(simulator.read().ground_truth.contact_wrench, dtype=np.float64)[:, 2]
                errors.append(float(np.abs(force / (law.normal_contact_stiffness * volume) - 1).max()))
            rows.append({"exponent": exponent, "sampling": sampling.name.lower(), "errors": errors})
            print(f"{exponent:9g}{sampling.name.lower():>9}" + "".join(f"{100 * error:10.2f}" for error in errors), flush=True)
    write_json(options.json, {**machine(device), "places": options.places, "contacts": names, "rows": rows})


if __name__ == "__main__":
    main()
