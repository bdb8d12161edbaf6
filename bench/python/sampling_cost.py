#!/usr/bin/env python3
"""Processor time of a frame with point and with area sampling, and of a frame under a load; ratios.

    PYTHONPATH=build/release/python build/venv/bin/python bench/python/sampling_cost.py

Objects of the benchmark on the sensor wts0614_soft_cover, --instances at random places. Each is pressed by --load, and for comparison posed
where the load was found; or posed --depth deep, or well above the skin. A load has two times: of objects that slide by 10 um a step, and of a first
frame after a reset. With --more also meshes on a foil of 16 x 16 taxels and a
sphere on a curved fingertip. Medians of --repeats steps, in turns; on a software driver, whose threads belong to the process.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from report import ROOT, lowest_height, machine, write_json

import taxelsim

SENSORS = ROOT / "scenes/sensors"
KNOB = ROOT / "scenes/objects/knob_5k.obj"
LYING = tuple(taxelsim.axis_angle((1, 0, 0), np.pi / 2))
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
SAMPLINGS = {"point": taxelsim.DepthSampling.POINT, "area": taxelsim.DepthSampling.AREA}
CARRIED = 2e-6  # share of the load


def objects() -> dict[str, tuple[object, tuple[float, ...]]]:
    """Shapes with their orientations."""
    return {
        "cylinder, lying": (taxelsim.Cylinder(radius=0.008, length=0.04), LYING),
        "sphere": (taxelsim.Sphere(radius=0.008), UPRIGHT),
        "box": (taxelsim.Box(size=[0.0105, 0.0105, 0.01]), UPRIGHT),
        "5,120 triangles": (taxelsim.parse_object(str(KNOB)), LYING),
    }


def bumpy_spheres() -> list[object]:
    """Meshes of 1,000 to 20,000 triangles."""
    meshes = []
    for rows in (16, 25, 36, 42, 50, 58, 65, 72):
        columns = 2 * rows
        polar, around = np.meshgrid(np.pi * np.arange(1, rows) / rows, 2 * np.pi * np.arange(columns) / columns, indexing="ij")
        radius = 0.008 + 1e-4 * np.sin(5 * polar) * np.sin(6 * around)
        points = radius[..., None] * np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
        vertices = np.vstack([points.reshape(-1, 3), [0, 0, 0.008], [0, 0, -0.008]])
        a = columns * np.arange(rows - 2)[:, None] + np.arange(columns)
        b = columns * np.arange(rows - 2)[:, None] + (np.arange(columns) + 1) % columns
        sides = np.stack([a, a + columns, b + columns, a, b + columns, b], axis=-1).reshape(-1, 3)
        first, last, top = a[0], a[-1] + columns, len(points.reshape(-1, 3))
        ends = np.vstack([np.stack([np.full(columns, top), first, np.roll(first, -1)], axis=-1),
                          np.stack([np.full(columns, top + 1), np.roll(last, -1), last], axis=-1)])  # fmt: skip
        meshes.append(taxelsim.Mesh(vertices=vertices, triangles=np.vstack([sides, ends])))
    return meshes


def placed(shapes: list[object], rotation: tuple[float, ...], depth: float, instances: int) -> np.ndarray:
    """Poses at random places, the lowest points at the depth."""
    poses = np.zeros((instances, 7))
    poses[:, :2] = np.random.default_rng(0).uniform(-0.003, 0.003, (instances, 2))
    poses[:, 2] = [-lowest_height(shapes[i % len(shapes)], rotation) - depth for i in range(instances)]
    poses[:, 3:] = rotation
    return poses


class Case:
    """Objects on a sensor, driven by poses or, with a load, by that; reset before every frame if `resets`."""

    def __init__(
        self,
        device: taxelsim.Device,
        sensor: object,
        shapes: list[object],
        poses: np.ndarray,
        load: float | None = None,
        resets: bool = False,
    ) -> None:
        self.poses, self.load, self.resets = poses.copy(), load, resets
        self.simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, shapes), len(poses))
        self.ids = np.arange(len(poses)) % len(shapes)
        if load is not None:
            self.simulator.set_loads(np.full(len(poses), load, np.float32))

    def frame(self) -> object:
        """Steps once."""
        self.simulator.set_objects(self.ids, self.poses)
        self.simulator.step(0.001)
        return self.simulator.read()

    def at_found_poses(self, device: taxelsim.Device, sensor: object, shapes: list[object]) -> Case:
        """The same frame, driven by the poses that a load search has found."""
        truth = self.frame().ground_truth
        force = -truth.contact_wrench[:, 2]
        wrong = (np.abs(force - self.load) > CARRIED * self.load) | (truth.load_reached == 0)
        assert not wrong.any(), f"{wrong.sum()} loads are not carried: {force[wrong][:5]} N"
        poses = self.poses.copy()
        poses[:, 2] += truth.load_offset
        case = Case(device, sensor, shapes, poses)
        difference = np.abs(case.frame().ground_truth.contact_wrench - truth.contact_wrench).max()
        assert difference < 1e-4 * self.load, f"forces at the poses that were found differ by {difference} N or N m"
        return case


def processor_times(cases: list[Case], repeats: int) -> np.ndarray:
    """Processor time per frame (repeats x cases), us, in turns."""
    times = np.empty((repeats, len(cases)))
    for repeat in range(-3, repeats):
        for k, case in enumerate(cases):
            case.poses[:, 0] += 1e-5
            if case.resets:
                case.simulator.reset()
            begin = time.process_time()
            case.frame()
            if repeat >= 0:
                times[repeat, k] = (time.process_time() - begin) / len(case.poses) * 1e6
    return times


def loaded(sensor: object, shapes: list[object], poses: np.ndarray, arguments: argparse.Namespace) -> dict[str, float]:
    """Times at the poses that are found and under the load, and their ratio."""
    device = taxelsim.Device.open()
    driven, first = (Case(device, sensor, shapes, poses, arguments.load, resets) for resets in (False, True))
    times = processor_times([driven.at_found_poses(device, sensor, shapes), driven, first], arguments.repeats)
    row = dict(zip(("pose_us", "load_us", "first_us"), np.median(times, axis=0).tolist(), strict=True))
    ratios = np.median(times[:, 1:] / times[:, :1], axis=0).tolist()
    return {**row, "ratio": ratios[0], "first_ratio": ratios[1]}


def main() -> None:
    """Prints tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--instances", type=int, default=1024)
    parser.add_argument("--depth", type=float, default=0.0005, help="m")
    parser.add_argument("--load", type=float, default=2.0, help="N")
    parser.add_argument("--repeats", type=int, default=31)
    parser.add_argument("--more", action="store_true", help="foil and fingertip")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    device = taxelsim.Device.open()
    print(f"{device.info.name}, {arguments.instances} instances, processor time of a frame, us")
    scenes = [("wts0614", name, [shape], rotation) for name, (shape, rotation) in objects().items()]
    if arguments.more:
        scenes += [("foil", "8 meshes", bumpy_spheres(), UPRIGHT), ("fingertip", "sphere", objects()["sphere"][:1], UPRIGHT)]
    sensors = {"wts0614": taxelsim.load_sensor(SENSORS / "wts0614_soft_cover.yaml")}
    foil = taxelsim.GridPatch(name="foil", num_rows=16, num_cols=16, pitch=(0.002, 0.002))
    sensors["foil"] = sensors["wts0614"].replace(patches=[foil])
    sensors["fingertip"] = taxelsim.load_sensor(SENSORS / "fingertip_sphere.yaml")
    rows = []
    for place, name, shapes, rotation in scenes:
        poses = placed(list(shapes), rotation, arguments.depth, arguments.instances)
        for sampling, value in SAMPLINGS.items():
            row = loaded(sensors[place].replace(depth_sampling=value), list(shapes), poses, arguments)
            rows.append({"sensor": place, "object": name, "sampling": sampling, **row})
            times = f"at the pose {row['pose_us']:7.2f}, by load {row['load_us']:7.2f} x {row['ratio']:.2f}"
            print(f"{place:9} {name:16} {sampling:5} {times}, first {row['first_us']:7.2f} x {row['first_ratio']:.2f}", flush=True)
    for name, (shape, rotation) in objects().items():
        for depth in (arguments.depth, -0.05):
            poses = placed([shape], rotation, depth, arguments.instances)
            cases = [Case(device, sensors["wts0614"].replace(depth_sampling=value), [shape], poses) for value in SAMPLINGS.values()]
            times = processor_times(cases, arguments.repeats)
            point, area = np.median(times, axis=0)
            ratio = float(np.median(times[:, 1] / times[:, 0]))
            place = "in contact" if depth > 0 else "untouched"
            rows.append({"object": name, "place": place, "point_us": point, "area_us": area, "ratio": ratio})
            print(f"{name:16} {place:11} points {point:7.2f}, areas {area:7.2f}  x {ratio:.2f}", flush=True)
    write_json(arguments.json, {**machine(device), "rows": rows})


if __name__ == "__main__":
    main()
