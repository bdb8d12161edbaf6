#!/usr/bin/env python3
"""taxelsim.Simulator compared with the tactile sensors of Genesis World on the CPU: frames/s of the tactile part, without physics.

    python3 -m venv build/venv-genesis && build/venv-genesis/bin/pip install torch genesis-world nanobind-backend
    PYTHONPATH=build/release/python build/venv-genesis/bin/python bench/python/genesis_peer.py --json genesis_peer.json

Same array, object, poses and numbers of environments; all peers in turns in one process. Before timing, depths of Genesis are compared
with the closed form of the distance, and its taxels in contact with those of taxelsim at as many points.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from mujoco_tactile import LENGTH, NUM_POSES, RADIUS, SENSOR, SPHERE_RADIUS, poses_of, sphere_text
from numpy.typing import NDArray
from report import machine, ratio, summary, write_json
from tactile_peer import PAD_HEIGHT, STEP, peak_memory

import taxelsim

Array = NDArray[np.float64]

CASES = ("cylinder", "sphere")
THICKNESS = 0.002  # m, of the skin
PROBE_RADIUS = 1e-6  # m


@dataclass(frozen=True)
class Kind:
    """A peer. The depth of Genesis is the radius of a probe minus the signed distance from its middle to the object."""

    what: str
    points: int = 1  #: per taxel and side
    sensor: str = ""  #: of Genesis; none: taxelsim
    query: str = "sdf"
    most_envs: int = 4096
    radius: float = PROBE_RADIUS  #: m; the sphere of a probe touches the surface of the skin from below


PEERS = {
    "taxelsim": Kind("frame, 4 x 4 samples per taxel", 4),
    "taxelsim_1": Kind("frame, 1 sample per taxel"),
    "genesis_taxel": Kind("force and torque, 1 probe per taxel", 1, "KinematicTaxel"),
    "genesis_depth": Kind("depth, 1 probe per taxel", 1, "ContactDepthProbe"),
    "genesis_taxel_samples": Kind("force and torque, 4 x 4 probes per taxel", 4, "KinematicTaxel"),
    # Finds no triangles beyond the radius, so that it must be larger than the deepest contact.
    "genesis_raycast": Kind("force and torque, 1 probe per taxel, triangles", 1, "KinematicTaxel", "raycast", 1024, THICKNESS),
}
SHORT_STEP = 1e-5  # s; Genesis pushes objects out with at most depth / (10 ms)^2, so that they move by about 1.5e-9 m
# Genesis takes distances by trilinear interpolation from a grid of 31 cells over 1.2 times the largest extent, in each direction. Its
# cylinder has 32 flat strips: r (1 - cos(pi / 32)) = 39 um too flat; the interpolation adds h^2 / (8 r) = 7 um for cells of h = 0.62 mm
# (0.77 mm in two directions for the sphere: 15 um, and 8 um of its triangles).
DEPTH_TOLERANCE = 5e-5  # m
# The ends of the cylinder are nearer than its side for points closer to them than the contact is deep (1.5 mm). The grid blurs this edge
# by a cell, 1.2 x 40 mm / 31 = 1.55 mm. Taxels there are not compared.
END_MARGIN = 3.1e-3  # m


@dataclass(frozen=True)
class Case:
    """An object, its poses and the arrays that it presses on."""

    name: str
    file: Path  #: mesh of the sphere
    sensors: dict[int, Path]  #: by samples per taxel and side
    poses: Array  #: (K, 7) in the sensor frame

    def description(self) -> str:
        """The object, for taxelsim.parse_object()."""
        return f"cylinder:{RADIUS},{LENGTH}" if self.name == "cylinder" else str(self.file)

    def distances(self, points: Array) -> tuple[Array, NDArray[np.bool_]]:
        """(K, P): depth of points (P, 3) of the sensor frame inside the object (m), < 0 outside, and whether Genesis' grid resolves it."""
        w, x, y, z = self.poses[:, 3:].T
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        local = np.einsum("abk,kpa->kpb", np.array(rows), points - self.poses[:, np.newaxis, :3])
        if self.name == "sphere":
            depths = SPHERE_RADIUS - np.linalg.norm(local, axis=2)
            return np.asarray(depths), np.full(depths.shape, True)
        from_ends = LENGTH / 2 - np.abs(local[..., 2])
        return np.minimum(RADIUS - np.hypot(local[..., 0], local[..., 1]), from_ends), np.abs(from_ends) > END_MARGIN


class TaxelsimPeer:
    """The frame: depths, forces, point spread, counts, features."""

    def __init__(self, case: Case, points: int, num_envs: int) -> None:
        model = taxelsim.Model(
            taxelsim.Device.open(), taxelsim.load_sensor(case.sensors[points]), [taxelsim.parse_object(case.description())]
        )
        self.simulator = taxelsim.Simulator(model, num_envs)
        self.simulator.prepare()
        self.poses = np.empty((num_envs, 7))

    def move(self, poses: Array) -> None:
        self.poses = poses

    def compute(self) -> None:
        """Includes the transfer of the poses."""
        self.simulator.set_objects(0, self.poses)
        self.simulator.step(STEP)
        self.simulator.read()

    def depths(self) -> Array:
        """(num_envs, taxels), m."""
        depths = self.simulator.read().ground_truth.penetration_depth
        return np.asarray(depths, np.float64).reshape(len(depths), -1)

    def forces(self) -> Array:
        """(num_envs): sum of the normal forces before the point spread, N."""
        return np.asarray(-self.simulator.read().ground_truth.contact_wrench[:, 2], np.float64)


def sample_points(num_rows: int, num_cols: int, pitch: float, points: int) -> Array:
    """(P, 3): middles of the samples in the sensor frame, m; taxel by taxel, `points`^2 of each."""
    offsets = (np.arange(points) - (points - 1) / 2) * pitch / points
    x = (np.arange(num_rows) - (num_rows - 1) / 2)[:, np.newaxis] * pitch + offsets
    y = (np.arange(num_cols) - (num_cols - 1) / 2)[:, np.newaxis] * pitch + offsets
    grid = np.zeros((num_rows, num_cols, points, points, 3))
    grid[..., 0], grid[..., 1] = x[:, np.newaxis, :, np.newaxis], y[np.newaxis, :, np.newaxis, :]
    return grid.reshape(-1, 3)


class GenesisPeer:
    """Probes at the middles of the samples, on a fixed box; the object is a free body.

    Sensors query the objects that touch the box, so that collisions must have been detected at the poses. move() does this by a time step,
    so short that the object keeps its pose. compute() updates the sensors again, by the call that a time step makes: no physics in it.
    """

    def __init__(self, case: Case, kind: Kind, num_envs: int) -> None:
        import genesis as gs

        array = taxelsim.load_sensor(SENSOR)
        patch = array.patches[0]
        pitch = patch.pitch[0]
        self.points = sample_points(patch.num_rows, patch.num_cols, pitch, kind.points) - np.array([0, 0, kind.radius])
        assert isinstance(array.skin.law, taxelsim.Winkler)
        self.stiffness = array.skin.law.normal_contact_stiffness * (pitch / kind.points) ** 2  # N/m
        self.scene = gs.Scene(sim_options=gs.options.SimOptions(dt=SHORT_STEP, gravity=(0, 0, 0)), show_viewer=False)
        size = (patch.num_rows * pitch, patch.num_cols * pitch, PAD_HEIGHT)
        pad = self.scene.add_entity(gs.morphs.Box(size=size, pos=(0, 0, -PAD_HEIGHT / 2), fixed=True))
        if case.name == "cylinder":
            shape = gs.morphs.Cylinder(radius=RADIUS, height=LENGTH)
        else:
            shape = gs.morphs.Mesh(file=str(case.file), decimate=False, file_meshes_are_zup=True)
        self.object = self.scene.add_entity(shape)
        places = self.points + np.array([0, 0, PAD_HEIGHT / 2])  # in the frame of the box
        options: dict[str, Any] = {"entity_idx": pad.idx, "probe_local_pos": places, "probe_radius": kind.radius}
        if kind.sensor == "KinematicTaxel":
            options |= {"normal_stiffness": self.stiffness, "normal_damping": 0.0, "shear_scalar": 0.0, "twist_scalar": 0.0}
        self.sensor = self.scene.add_sensor(getattr(gs.sensors, kind.sensor)(contact_depth_query=kind.query, **options))
        self.scene.build(n_envs=num_envs)
        self.data: Any = None
        self.seconds_in_steps = 0.0  # of the update of the sensors in all time steps, by the timer of Genesis

    def move(self, poses: Array) -> None:
        self.object.set_pos(poses[:, :3])
        self.object.set_quat(poses[:, 3:])
        self.scene.step()
        self.seconds_in_steps += self.scene.sim.step_timer.timings["sensors"]

    def compute(self) -> None:
        """Without the transfer of the poses."""
        self.scene.sim._sensor_manager.step()
        self.data = self.sensor.read()

    def depths(self) -> Array:
        """(num_envs, probes), m."""
        if hasattr(self.data, "force"):
            return np.asarray(np.linalg.norm(self.data.force.numpy().astype(np.float64), axis=-1) / self.stiffness)
        return np.asarray(self.data.numpy(), np.float64)

    def forces(self) -> Array:
        """(num_envs): sum of the forces along -z, N."""
        return np.asarray(-self.data.force.numpy()[..., 2].astype(np.float64).sum(axis=1))


def names(allowed: Iterable[str]) -> Callable[[str], list[str]]:
    """Type of an option: a list of these names, separated by commas."""

    def parse(text: str) -> list[str]:
        words = text.split(",")
        if not set(words) <= set(allowed):
            raise argparse.ArgumentTypeError(f"{text} is not allowed: {', '.join(allowed)}")
        return words

    return parse


def make_peer(case: Case, name: str, num_envs: int) -> Any:
    """TaxelsimPeer or GenesisPeer."""
    kind = PEERS[name]
    return GenesisPeer(case, kind, num_envs) if kind.sensor else TaxelsimPeer(case, kind.points, num_envs)


def compare(name: str, peer: GenesisPeer, case: Case, depths: dict[str, Array], forces: dict[str, Array]) -> dict[str, float]:
    """Differences of a peer of Genesis from the closed form of its depth, and from taxelsim at as many points where both mean the same."""
    kind, found = PEERS[name], depths[name]
    all_expected, all_resolved = case.distances(peer.points)
    rows = np.arange(len(found)) % len(case.poses)
    expected, resolved = all_expected[rows] + kind.radius, all_resolved[rows]
    errors = np.where(resolved, np.abs(found - np.maximum(expected, 0)), 0)
    certain = resolved & (np.abs(expected) > DEPTH_TOLERANCE)
    result = {
        "largest_depth_error_m": float(errors.max()),
        "contacts": int((found > 0).sum()),
        "contacts_compared": int(((found > 0) & certain).sum()),
        "wrong_contacts": int((((found > 0) != (expected > 0)) & certain).sum()),
    }
    reference = "taxelsim" if kind.points == 4 else "taxelsim_1"
    if name in forces:
        result["force_over_taxelsim"] = float(np.median(forces[name] / forces[reference]))
    if kind.points == 1 and kind.radius == PROBE_RADIUS:  # a sphere around the probe touches more than the surface over it
        ours = depths[reference]
        deep = ours > 0.5 * ours.max(axis=1, keepdims=True)
        result["depth_over_taxelsim"] = float(np.median(found[deep] / ours[deep]))
        result["wrong_contacts"] += int((((found > 0) != (ours > 0)) & certain).sum())
    return result


def verify(case: Case, peers: dict[str, Any], num_envs: int) -> dict[str, dict[str, float]]:
    """Compares all peers. Exits if contacts differ, or depths of Genesis from their closed form."""
    depths: dict[str, Array] = {}
    forces: dict[str, Array] = {}
    for name, peer in peers.items():
        for shift in (1, 0):  # the outputs must be those of the last poses
            peer.move(case.poses[(np.arange(num_envs) + shift) % len(case.poses)])
            peer.compute()
        depths[name] = peer.depths()
        if PEERS[name].sensor != "ContactDepthProbe":
            forces[name] = peer.forces()
    results = {name: compare(name, peer, case, depths, forces) for name, peer in peers.items() if PEERS[name].sensor}
    for name, result in results.items():
        if result["largest_depth_error_m"] > DEPTH_TOLERANCE or result["wrong_contacts"]:
            sys.exit(f"genesis_peer.py: {case.name}, {num_envs} environments, {name}: other depths or contacts: {result}")
    return results


def time_peer(peer: Any, case: Case, num_envs: int, seconds: float) -> tuple[float, ...]:
    """Frames per second of wall clock and of processor time of compute(), with new poses in every frame.

    For Genesis also that of wall clock of the same update within the time steps, as a check of the method.
    """
    peer.seconds_in_steps = 0.0
    rows, wall, processor, num_steps = np.arange(num_envs), 0.0, 0.0, 0
    while wall < seconds:
        peer.move(case.poses[(rows + num_steps) % len(case.poses)])
        wall_start, processor_start = time.perf_counter(), time.process_time()
        peer.compute()
        wall += time.perf_counter() - wall_start
        processor += time.process_time() - processor_start
        num_steps += 1
    times = [wall, processor] + ([peer.seconds_in_steps] if peer.seconds_in_steps else [])
    return tuple(num_envs * num_steps / value for value in times)


def run_batch(options: argparse.Namespace, case: Case, num_envs: int) -> dict[str, Any]:
    """All peers on one object with one number of environments, in turns."""
    peers = {name: make_peer(case, name, num_envs) for name in options.peers if num_envs <= PEERS[name].most_envs}
    results: dict[str, Any] = {name: {"what": PEERS[name].what} for name in peers}
    for name, agreement in verify(case, peers, num_envs).items():
        results[name] |= agreement
    rates: dict[str, list[tuple[float, ...]]] = {name: [] for name in peers}
    for _ in range(options.turns):
        for name, peer in peers.items():
            rates[name].append(time_peer(peer, case, num_envs, options.seconds))
    for name in peers:
        line = f"{case.name:10}{num_envs:6}  {name:24}"
        for column, unit in enumerate(("second", "processor_second")):
            values = [turn[column] for turn in rates[name]]
            over = ratio([turn[column] for turn in rates["taxelsim"]], values)
            results[name] |= {f"frames_per_{unit}": summary(values), f"taxelsim_over_this_by_{unit}": over}
            line += f"{results[name][f'frames_per_{unit}']['median']:12,.0f}{over:9.2f}"
        if len(rates[name][0]) > 2:
            results[name]["frames_per_second_in_time_steps"] = summary([turn[2] for turn in rates[name]])
        print(line, flush=True)
    return results


def make_case(name: str, folder: Path) -> Case:
    """Writes the files of a case into `folder`."""
    file = folder / "sphere.obj"
    file.write_text(sphere_text())
    sensors = {points: folder / f"sensor{points}.yaml" for points in (1, 4)}
    for points, sensor in sensors.items():
        sensor.write_text(SENSOR.read_text().replace("samples_per_taxel: 4", f"samples_per_taxel: {points}"))
    lying = np.asarray(taxelsim.axis_angle((1, 0, 0), np.pi / 2))
    case = Case(name, file, sensors, np.empty((0, 7)))
    return replace(
        case, poses=poses_of(taxelsim.parse_object(case.description()), lying if name == "cylinder" else np.array([1.0, 0, 0, 0]))
    )


def memory_of(case: str, name: str, num_envs: int) -> int:
    """Largest resident set of a process that computes frames with one peer, bytes."""
    command = [sys.executable, __file__, "--peak-memory", "--cases", case, "--peers", name, "--envs", str(num_envs)]
    return int(subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[-1])


def start_genesis() -> dict[str, str]:
    """Starts Genesis on the CPU; versions and settings for the results."""
    # Threads of PyTorch that wait actively take the processor from the kernels of Genesis: on two cores it is 3 to 5 times slower then.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    import genesis as gs

    gs.init(backend=gs.cpu, logging_level="error")
    versions = {name: importlib.metadata.version(name) for name in ("genesis-world", "quadrants", "torch")}
    return {**versions, "OMP_WAIT_POLICY": os.environ["OMP_WAIT_POLICY"]}


def main() -> None:
    """Runs all cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--cases", type=names(CASES), default=list(CASES), help="list, separated by commas; sphere: a mesh of 5,120 triangles"
    )
    parser.add_argument("--peers", type=names(PEERS), default=list(PEERS), help="list, separated by commas")
    parser.add_argument(
        "--envs", type=lambda text: [int(word) for word in text.split(",")], default=[1, 64, 1024, 4096], help="environments: a list"
    )
    parser.add_argument("--seconds", type=float, default=0.5, help="least time of a measurement")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument(
        "--peak-memory",
        action="store_true",
        help="only print the largest resident set with the first case, peer and number of environments, bytes",
    )
    parser.add_argument("--json", type=Path, help="file of results to write")
    options = parser.parse_args()
    if not options.peak_memory and not {"taxelsim", "taxelsim_1"} <= set(options.peers):
        parser.error("--peers: taxelsim and taxelsim_1 must be among them")
    versions = start_genesis() if any(PEERS[name].sensor for name in options.peers) else {}
    with tempfile.TemporaryDirectory() as name:
        cases = [make_case(case, Path(name)) for case in options.cases]
        if options.peak_memory:
            peer = make_peer(cases[0], options.peers[0], options.envs[0])
            time_peer(peer, cases[0], options.envs[0], 0.1)
            print(peak_memory())
            return
        results: dict[str, Any] = {
            **machine(taxelsim.Device.open()),
            **versions,
            "num_poses": NUM_POSES,
            "load_average": [os.getloadavg()[0]],
        }
        print(f"{results['device']}, {results['driver']}; {versions}; frames/s and taxelsim over this, by wall clock and by processor time")
        for case in cases:
            results[case.name] = {}
            for num_envs in options.envs:
                results[case.name][num_envs] = run_batch(options, case, num_envs)
                results["load_average"].append(os.getloadavg()[0])
                write_json(options.json, results)
        largest = max(options.envs)
        results["peak_memory_bytes"] = {
            name: memory_of(options.cases[0], name, largest) for name in options.peers if largest <= PEERS[name].most_envs
        }
        print(json.dumps(results["peak_memory_bytes"]))
        write_json(options.json, results)


if __name__ == "__main__":
    main()
