#!/usr/bin/env python3
"""taxelsim.Simulator compared with mujoco.batch.Batch and its tactile sensor: frames/s and peak memory.

    build/venv/bin/pip install mujoco
    PYTHONPATH=build/bench/python build/venv/bin/python bench/python/mujoco_tactile.py --json bench/results/mujoco_tactile-lavapipe.json

Same array, object, poses and number of environments. Every measurement runs in a process of its own, in turns, and is verified first: depth
in all environments under contact and none without; the same taxels and centre of pressure as taxelsim with as many points per taxel.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from report import ROOT, lowest_height, machine, ratio, summary, write_json

import taxelsim

sys.path.insert(0, str(ROOT / "scripts"))
from make_objects import icosphere

SENSOR = ROOT / "bench/sensors/wts0614.yaml"
RADIUS, LENGTH = 0.008, 0.04  # m, of the cylinder
SPHERE_RADIUS, SUBDIVISIONS = 0.01, 4  # m; 5,120 triangles
NUM_POSES = 256
DEPTHS, OFFSETS = (0.0003, 0.0015), (0.0034, 0.0068)  # m
TILT = np.deg2rad(1)
LEAST_OVERLAP = 0.9  # of the taxels deeper than a tenth of the deepest
# Name: peer, points per taxel and side, what it computes.
PEERS = {
    "taxelsim": ("taxelsim", 4, "frame, 4 x 4 samples per taxel"),
    "taxelsim_1": ("taxelsim", 1, "frame, 1 sample per taxel"),
    "mujoco_forward": ("mujoco_forward", 1, "depth, 1 point per taxel"),
    "mujoco_step": ("mujoco_step", 1, "time step and depth, 1 point per taxel"),
    "mujoco_forward_samples": ("mujoco_forward", 4, "depth, 4 x 4 points per taxel"),
}
REFERENCES = {1: "taxelsim_1", 4: "taxelsim"}


def sphere_text() -> str:
    """OBJ text of a sphere from a subdivided icosahedron."""
    vertices, triangles = icosphere(SUBDIVISIONS)
    points = SPHERE_RADIUS * np.array(vertices)
    return "".join([*(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points), *(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles)])


def product(p: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Product of two quaternions (w, x, y, z)."""
    scalar = p[0] * q[0] - p[1:] @ q[1:]
    return np.concatenate([[scalar], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])])


def poses_of(shape: Any, rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """(NUM_POSES, 7): any yaw, a small tilt, over the middle of the array, pressed into the skin."""
    random = np.random.default_rng(1)
    poses = np.zeros((NUM_POSES, 7))
    for pose in poses:
        direction = random.uniform(-np.pi, np.pi)
        tilt = taxelsim.axis_angle((np.cos(direction), np.sin(direction), 0), random.uniform(0, TILT))
        yaw = taxelsim.axis_angle((0, 0, 1), random.uniform(-np.pi, np.pi))
        upright = product(np.asarray(yaw), rest)
        pose[3:] = product(np.asarray(tilt), upright)
        pose[:2] = random.uniform(-1, 1, 2) * OFFSETS
        # Without the tilt: the lowest point of a tilted cylinder is beyond the array.
        pose[2] = -lowest_height(shape, upright) - random.uniform(*DEPTHS)
    return poses


def compare(images: NDArray[np.float64], reference: NDArray[np.float64], pitch: float) -> dict[str, float]:
    """Agreement of depths (K, rows, columns) with those of taxelsim."""
    deep = reference > 0.1 * reference.max(axis=(1, 2), keepdims=True)
    grid = np.indices(images.shape[1:])

    def centers(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.einsum("kij,aij->ka", values, grid) / values.sum(axis=(1, 2))[:, np.newaxis])

    offsets = np.linalg.norm(centers(images) - centers(reference), axis=1) * pitch
    return {"overlap": float((images[deep] > 0).mean()), "largest_center_difference_m": float(offsets.max())}


def measure(job: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Runs tactile_peer.py. Exits with its message if it fails."""
    file = folder / "job.json"
    file.write_text(json.dumps(job))
    result = subprocess.run([sys.executable, Path(__file__).parent / "tactile_peer.py", file], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"mujoco_tactile.py: {job['peer']}: {result.stderr.strip() or f'exit status {result.returncode}'}")
    values: dict[str, Any] = json.loads(result.stdout)
    return values


def run_case(options: argparse.Namespace, folder: Path, case: str) -> dict[str, Any]:
    """All peers on one object."""
    patch = taxelsim.load_sensor(SENSOR).patches[0]
    pitch = patch.pitch[0]
    if case == "cylinder":
        description: dict[str, Any] = {"radius": RADIUS, "length": LENGTH}
        shape = taxelsim.parse_object(f"cylinder:{RADIUS},{LENGTH}")
        rest = np.asarray(taxelsim.axis_angle((1, 0, 0), np.pi / 2))
    else:
        file = folder / "sphere.obj"
        file.write_text(sphere_text())
        description, shape, rest = {"file": str(file)}, taxelsim.parse_object(str(file)), np.array([1.0, 0, 0, 0])
    np.save(folder / "poses.npy", poses_of(shape, rest))
    measured: dict[str, list[dict[str, Any]]] = {name: [] for name in PEERS}
    images: dict[str, NDArray[np.float64]] = {}
    results: dict[str, Any] = {}
    for _ in range(options.turns):
        for name, (peer, points, _) in PEERS.items():
            job = {
                "peer": peer,
                "points": points,
                "num_envs": options.envs,
                "seconds": options.seconds,
                "object": description,
                "sensor": str(folder / f"sensor{points}.yaml"),
                "grid": (patch.num_rows, patch.num_cols, pitch),
                "poses": str(folder / "poses.npy"),
                "images": str(folder / f"{name}.npy"),
            }
            measured[name].append(measure(job, folder))
            if name not in images:
                images[name] = np.load(job["images"])
                agreement = compare(images[name], images[REFERENCES[points]], pitch)
                if agreement["overlap"] < LEAST_OVERLAP or agreement["largest_center_difference_m"] > pitch:
                    sys.exit(f"mujoco_tactile.py: {case}, {name}: other contacts than {REFERENCES[points]}: {agreement}")
                results[name] = agreement
    rates = {name: [value["frames_per_second"] for value in values] for name, values in measured.items()}
    for name, (_, _, outputs) in PEERS.items():
        results[name] |= {
            "what": measured[name][0]["what"],
            "outputs": outputs,
            "frames_per_second": summary(rates[name]),
            "taxelsim_over_this": ratio(rates["taxelsim"], rates[name]),
            "peak_memory_bytes": summary([value["peak_memory_bytes"] for value in measured[name]]),
            "interpreter_memory_bytes": measured[name][0]["interpreter_memory_bytes"],
        }
        rate, memory = results[name]["frames_per_second"]["median"], results[name]["peak_memory_bytes"]["median"] / 1e6
        over = results[name]["taxelsim_over_this"]
        print(f"{case:10}{name:24}{outputs:42}{rate:12,.0f} frames/s{over:8.2f}{memory:8,.0f} MB", flush=True)
    return results


def main() -> None:
    """Runs all cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", default="cylinder,sphere", help="list, separated by commas; sphere: a mesh of 5,120 triangles")
    parser.add_argument("--envs", type=int, default=4096, help="environments")
    parser.add_argument("--seconds", type=float, default=1, help="least time of a measurement")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--json", type=Path, help="file of results to write")
    options = parser.parse_args()
    cases = options.cases.split(",")
    if not set(cases) <= {"cylinder", "sphere"}:
        parser.error(f"--cases: {options.cases} is not allowed: cylinder, sphere")
    results: dict[str, Any] = {**machine(taxelsim.Device.open()), "num_envs": options.envs, "num_poses": NUM_POSES}
    print(f"{results['device']}, {results['driver']}; {options.envs} environments; last columns: taxelsim over this, peak memory")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = SENSOR.read_text()
        for points in REFERENCES:
            (folder / f"sensor{points}.yaml").write_text(text.replace("samples_per_taxel: 4", f"samples_per_taxel: {points}"))
        for case in cases:
            results[case] = run_case(options, folder, case)
            write_json(options.json, results)


if __name__ == "__main__":
    main()
