"""Taxels per second of a hand (five fingertips and a palm of 6 x 14 taxels, all in contact with a mesh of 5,000 triangles) compared with
one palm alone: fingertips as flat grids of 6 x 4 taxels, and curved ones. And of eight slots of which one is near, compared with one slot.
Processor time of this process, which is what counts on software Vulkan where others use the processor too. Run with LP_NUM_THREADS=1:

    python bench/python/hand_throughput.py
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import taxelsim as ts

SCENES = Path(__file__).parents[2] / "scenes"
PALM = "wts0614_soft_cover.yaml"
LOWEST = {"knob": 0.009, "cylinder": 0.015}  # m, from the lowest point to the origin
FINGERTIPS = (("fingertip_6x4", 4), ("fingertip_6x4", 3), ("fingertip_sphere", 4), ("fingertip_cylinder", 4))  # samples per side of a taxel
DEPTHS = (2e-4, 1e-3)  # m, of the mesh in each sensor
NUM_HANDS = 256  # more than the processor's caches hold
NUM_STEPS = 5
NUM_ROUNDS = 5


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
    poses[:, 0, 2] = LOWEST[touching.name] - depth
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


def main() -> None:
    """Measures and prints."""
    device = ts.Device.open()
    knob = ts.Object(ts.load_mesh(SCENES / "objects" / "knob_5k.obj"), "knob")
    cylinder = ts.Object(ts.Cylinder(radius=0.01, length=0.03), "cylinder")
    print(device.info.name)
    for depth in DEPTHS:
        palm = batch(device, PALM, knob, NUM_HANDS, depth=depth)
        for sensor, samples in FINGERTIPS:
            fingers = batch(device, f"{sensor}.yaml", knob, 5 * NUM_HANDS, samples=samples, depth=depth)
            alone, hand = seconds([palm], [palm, fingers])
            num_taxels = fingers.read().tactile_image[0].size
            ratio = (84 + 5 * num_taxels) / hand / (84 / alone)
            loaded = [np.count_nonzero(simulator.read().tactile_image) / simulator.num_instances for simulator in (palm, fingers)]
            us_alone, us_finger = (1e6 * time / NUM_HANDS for time in (alone, (hand - alone) / 5))
            print(f"{1e3 * depth:.1f} mm deep, {sensor}, {num_taxels} taxels with {samples} x {samples} samples: {ratio:.2f}; ", end="")
            print(f"palm {us_alone:.1f} us, {loaded[0]:.0f} loaded taxels; a fingertip {us_finger:.1f} us, {loaded[1]:.0f}", flush=True)
    for touching in (knob, cylinder):
        for sensor in (PALM, "wts0614_lugre.yaml"):
            one, eight = seconds([batch(device, sensor, touching, NUM_HANDS)], [batch(device, sensor, touching, NUM_HANDS, 8)])
            print(f"{touching.name} on {sensor}: eight slots, one near, take {eight / one:.3f} times the time of one slot")


if __name__ == "__main__":
    main()
