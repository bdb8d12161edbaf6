#!/usr/bin/env python3
"""Objects at rest on an array: taxelsim's forces compared with MuJoCo's contact forces, touch sensors and tactile sensor.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/mujoco_forces.py

The same bodies rest on a pad by MuJoCo's own contacts, and on the skin of wts0614_soft_cover by two-way coupling. Sum, centre of the
forces, and angle of the principal axis, all in one process. Shapes, places and weights are those of the scenes in
scenes/experiments/mujoco/:

- contacts: MuJoCo's contact points and their normal forces, on a pad of one box;
- boxes: a pad of 84 boxes of the size of the taxels, each with a touch sensor, the usual way to build an array in MuJoCo;
- tactile: MuJoCo's tactile sensor with a vertex per taxel. It has depths and no forces, so the depths, at the pose of taxelsim's
  object at rest, are multiplied by the stiffness of the skin and the area of a taxel;
- taxelsim: true and measured forces of that coupling;
- scene alone: those of the data set that `taxelsim generate` makes of the scene, whose load is the weight, without MuJoCo.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

import taxelsim
import taxelsim.mujoco
from taxelsim.dataset import Dataset

GRAVITY = 9.81  # m/s^2
ROWS, COLS, PITCH = 6, 14, 0.0034  # of the sensor; m
PAD = 0.005  # m, half-height of the pad
CLEARLY_LONG = 1.5  # ratio of the second moments above which an angle is given

Vector = NDArray[np.float64]
Moments = tuple[float, Vector, float]


# Of the table: scene, the scene whose pose the body starts at, and centre of mass in the frame of the object, m.
CASES = {
    "ball of 10 mm, 100 g": ("ball", "ball", (0, 0, 0)),
    "box of 16 x 30 mm, 200 g": ("box", "box", (0, 0, 0)),
    "the same box, mass 3 mm off its middle": ("box_off_center", "box", (0.001, 0.003, 0)),
    "lying cylinder of 8 mm, 200 g, at 60 degrees": ("cylinder", "cylinder", (0, 0, 0)),
    "mesh, face of 3 x 24 mm, 100 g, at 110 degrees": ("roof", "roof", (0, 0, -0.004)),
}
DROP = 1e-4  # m, of an object above the pad at the start


@dataclass(frozen=True)
class Case:
    """A scene, what taxelsim makes of it alone, and its object for MuJoCo."""

    scene: taxelsim.Scene
    data: Dataset
    body: str  #: Attributes of the body: its pose at the start.
    inertial: str  #: Attributes of its inertial frame.
    geom: str  #: Attributes of its geom.
    mesh: str  #: Vertices of a mesh; empty for other shapes.


def numbers(values: Iterable[float]) -> str:
    """Numbers of an MJCF attribute."""
    return " ".join(f"{value:.12g}" for value in values)


def geom_of(shape: object) -> tuple[str, str]:
    """Attributes of a geom, and the vertices of its mesh."""
    match shape:
        case taxelsim.Sphere():
            return f'type="sphere" size="{shape.radius}"', ""
        case taxelsim.Box():
            return f'type="box" size="{numbers(side / 2 for side in shape.size)}"', ""
        case taxelsim.Cylinder():
            return f'type="cylinder" size="{shape.radius} {shape.length / 2}"', ""
        case taxelsim.Mesh():
            return 'type="mesh" mesh="object"', numbers(shape.vertices.ravel())
    raise SystemExit(f"mujoco_forces.py: {shape!r} has no geom")


def simulated(name: str, folder: Path) -> tuple[taxelsim.Scene, Dataset]:
    """A scene and its data set."""
    scene = taxelsim.load_scene(taxelsim.SCENES / f"experiments/mujoco/{name}.yaml")
    taxelsim.generate(scene, folder / name)  # a data set that is complete stays as it is
    return scene, Dataset(folder / name)


def case_of(name: str, start: str, center: tuple[float, float, float], folder: Path) -> Case:
    """Simulates a scene, and turns its object and load into a body."""
    scene, data = simulated(name, folder)
    _, at_start = simulated(start, folder)
    pose, mass = at_start["data/pose"][0], scene.randomization["load"][0] / GRAVITY
    position = (*pose[:2], pose[2] + at_start["meta/depth"][0] + DROP)
    geom, mesh = geom_of(scene.objects[0].shape)
    body = f'pos="{numbers(position)}" quat="{numbers(pose[3:])}"'
    return Case(scene, data, body, f'pos="{numbers(center)}" mass="{mass:.12g}"', geom, mesh)


def centers() -> Vector:
    """(84, 2), m: middles of the taxels."""
    x, y = np.meshgrid((np.arange(ROWS) - (ROWS - 1) / 2) * PITCH, (np.arange(COLS) - (COLS - 1) / 2) * PITCH, indexing="ij")
    return np.column_stack((x.ravel(), y.ravel()))


def pad_text(kind: str) -> tuple[str, str, str]:
    """Geoms and sites of the pad, sensors and assets. kind: one box, boxes, tactile, or none that collides."""
    size = f"{ROWS * PITCH / 2} {COLS * PITCH / 2} {PAD}"
    if kind == "boxes":
        box = f'size="{PITCH / 2} {PITCH / 2} {PAD}"'
        # A body per taxel: a touch sensor adds up the contacts of its body, and points on the border of two taxels would count twice.
        parts = "".join(
            f'<body pos="{x:.9g} {y:.9g} {-PAD}"><geom type="box" {box}/><site name="t{i}" type="box" size=".003 .003 {2 * PAD}"/></body>'
            for i, (x, y) in enumerate(centers())
        )
        return parts, "".join(f'<touch site="t{i}"/>' for i in range(len(centers()))), ""
    bits = 'contype="0" conaffinity="0"' if kind == "none" else ""
    pad = f'<geom type="box" size="{size}" pos="0 0 {-PAD}" {bits}/><site name="skin" size=".03 .04 .01" type="box"/>'
    if kind != "tactile":
        return pad, "", ""
    vertices = " ".join(f"{x:.9g} {y:.9g} 0" for x, y in centers())
    corners = [(i * COLS + j, (i + 1) * COLS + j) for i in range(ROWS - 1) for j in range(COLS - 1)]
    faces = " ".join(f"{a} {b} {a + 1} {b} {b + 1} {a + 1}" for a, b in corners)
    asset = f'<mesh name="skin" vertex="{vertices}" face="{faces}" inertia="shell"/>'
    return (
        pad + '<geom name="skin" type="mesh" mesh="skin" contype="0" conaffinity="0"/>',
        '<tactile mesh="skin" geom="skin"/>',
        asset,
    )


def model_of(case: Case, kind: str) -> mujoco.MjModel:
    """An object above a pad."""
    pad, sensors, asset = pad_text(kind)
    if case.mesh:
        asset += f'<mesh name="object" vertex="{case.mesh}"/>'
    field = f'<geom {case.geom.replace("mesh", "sdf", 1)} contype="0" conaffinity="0"/>' if case.mesh and kind == "tactile" else ""
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
      <option timestep="0.001" gravity="0 0 {-GRAVITY}"/>
      <asset>{asset}</asset>
      <worldbody>
        <body name="pad">{pad}</body>
        <body name="object" {case.body}><freejoint/><inertial {case.inertial} diaginertia="2e-5 2e-5 2e-5"/>
          <geom name="object" {case.geom}/>{field}</body>
      </worldbody>
      <sensor>{sensors}</sensor></mujoco>""")


def moments(points: Vector, forces: Vector) -> Moments:
    """Sum, centre and principal angle (rad) of forces at points (C, 2); an angle of NaN if they are not clearly long."""
    center = forces @ points / forces.sum()
    (xx, xy), (_, yy) = ((points - center).T * forces) @ (points - center)
    half, spread = (xx + yy) / 2, float(np.hypot((xx - yy) / 2, xy))
    is_long = half + spread > CLEARLY_LONG * (half - spread) and spread > 0
    return float(forces.sum()), center, 0.5 * float(np.arctan2(2 * xy, xx - yy)) if is_long else np.nan


def of_contacts(model: mujoco.MjModel) -> Moments:
    """Of MuJoCo's contact forces at rest."""
    data = at_rest(model)
    forces = []
    for k in range(data.ncon):
        force = np.zeros(6)
        mujoco.mj_contactForce(model, data, k, force)
        forces.append(force[0])
    return moments(data.contact.pos[:, :2], np.array(forces))


def at_rest(model: mujoco.MjModel) -> mujoco.MjData:
    """MuJoCo's state after 3 s."""
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 3000)
    mujoco.mj_forward(model, data)
    return data


def of_tactile(model: mujoco.MjModel, qpos: Vector, stiffness: float) -> Moments:
    """Of the depths of MuJoCo's tactile sensor at a pose of the object, as forces."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    depths = np.maximum(data.sensordata[: ROWS * COLS], 0)
    return moments(centers(), depths * stiffness * PITCH**2)


def of_features(features: taxelsim.Features) -> Moments:
    """Of the first instance of a frame."""
    large, small = features.eigenvalues[0]
    angle = float(features.edge_angle[0]) if large > CLEARLY_LONG * small else np.nan
    return float(features.total_force[0]), features.center_of_pressure[0, :2].astype(np.float64), angle


def of_data_set(data: Dataset, group: str) -> Moments:
    """Of the first frame of a data set. group: of its features."""
    large, small = data[f"data/{group}eigenvalues"][0]
    angle = float(data[f"data/{group}edge_angle"][0]) if large > CLEARLY_LONG * small else np.nan
    return float(data[f"data/{group}total_force"][0]), data[f"data/{group}center_of_pressure"][0, :2].astype(np.float64), angle


def rows_of(case: Case) -> dict[str, Moments]:
    """Forces by simulator."""
    sensor = case.scene.sensor
    stiffness = sensor.skin.law.normal_contact_stiffness  # type: ignore[union-attr]
    model = model_of(case, "none")
    data = mujoco.MjData(model)
    frame = taxelsim.mujoco.couple(model, {"skin": sensor}, ["object"]).step(data, 1500)["skin"]
    return {
        "MuJoCo, contacts": of_contacts(model_of(case, "one box")),
        "MuJoCo, 84 boxes with touch sensors": moments(centers(), at_rest(model_of(case, "boxes")).sensordata),
        "MuJoCo, tactile, depth x stiffness": of_tactile(model_of(case, "tactile"), data.qpos, stiffness),
        "taxelsim, true": of_features(frame.ground_truth),
        "taxelsim, measured": of_features(frame),
        "taxelsim, scene alone, true": of_data_set(case.data, "ground_truth/"),
        "taxelsim, scene alone, measured": of_data_set(case.data, ""),
    }


def main() -> None:
    """Prints the table."""
    print("| object | simulator | sum, N (m g) | centre, mm | angle, degrees |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, (scene, start, mass_center) in CASES.items():
            case = case_of(scene, start, mass_center, Path(folder))
            weight = case.scene.randomization["load"][0]
            for simulator, (total, center, angle) in rows_of(case).items():
                x, y = 1e3 * center
                turned = "-" if np.isnan(angle) else f"{np.rad2deg(angle) % 180:.1f}"
                print(f"| {name} ({weight:.3f}) | {simulator} | {total:.3f} | {x:.2f}, {y:.2f} | {turned} |", flush=True)


if __name__ == "__main__":
    main()
