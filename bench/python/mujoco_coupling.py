#!/usr/bin/env python3
"""Two-way coupling with MuJoCo: weight at rest and energy after release, with every shipped sensor that has forces.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/mujoco_coupling.py --json bench/results/mujoco_coupling-lavapipe.json

Bodies of 20 g to 1 kg, time step 1 ms. Rest: an object is put on the skin and left alone until the weights of all masses are right within
0.5 % in 20 consecutive frames.
Energy: without gravity, objects are thrown at the skin with random velocities, half of them pressed by five times their weight for 60 ms;
kinetic energy at the end over initial energy plus the work of the pressing force. That work is, in a time step, the force times the mean of
the velocities before and after, by which it changes the kinetic energy. On curved skins the object at rest is on a vertical slide, because
it would roll off.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch
from numpy.typing import NDArray
from report import machine, write_json

import taxelsim
import taxelsim.mujoco

MASSES = np.array([0.02, 0.05, 0.1, 0.3, 1.0])  # kg
STEP = 0.001  # s
GRAVITY = 9.81  # m/s^2
CURVED = ("fingertip_cylinder", "fingertip_sphere", "weiss_dsa_distal")
SENSORS = [
    file.stem
    for file in sorted((taxelsim.SCENES / "sensors").glob("*.yaml"))
    if not isinstance(taxelsim.load_sensor(file).skin.law, taxelsim.Proximity)
]
HEIGHT = 0.01  # m, of the middle of an object above its lowest point
REST = 0.005  # error of the weight in 20 consecutive frames of an object at rest
OBJECTS = ("ball", "disc", "box")


def geom_text(name: str, sensor: taxelsim.Sensor) -> str:
    """A ball of 10 mm, a disc of 20 mm diameter, or a box over the whole array."""
    half = np.abs(np.asarray(sensor.taxel_positions)[:, :2]).max(axis=0) + 0.005
    box = f'type="box" size="{half[0]} {half[1]} {HEIGHT}"'
    return {"ball": f'type="sphere" size="{HEIGHT}"', "disc": f'type="cylinder" size=".01 {HEIGHT}"', "box": box}[name]


def make(
    sensor_name: str, object_name: str, masses: NDArray[np.float64], joint: str, gravity: float
) -> tuple[Any, Any, NDArray[np.float64]]:
    """Coupling, batch and moments of inertia (N, 3) of one object of each mass."""
    sensor = taxelsim.load_sensor(taxelsim.SCENES / f"sensors/{sensor_name}.yaml")
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
      <option timestep="{STEP}" gravity="0 0 {-gravity}"/>
      <worldbody><body><site name="skin"/></body>
        <body name="object" pos="0 0 {HEIGHT}">{joint}<geom name="object" {geom_text(object_name, sensor)} mass="1"/></body>
      </worldbody></mujoco>""")
    body = model.body("object").id
    inertia = model.body_inertia[body] * masses[:, np.newaxis]
    batch = Batch(model, len(masses))
    batch.expand("body_mass")[:, body] = masses
    batch.expand("body_inertia")[:, body] = inertia
    batch.set_const()
    return taxelsim.mujoco.couple(model, {"skin": sensor}, ["object"], num_instances=len(masses)), batch, inertia


def rest(sensor_name: str, object_name: str, max_steps: int) -> dict[str, Any]:
    """Largest error of the weight over the masses, of the mean of 20 frames and of a single one."""
    joint = '<joint type="slide" axis="0 0 1"/>' if sensor_name in CURVED else "<freejoint/>"
    tactile, batch, _ = make(sensor_name, object_name, MASSES, joint, GRAVITY)
    recent: list[NDArray[np.float64]] = []
    taken = 0
    while taken < max_steps:
        taken += 1
        wrench = tactile.step(batch)["skin"].ground_truth.contact_wrench
        recent = [*recent[-19:], -wrench[:, 2] / (MASSES * GRAVITY) - 1]
        if len(recent) == 20 and np.abs(recent).max() < REST:
            break
    errors = np.array(recent)
    return {"mean_error": float(np.abs(errors.mean(axis=0)).max()), "frame_error": float(np.abs(errors).max()), "time_s": taken * STEP}


def energy(sensor_name: str, object_name: str, num_throws: int, steps: int = 250) -> dict[str, Any]:
    """Largest ratio of energy after release to energy put in."""
    masses = np.repeat(MASSES, 2 * num_throws)
    tactile, batch, inertia = make(sensor_name, object_name, masses, "<freejoint/>", 0)
    random = np.random.default_rng(1)
    count = len(masses)
    batch.qpos[:, :2] += random.uniform(-0.004, 0.004, (count, 2))
    batch.qpos[:, 2] += 0.0005
    batch.qvel[:, :3] = random.normal(size=(count, 3)) * (0.05, 0.05, 0.1) - (0, 0, 0.5)  # m/s
    batch.qvel[:, 3:] = random.normal(size=(count, 3)) * 3  # rad/s

    def kinetic() -> NDArray[np.float64]:
        velocity = np.asarray(batch.qvel)
        return np.asarray((masses * (velocity[:, :3] ** 2).sum(axis=1) + (inertia * velocity[:, 3:] ** 2).sum(axis=1)) / 2)

    put_in, touched, load = kinetic(), np.zeros(count, bool), np.zeros(count)
    for k in range(steps):
        force = np.where((np.arange(count) % 2 == 0) & (k < 60), 5 * masses * GRAVITY, 0)
        batch.xfrc_applied[:, -1, 2] = -force
        velocity = batch.qvel[:, 2].copy()
        wrench = tactile.step(batch)["skin"].ground_truth.contact_wrench
        put_in -= force * STEP * (velocity + batch.qvel[:, 2]) / 2
        load = np.maximum(load, np.linalg.norm(wrench[:, :3], axis=1))
        touched |= wrench.any(axis=1)
    released = touched & ~wrench.any(axis=1)
    if not np.isfinite(batch.qpos).all() or not released.any():
        sys.exit(f"mujoco_coupling.py: {sensor_name}, {object_name}: unstable, or nothing touched the skin and left it")
    ratio = kinetic()[released] / put_in[released]
    return {"energy_ratio": float(ratio.max()), "released": int(released.sum()), "throws": count, "largest_force_N": float(load.max())}


def main() -> None:
    """Runs all sensors and objects."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sensors", default=",".join(SENSORS), help="list, separated by commas")
    parser.add_argument("--steps", type=int, default=4000, help="most time steps until rest")
    parser.add_argument("--throws", type=int, default=2, help="per mass, pressed and not")
    parser.add_argument("--json", type=Path, help="file of results to write")
    options = parser.parse_args()
    if not set(options.sensors.split(",")) <= set(SENSORS):
        parser.error(f"--sensors: {options.sensors} is not allowed: {', '.join(SENSORS)}")
    results: dict[str, Any] = {
        **machine(taxelsim.Device.open()),
        "mujoco": mujoco.__version__,
        "step_s": STEP,
        "masses_kg": MASSES.tolist(),
    }
    columns = ["sensor", "object", "error of the weight, 20 frames", "worst frame", "at rest after", "energy out / in", "largest force"]
    print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for sensor in options.sensors.split(","):
        for name in OBJECTS:
            row = {**rest(sensor, name, options.steps), **energy(sensor, name, options.throws)}
            results[f"{sensor}/{name}"] = row
            print(
                f"| {sensor} | {name} | {row['mean_error']:.2%} | {row['frame_error']:.2%} | {row['time_s']:.2f} s "
                f"| {row['energy_ratio']:.3f} | {row['largest_force_N']:.0f} N |",
                flush=True,
            )
            write_json(options.json, results)


if __name__ == "__main__":
    main()
