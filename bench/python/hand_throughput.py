"""Taxels per second of a hand (five fingertips and a palm of 6 x 14 taxels, all in contact with a mesh of 5,000 triangles) compared with
one palm alone: fingertips as flat grids of 6 x 4 taxels, and curved ones. The mesh is a knob, which is smaller than the palm, or a bar of
soap, whose face covers it. And of eight slots of which one is near, compared with one slot.

Two ratios: of all taxels, and of those that read a force. A taxel without a load costs little, so that a palm that is loaded in part has
more taxels per second than one that is loaded everywhere.
Processor time of this process, which is what counts on software Vulkan where others use the processor too. Run with LP_NUM_THREADS=1:

    python bench/python/hand_throughput.py
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from report import ROOT

import taxelsim as ts

sys.path.insert(0, str(ROOT / "scripts"))
from make_objects import icosphere

SCENES = ROOT / "scenes"
PALM = "wts0614_soft_cover.yaml"
SOAP = (0.03, 0.045, 0.015)  # m, half of its size along x, y and z: a bar of 60 x 90 x 30 mm
SOAP_EXPONENT = 4  # of a superellipsoid: its faces are nearly flat, its edges round
FINGERTIPS = (("fingertip_6x4", 4), ("fingertip_6x4", 3), ("fingertip_sphere", 4), ("fingertip_cylinder", 4))  # samples per side of a taxel
DEPTHS = (2e-4, 1e-3)  # m, of the mesh in each sensor
NUM_HANDS = 256  # more than the processor's caches hold
NUM_STEPS = 5
NUM_ROUNDS = 5


def soap() -> ts.Object:
    """A bar of soap: |x/a|^4 + |y/b|^4 + |z/c|^4 = 1, of 5,120 triangles, which stay as they are."""
    vertices, triangles = icosphere(4)
    points = np.array(vertices)
    points /= (points**SOAP_EXPONENT).sum(axis=1, keepdims=True) ** (1 / SOAP_EXPONENT)
    return ts.Object(ts.Mesh(points * SOAP, triangles), "soap")


def lowest(touching: ts.Object) -> float:
    """From the lowest point of an object to its origin, m."""
    shape: Any = touching.shape
    return float(-shape.vertices[:, 2].min() if isinstance(shape, ts.Mesh) else shape.length / 2)


def batch(
    device: ts.Device, sensor: str, touching: ts.Object, count: int, slots: int = 1, samples: int = 4, depth: float = 2e-4
) -> ts.Simulator:
    """`count` instances, each `depth` (m) deep in the object at places of their own; in all slots but the first the object is 0.2 m away.

    samples: per side of a taxel.
    """
    model = ts.Model(device, ts.load_sensor(SCENES / "sensors" / sensor).replace(samples_per_taxel=samples), [touching])
    simulator = ts.Simulator(model, count, num_slots=slots, outputs=ts.OutputOptions(tactile_normal_force=True))
    poses = np.zeros((count, slots, 7))
    poses[..., 3] = 1
    poses[:, 0, :2] = np.random.default_rng(1).uniform(-1e-3, 1e-3, (count, 2))
    poses[:, 0, 2] = lowest(touching) - depth
    poses[:, 1:, 2] = 0.2
    simulator.set_objects(np.zeros((count, slots), dtype=np.int32), poses)
    return simulator


def seconds(*batches: list[ts.Simulator]) -> list[float]:
    """Least processor time of a step of all simulators of each batch, s. The batches take turns."""
    best = [np.inf] * len(batches)
    for _ in range(NUM_ROUNDS):
        for k, simulators in enumerate(batches):
            start = time.process_time()
            for _ in range(NUM_STEPS):
                for simulator in simulators:
                    simulator.step(0.01)
                frames = [simulator.read() for simulator in simulators]
            best[k] = min(best[k], (time.process_time() - start) / NUM_STEPS)
            assert all((frame.total_force > 0).all() for frame in frames), "an instance is not in contact"
    return best


def compare_hand(device: ts.Device, touching: ts.Object, depth: float) -> None:
    """Prints the ratios of hand and palm for each kind of fingertip."""
    palm = batch(device, PALM, touching, NUM_HANDS, depth=depth)
    for sensor, samples in FINGERTIPS:
        fingers = batch(device, f"{sensor}.yaml", touching, 5 * NUM_HANDS, samples=samples, depth=depth)
        alone, hand = seconds([palm], [palm, fingers])
        taxels = np.array([simulator.read().tactile_image[0].size for simulator in (palm, fingers)])
        loaded = np.array([np.count_nonzero(simulator.read().tactile_image) / simulator.num_instances for simulator in (palm, fingers)])
        ratios = [(count[0] + 5 * count[1]) / hand / (count[0] / alone) for count in (taxels, loaded)]
        us_alone, us_finger = (1e6 * time / NUM_HANDS for time in (alone, (hand - alone) / 5))
        print(f"{touching.name}, {1e3 * depth:.1f} mm deep, {sensor}, {taxels[1]} taxels with {samples} x {samples} samples: ", end="")
        print(f"{ratios[0]:.2f} of all taxels, {ratios[1]:.2f} of those that read; ", end="")
        print(f"palm {us_alone:.1f} us, {loaded[0]:.0f} read; a fingertip {us_finger:.1f} us, {loaded[1]:.1f} read", flush=True)


def main() -> None:
    """Measures and prints."""
    device = ts.Device.open()
    knob = ts.Object(ts.load_mesh(SCENES / "objects" / "knob_5k.obj", max_depth_error=0), "knob")
    bar = soap()
    cylinder = ts.Object(ts.Cylinder(radius=0.01, length=0.03), "cylinder")
    print(device.info.name, *(f"{mesh.name}: {len(mesh.shape.triangles):,} triangles" for mesh in (knob, bar)), sep="; ")
    for touching in (knob, bar):
        for depth in DEPTHS:
            compare_hand(device, touching, depth)
    for touching in (knob, cylinder):
        for sensor in (PALM, "wts0614_lugre.yaml"):
            one, eight = seconds([batch(device, sensor, touching, NUM_HANDS)], [batch(device, sensor, touching, NUM_HANDS, 8)])
            print(f"{touching.name} on {sensor}: eight slots, one near, take {eight / one:.3f} times the time of one slot")


if __name__ == "__main__":
    main()
