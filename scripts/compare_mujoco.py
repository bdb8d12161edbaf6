#!/usr/bin/env python3
"""Compares the depths of MuJoCo's `tactile` sensor with those of taxelsim, for the same taxels and poses. Needs `pip install mujoco numpy` (tried with 4.0.0).

Usage: scripts/compare_mujoco.py [path of taxelsim]

MuJoCo computes the depth of every vertex of a sensor's mesh inside the touching body as the distance to the nearest surface, from the body's signed
distance field. taxelsim computes it along the taxel's normal. On a flat face the two are the same; on a flank that rises at angle t the nearest surface is
closer, by cos t to first order, and near a rim it may be a side wall.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROWS, COLS, PITCH = 6, 14, 0.0034

# One sample a taxel, at its centre, as MuJoCo has one vertex.
SENSOR = f"""format_version: 1
name: centres
num_rows: {ROWS}
num_cols: {COLS}
pitch: {PITCH}
samples_per_taxel: 1
skin: {{thickness_mm: 4, normal_contact_stiffness: 1e6}}
readout: {{curve: {{counts_per_newton: 100}}}}
"""

SQRT = math.sqrt(0.5)
# (name, taxelsim's word, MuJoCo's geom, pose x y z qw qx qy qz)
CASES = [
    ("ball, 0.5 mm deep", "sphere:0.01", 'type="sphere" size="0.01"', (0.001, 0.002, 0.0095, 1, 0, 0, 0)),
    ("ball, 2 mm deep", "sphere:0.01", 'type="sphere" size="0.01"', (0, 0.01, 0.008, 1, 0, 0, 0)),
    ("cylinder lying along y", "cylinder:0.008,0.03", 'type="cylinder" size="0.008 0.015"', (0, 0, 0.0072, SQRT, SQRT, 0, 0)),
    ("cylinder standing", "cylinder:0.006,0.02", 'type="cylinder" size="0.006 0.01"', (0, 0, 0.0092, 1, 0, 0, 0)),
    ("box lying flat", "box:0.012,0.03,0.02", 'type="box" size="0.006 0.015 0.01"', (0, 0, 0.0092, 1, 0, 0, 0)),
    ("box on an edge", "box:0.012,0.03,0.012", 'type="box" size="0.006 0.015 0.006"', (0.0017, 0, 0.0075, math.cos(math.pi / 8), 0, math.sin(math.pi / 8), 0)),
    ("capsule lying along y", "capsule:0.005,0.02", 'type="capsule" size="0.005 0.01"', (0.0017, 0, 0.0042, SQRT, SQRT, 0, 0)),
]


def taxel_centres():
    return [((i - (ROWS - 1) / 2) * PITCH, (j - (COLS - 1) / 2) * PITCH, 0.0) for i in range(ROWS) for j in range(COLS)]


def model_xml(geom, pose, quat, size):
    vertices = " ".join(f"{x} {y} {z}" for x, y, z in taxel_centres())
    faces = []
    for i in range(ROWS - 1):
        for j in range(COLS - 1):
            a = i * COLS + j
            faces += [(a, a + 1, a + COLS), (a + 1, a + COLS + 1, a + COLS)]
    faces = " ".join(f"{a} {b} {c}" for a, b, c in faces)
    position, rotation = " ".join(map(str, pose[:3])), " ".join(map(str, pose[3:]))
    return f"""<mujoco>
<asset><mesh name="skin" vertex="{vertices}" face="{faces}" inertia="shell"/></asset>
<worldbody>
 <body name="pad"><geom name="pad" type="box" size="{size}" quat="{quat}"/></body>
 <body name="object" pos="{position}" quat="{rotation}"><freejoint/><geom {geom} mass="0.1"/></body>
</worldbody>
<sensor><tactile name="taxels" mesh="skin" geom="pad"/></sensor>
</mujoco>"""


def mujoco_depths(geom, pose):
    # MuJoCo turns a mesh into the frame of its inertia; the pad is turned alike, so that the vertices come to lie where they were given.
    turned = mujoco.MjModel.from_xml_string(model_xml(geom, pose, "1 0 0 0", "0.02 0.03 0.001"))
    quat = turned.mesh_quat[0]
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, quat)
    size = np.abs(rotation.reshape(3, 3).T) @ np.array([0.02, 0.03, 0.001])
    model = mujoco.MjModel.from_xml_string(model_xml(geom, pose, " ".join(map(str, quat)), " ".join(map(str, size))))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return np.array(data.sensordata[: ROWS * COLS])


def taxelsim_depths(program, sensor, spec, pose):
    command = [program, "frame", "--sensor", sensor, "--object", spec, "--pose", " ".join(map(str, pose)), "--json"]
    frame = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return np.array(frame["ground_truth"]["penetration_depth"]).ravel()


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/release/bin/taxelsim")
    print(f"MuJoCo {mujoco.__version__}; {ROWS} x {COLS} taxels, {PITCH * 1e3} mm, one sample each; depths in um\n")
    print("| contact | taxels under contact, taxelsim | MuJoCo | deepest, taxelsim | MuJoCo | largest difference | sums, MuJoCo / taxelsim |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as directory:
        sensor = pathlib.Path(directory) / "sensor.yaml"
        sensor.write_text(SENSOR)
        for name, spec, geom, pose in CASES:
            ours = taxelsim_depths(program, str(sensor), spec, pose) * 1e6
            theirs = mujoco_depths(geom, pose) * 1e6
            print(f"| {name} | {np.sum(ours > 0.01)} | {np.sum(theirs > 0.01)} | {ours.max():.1f} | {theirs.max():.1f} | "
                  f"{np.abs(ours - theirs).max():.1f} | {theirs.sum() / ours.sum():.3f} |")


if __name__ == "__main__":
    main()
