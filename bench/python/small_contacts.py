#!/usr/bin/env python3
"""Errors of contacts that are not much wider than a sample, against closed forms, with point and with area sampling.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/small_contacts.py

Taxels of 3.4 mm with 4 x 4 samples, law winkler, exponent 1, no point spread, true forces. Worst of --places random places and yaws,
--depth deep: the error of the force, % of stiffness times displaced volume, and the distance of the centre of pressure from the true
one, mm.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from report import ROOT, machine, write_json

import taxelsim

FloatArray = npt.NDArray[np.float64]
SENSOR = ROOT / "scenes/sensors/wts0614_soft_cover.yaml"
SIDES = 96  # of a mesh of a pin
LONG = 0.012  # m


@dataclass
class Case:
    """A shape whose lowest point or face is at height 0 when it stands at `lift` in the orientation `rotation`."""

    name: str
    shape: object
    volume: Callable[[float], float]  # m^3 that it displaces, by depth, m
    lift: float = 0.0  # m
    rotation: tuple[float, float, float, float] = (1, 0, 0, 0)
    yaw: bool = False


def prism(radius: float, length: float) -> taxelsim.Mesh:
    """A cylinder along z as a closed mesh with the cross-section's area of the circle."""
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    radius *= np.sqrt(2 * np.pi / (SIDES * np.sin(2 * np.pi / SIDES)))
    ring = np.column_stack((radius * np.cos(angles), radius * np.sin(angles)))
    vertices = [np.column_stack((ring, np.full(SIDES, z))) for z in (-length / 2, length / 2)]
    vertices += [np.array([[0, 0, -length / 2], [0, 0, length / 2]])]
    triangles = []
    for i in range(SIDES):
        j = (i + 1) % SIDES
        triangles += [(i, j, SIDES + i), (j, SIDES + j, SIDES + i), (j, i, 2 * SIDES), (SIDES + i, SIDES + j, 2 * SIDES + 1)]
    return taxelsim.Mesh(np.vstack(vertices), triangles)


def cap(radius: float) -> Callable[[float], float]:
    """Volume of a spherical cap by its height."""
    return lambda d: np.pi * d * d * (radius - d / 3)


def segment(radius: float, length: float) -> Callable[[float], float]:
    """Volume of a lying cylinder under a plane, by its height."""
    return lambda d: length * (radius**2 * np.arccos(1 - d / radius) - (radius - d) * np.sqrt(2 * radius * d - d * d))


def cases() -> list[Case]:
    """All shapes."""
    lying = tuple(taxelsim.axis_angle((1, 0, 0), np.pi / 2))
    result = []
    for radius in (0.0005, 0.00075, 0.002):
        for kind, shape in (("", taxelsim.Cylinder(radius=radius, length=LONG)), (", mesh", prism(radius, LONG))):
            result.append(Case(f"pin {1e3 * radius:g}{kind}", shape, lambda d, r=radius: np.pi * r * r * d, LONG / 2))
    for side, length in ((0.0105, 0.0105), (0.001, 0.008)):
        for yaw in (False, True):
            name = f"box {1e3 * side:g} x {1e3 * length:g}{', any yaw' if yaw else ''}"
            result.append(Case(name, taxelsim.Box(size=[side, length, 0.01]), lambda d, a=side * length: a * d, 0.005, yaw=yaw))
    for kind, shape in (("", taxelsim.Cylinder(radius=0.0005, length=LONG)), (", mesh", prism(0.0005, LONG))):
        for yaw in (False, True):
            result.append(Case(f"wire 0.5{kind}{', any yaw' if yaw else ''}", shape, segment(0.0005, LONG), 0.0005, lying, yaw))
    for radius in (0.001, 0.002, 0.005, 0.008):
        result.append(Case(f"sphere {1e3 * radius:g}", taxelsim.Sphere(radius=radius), cap(radius), radius))
    result.append(Case("capsule 1", taxelsim.Capsule(radius=0.001, length=1e-9), cap(0.001), 0.001))
    return result


def errors(device: taxelsim.Device, sensor: taxelsim.Sensor, case: Case, places: int, depth: float) -> tuple[float, float]:
    """Worst relative error of the force, and of the centre (m)."""
    rng = np.random.default_rng(1)
    pitch = sensor.patches[0].pitch[0]
    at = rng.uniform(-pitch / 2, pitch / 2, (places, 2))
    yaw = rng.uniform(0, np.pi, places) if case.yaw else np.zeros(places)
    poses = np.zeros((places, 7))
    poses[:, :2] = at
    poses[:, 2] = case.lift - depth
    w, x, y, z = case.rotation
    c, s = np.cos(yaw / 2), np.sin(yaw / 2)
    poses[:, 3:] = np.column_stack((c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w))
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [case.shape]), places)
    simulator.set_objects(0, poses)
    simulator.step(0.01)
    truth = simulator.read().ground_truth
    wrench = np.asarray(truth.contact_wrench, dtype=np.float64)
    expected = sensor.skin.law.normal_contact_stiffness * case.volume(depth)
    force = -wrench[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = np.column_stack((wrench[:, 4], -wrench[:, 3])) / force[:, None]
    off = np.linalg.norm(centre - at, axis=1)
    return float(np.abs(force / expected - 1).max()), float(np.nanmax(off))


def main() -> None:
    """Prints and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=int, default=200)
    parser.add_argument("--depth", type=float, default=0.0003, help="m")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    sensor = taxelsim.load_sensor(SENSOR).replace(psf=taxelsim.Psf())
    rows = []
    print(f"{'':28}{'point: force, %':>16}{'centre, mm':>12}{'area: force, %':>16}{'centre, mm':>12}")
    for case in cases():
        row = {"case": case.name}
        for sampling in (taxelsim.DepthSampling.POINT, taxelsim.DepthSampling.AREA):
            force, centre = errors(device, sensor.replace(depth_sampling=sampling), case, options.places, options.depth)
            row |= {f"{sampling.name.lower()}_force": force, f"{sampling.name.lower()}_centre": centre}
        rows.append(row)
        print(
            f"{case.name:28}{100 * row['point_force']:16.2f}{1e3 * row['point_centre']:12.3f}"
            f"{100 * row['area_force']:16.2f}{1e3 * row['area_centre']:12.3f}",
            flush=True,
        )
    write_json(options.json, {**machine(device), "places": options.places, "depth": options.depth, "errors": rows})


if __name__ == "__main__":
    main()
