#!/usr/bin/env python3
"""Errors of shear forces and of torsion under small contacts, against closed forms, with point and with area sampling.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/shear_contacts.py

Springs with Coulomb friction on taxels of 3.4 mm: the traction is the smaller of tangential stiffness x way and friction coefficient x
pressure, integrated over the contact. Worst of --places random places and directions, %, 0.5 mm deep, for slides of 0.05 to 0.2 mm and
turns of 0.02 and 0.1 rad.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from report import ROOT, machine, write_json

import taxelsim

SENSOR = ROOT / "scenes/sensors/wts0614_soft_cover.yaml"
TANGENTIAL_STIFFNESS = 1e8  # N/m^3
FRICTION_COEFFICIENT = 0.5
DEPTH = 0.0005  # m
STEPS = 4
RINGS = 20000  # of the closed forms' integrals


@dataclass
class Contact:
    """A disc (the end of a pin) or a sphere."""

    name: str
    shape: object
    radius: float  # m, of the contact
    lift: float  # m
    depth: np.ndarray  # m, over the rings


def contacts() -> list[Contact]:
    """All contacts."""
    result = []
    for radius in (0.005, 0.002):
        result.append(
            Contact(f"disc {1e3 * radius:g}", taxelsim.Cylinder(radius=radius, length=0.01), radius, 0.005, np.full(RINGS, DEPTH))
        )
    for radius in (0.008, 0.004):
        edge = float(np.sqrt(2 * radius * DEPTH - DEPTH**2))
        rings = edge * (np.arange(RINGS) + 0.5) / RINGS
        depth = DEPTH - radius + np.sqrt(radius**2 - rings**2)
        result.append(Contact(f"sphere {1e3 * radius:g}", taxelsim.Sphere(radius=radius), edge, radius, depth))
    return result


def worst(model: taxelsim.Model, contact: Contact, slide: float, turn: float, places: int) -> float:
    """Worst relative error of the shear force of a slide (m), or of the torque of a turn (rad)."""
    rng = np.random.default_rng(3)
    start = rng.uniform(-0.0017, 0.0017, (places, 2))
    direction = rng.uniform(0, np.pi, places)
    simulator = taxelsim.Simulator(model, places)
    poses = np.zeros((places, 7))
    for step in range(STEPS + 1):
        part = step / STEPS
        poses[:, :2] = start + slide * part * np.column_stack((np.cos(direction), np.sin(direction)))
        poses[:, 2] = contact.lift - DEPTH
        poses[:, 3], poses[:, 6] = np.cos(turn * part / 2), np.sin(turn * part / 2)
        simulator.set_objects(0, poses)
        simulator.step(0.01)
        wrench = np.asarray(simulator.read().ground_truth.contact_wrench, dtype=np.float64)
    rings = contact.radius * (np.arange(RINGS) + 0.5) / RINGS
    limit = FRICTION_COEFFICIENT * model.sensor.skin.law.normal_contact_stiffness * contact.depth
    way = np.full(RINGS, slide) if slide else turn * rings
    traction = np.minimum(TANGENTIAL_STIFFNESS * way, limit) * 2 * np.pi * rings * contact.radius / RINGS
    if slide:
        found, expected = np.hypot(wrench[:, 0], wrench[:, 1]), traction.sum()
    else:
        found = np.abs(wrench[:, 5] - (poses[:, 0] * wrench[:, 1] - poses[:, 1] * wrench[:, 0]))
        expected = (traction * rings).sum()
    return float(np.abs(found / expected - 1).max())


def main() -> None:
    """Prints and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=int, default=50)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    sensor = taxelsim.load_sensor(SENSOR)
    friction = taxelsim.Friction(tangential_stiffness=TANGENTIAL_STIFFNESS, friction_coefficient=FRICTION_COEFFICIENT)
    sensor = sensor.replace(psf=taxelsim.Psf(), skin=sensor.skin.replace(friction=friction))
    kinds = [(sampling, count) for count in (4, 8) for sampling in (taxelsim.DepthSampling.POINT, taxelsim.DepthSampling.AREA)]
    rows = []
    print(f"{'':12}{'motion':>12}" + "".join(f"{f'{sampling.name.lower()}, {count}':>12}" for sampling, count in kinds))
    for contact in contacts():
        models = [taxelsim.Model(device, sensor.replace(depth_sampling=s, samples_per_taxel=n), [contact.shape]) for s, n in kinds]
        for slide, turn in ((5e-5, 0.0), (1e-4, 0.0), (2e-4, 0.0), (0.0, 0.02), (0.0, 0.1)):
            motion = f"{1e3 * slide:g} mm" if slide else f"{turn:g} rad"
            errors = [worst(model, contact, slide, turn, options.places) for model in models]
            rows.append({"contact": contact.name, "motion": motion, "errors": errors})
            print(f"{contact.name:12}{motion:>12}" + "".join(f"{100 * error:12.1f}" for error in errors), flush=True)
    kinds_text = [f"{sampling.name.lower()}, {count} x {count}" for sampling, count in kinds]
    write_json(options.json, {**machine(device), "places": options.places, "kinds": kinds_text, "rows": rows})


if __name__ == "__main__":
    main()
