#!/usr/bin/env python3
"""Objects at rest on an array: taxelsim's forces compared with MuJoCo's contact forces and its touch sensor.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/mujoco_forces.py

The same bodies rest on a pad by MuJoCo's own contacts, and on the skin of wts0614 by two-way coupling. Sum, centre of the forces, and
angle of the principal axis of a contact, of MuJoCo's contact points and of taxelsim's true and measured forces.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

import taxelsim
import taxelsim.mujoco

GRAVITY = 9.81  # m/s^2
# Name: geom, inertial frame, pose of the body.
OBJECTS = {
    "ball of 10 mm, 100 g": ('type="sphere" size=".01"', 'pos="0 0 0" mass=".1"', 'pos=".002 .003 .0101"'),
    "box of 16 x 30 mm, 200 g": ('type="box" size=".008 .015 .01"', 'pos="0 0 0" mass=".2"', 'pos=".001 -.002 .0101"'),
    "the same box, mass 3 mm off its middle": ('type="box" size=".008 .015 .01"', 'pos=".001 .003 0" mass=".2"', 'pos=".001 -.002 .0101"'),
    "lying cylinder of 8 mm, 200 g, at 60 degrees": (
        'type="cylinder" size=".008 .008" euler="90 0 0"',
        'pos="0 0 0" mass=".2"',
        'pos=".001 -.002 .0081" euler="0 0 -30"',
    ),
}


def model_of(geom: str, inertial: str, pose: str, collide: bool) -> mujoco.MjModel:
    """An object above a pad with a touch sensor; with MuJoCo's contacts or without."""
    bits = "" if collide else 'contype="0" conaffinity="0"'
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
      <option timestep="0.001" gravity="0 0 {-GRAVITY}"/>
      <worldbody>
        <body name="pad"><geom type="box" size=".03 .04 .005" pos="0 0 -.005" {bits}/>
          <site name="skin" size=".03 .04 .01" type="box"/></body>
        <body name="object" {pose}><freejoint/><inertial {inertial} diaginertia="2e-5 2e-5 2e-5"/>
          <geom name="object" {geom}/></body>
      </worldbody>
      <sensor><touch site="skin"/></sensor></mujoco>""")


def moments(points: NDArray[np.float64], forces: NDArray[np.float64]) -> tuple[float, NDArray[np.float64], float]:
    """Sum, centre and principal angle (rad) of forces at points (C, 2)."""
    center = forces @ points / forces.sum()
    (xx, xy), (_, yy) = ((points - center).T * forces) @ (points - center)
    return float(forces.sum()), center, 0.5 * float(np.arctan2(2 * xy, xx - yy))


def of_mujoco(model: mujoco.MjModel) -> tuple[float, NDArray[np.float64], float, float]:
    """Moments of the contact forces at rest, and the touch sensor."""
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 3000)
    mujoco.mj_forward(model, data)
    forces = []
    for k in range(data.ncon):
        force = np.zeros(6)
        mujoco.mj_contactForce(model, data, k, force)
        forces.append(force[0])
    return *moments(data.contact.pos[:, :2], np.array(forces)), float(data.sensordata[0])


def main() -> None:
    """Prints the table."""
    columns = ["object", "m g", "MuJoCo, contacts", "touch", "taxelsim, true", "measured", "centre, MuJoCo", "true", "measured"]
    columns += ["angle, MuJoCo", "true", "measured"]
    print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for name, (geom, inertial, pose) in OBJECTS.items():
        total, center, angle, touch = of_mujoco(model_of(geom, inertial, pose, collide=True))
        model = model_of(geom, inertial, pose, collide=False)
        data = mujoco.MjData(model)
        tactile = taxelsim.mujoco.couple(model, {"skin": taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"}, ["object"])
        frame = tactile.step(data, 1500)["skin"]
        weight = model.body("object").mass[0] * GRAVITY
        centers = [center, frame.ground_truth.center_of_pressure[0], frame.center_of_pressure[0]]
        angles = [angle, frame.ground_truth.edge_angle[0], frame.edge_angle[0]]
        is_long = "cylinder" in name
        cells = [f"{weight:.4f} N", f"{total:.4f}", f"{touch:.4f}"]
        cells += [f"{frame.ground_truth.total_force[0]:.4f}", f"{frame.total_force[0]:.4f}"]
        cells += [f"{1e3 * c[0]:.2f}, {1e3 * c[1]:.2f} mm" for c in centers]
        cells += [f"{np.rad2deg(a):.1f}" if is_long else "-" for a in angles]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
