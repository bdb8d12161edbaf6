#!/usr/bin/env python3
"""What the models of the paper's Table I do at rest and in motion, on one array under one cylinder.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/table_one.py

Taxel forces before the point spread, of the laws with one foundation stiffness, next to those of plain springs: at rest under 5 N,
after a step of the depth, and while the cylinder slides across its axis at three speeds.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from report import ROOT, machine, write_json

import taxelsim

STIFFNESS = 1.73e8  # N/m^3
LOAD = 5.0  # N
RADIUS = 0.008  # m
STEP = 0.001  # s
SPEEDS = (0.0001, 0.001, 0.01)  # m/s
SLIDE = 0.0004  # m
LYING = taxelsim.axis_angle((1, 0, 0), np.pi / 2)


def models() -> dict[str, taxelsim.Skin]:
    """Skins by the name of what they model; the first is the reference."""
    skin = taxelsim.load_sensor(ROOT / "scenes/sensors/wts0614_soft_cover.yaml").skin
    springs = taxelsim.Winkler(normal_contact_stiffness=STIFFNESS)
    shear = taxelsim.Friction(tangential_stiffness=1e8, friction_coefficient=0.5)
    return {
        "springs, Coulomb friction (the paper's model)": skin.replace(law=springs, friction=shear),
        "SkinSim: mass_spring_damper": skin.replace(law=taxelsim.MassSpringDamper(normal_contact_stiffness=STIFFNESS), friction=shear),
        "OpenGrasp: lugre": skin.replace(law=taxelsim.LuGre(normal_contact_stiffness=STIFFNESS), friction=taxelsim.Friction()),
        "RobWorkSim: deformation_mask": skin.replace(
            law=taxelsim.DeformationMask(normal_contact_stiffness=STIFFNESS), friction=taxelsim.Friction()
        ),
        "Pezzementi et al.: proximity": skin.replace(law=taxelsim.Proximity(sensitivity=STIFFNESS), friction=taxelsim.Friction()),
    }


class Press:
    """The cylinder on one skin."""

    def __init__(self, device: taxelsim.Device, skin: taxelsim.Skin) -> None:
        sensor = taxelsim.load_sensor(ROOT / "scenes/sensors/wts0614_soft_cover.yaml").replace(psf=taxelsim.Psf(), skin=skin)
        self.simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=RADIUS, length=0.03)]), 1)
        self.simulator.reset()

    def at(self, depth: float, x: float = 0.0, steps: int = 1) -> taxelsim.GroundTruth:
        """True values after `steps` steps at a depth and a place (m)."""
        for _ in range(steps):
            self.simulator.set_objects(0, np.array([[x, 0.0005, RADIUS - depth, *LYING]]))
            self.simulator.step(STEP)
            truth = self.simulator.read().ground_truth
        return truth.copy()


def depth_under_load(device: taxelsim.Device, skin: taxelsim.Skin) -> float:
    """Depth (m) at which springs carry LOAD, by bisection."""
    press, low, high = Press(device, skin), 0.0, 0.001
    for _ in range(40):
        middle = (low + high) / 2
        press.simulator.reset()
        low, high = (low, middle) if -press.at(middle).contact_wrench[0, 2] > LOAD else (middle, high)
    return high


def row_of(device: taxelsim.Device, skin: taxelsim.Skin, depth: float, reference: np.ndarray) -> dict[str, object]:
    """All figures of one skin."""
    rest = Press(device, skin).at(depth, steps=1000)
    image = rest.tactile_normal_force[0]
    press = Press(device, skin)
    press.at(depth / 2, steps=1000)
    after = [float(press.at(depth).tactile_normal_force.sum()) for _ in range(40)]
    final = float(press.at(depth, steps=1000).tactile_normal_force.sum())
    shears = []
    for speed in SPEEDS:
        press = Press(device, skin)
        press.at(depth, steps=50)
        count = max(1, round(SLIDE / (speed * STEP)))
        for k in range(count):
            truth = press.at(depth, speed * STEP * (k + 1))
        normal = -truth.contact_wrench[0, 2]
        shears.append(float(truth.contact_wrench[0, 0] / normal) if normal > 0 else 0.0)
    return {
        "image_off": float(np.abs(image - reference).sum() / reference.sum()),
        "sum": float(image.sum()),
        "wrench": float(-rest.contact_wrench[0, 2]),
        "after_1_ms": after[0] / final,
        "largest": max(after) / final,
        "shear_per_newton": shears,
    }


def main() -> None:
    """Prints and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    skins = models()
    plain = next(iter(skins.values()))
    depth = depth_under_load(device, plain)
    reference = Press(device, plain).at(depth).tactile_normal_force[0]
    rows = {}
    for name, skin in skins.items():
        rows[name] = row = row_of(device, skin, depth, reference)
        shears = ", ".join(f"{shear:.3f}" for shear in row["shear_per_newton"])
        print(
            f"{name:46} image off by {100 * row['image_off']:6.2f} %  sum {row['sum']:.3f} N  wrench {row['wrench']:.3f} N  "
            f"1 ms after a step {row['after_1_ms']:.3f}, largest {row['largest']:.3f}  shear/N {shears}",
            flush=True,
        )
    write_json(options.json, {**machine(device), "depth": depth, "rows": rows})


if __name__ == "__main__":
    main()
