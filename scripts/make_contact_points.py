#!/usr/bin/env python3
"""Writes scenes/contact_points/rolling_and_sliding.csv: contacts of MuJoCo, in the world, for scenes/recorded_contacts.yaml.

    make_contact_points.py [DIRECTORY]

Needs the package mujoco. Episode 0: a ball rolls over a plate. Episode 1: a block is dropped flat, then pushed. The plate's top is the skin of
a sensor at z = 0.5 m, with the axes of the world. Each row is a contact at the end of a step of 10 ms: its position and the force on the
plate, both in the world.
"""

import sys
from pathlib import Path

import mujoco
import numpy as np

STEPS, SUBSTEPS = 50, 10  # steps of 10 ms, of ten time steps each
MODEL = """<mujoco>
  <option timestep="0.001"/>
  <worldbody>
    <geom name="plate" type="box" size="0.05 0.05 0.01" pos="0 0 0.49"/>
    {body}
  </worldbody>
</mujoco>"""
BALL = '<body pos="0 -0.02 0.51"><freejoint/><geom type="sphere" size="0.01" mass="0.2"/></body>'
BLOCK = '<body pos="0.001 -0.004 0.5051"><freejoint/><geom type="box" size="0.006 0.008 0.005" mass="0.2" friction="0.3"/></body>'


def contacts(data: mujoco.MjData) -> list[tuple[float, ...]]:
    """Position and force on the plate of each contact, in the world."""
    rows = []
    wrench = np.empty(6)
    for k, contact in enumerate(data.contact):
        mujoco.mj_contactForce(data.model, data, k, wrench)
        # The rows of the frame are the normal, from geom1 to geom2, and two tangents; the force is that on geom2.
        sign = 1 if contact.geom2 == data.model.geom("plate").id else -1
        force = sign * wrench[:3] @ contact.frame.reshape(3, 3)
        rows.append((*contact.pos, *force))
    return rows


def episode(body: str, velocity: tuple[float, float, float], push: float) -> list[tuple[int, tuple[float, ...]]]:
    """(step, contact) of all contacts. velocity: at the start, m/s. push: N along y from step 10 on."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(body=body))
    data = mujoco.MjData(model)
    data.qvel[:3] = velocity
    rows = []
    for step in range(STEPS):
        data.xfrc_applied[1, 1] = push if step >= 10 else 0
        mujoco.mj_step(model, data, SUBSTEPS)
        mujoco.mj_forward(model, data)
        rows += [(step, contact) for contact in contacts(data)]
    return rows


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[1] / "scenes/contact_points")
    folder.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Contacts of MuJoCo, written by scripts/make_contact_points.py: m and N, in the world.",
        "episode,step,x_m,y_m,z_m,fx_N,fy_N,fz_N",
    ]
    for number, rows in enumerate((episode(BALL, (0, 0.08, 0), 0), episode(BLOCK, (0, 0, 0), 0.9))):
        lines += [f"{number},{step}," + ",".join(f"{round(value, 9) + 0.0:.6g}" for value in contact) for step, contact in rows]
    (folder / "rolling_and_sliding.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
