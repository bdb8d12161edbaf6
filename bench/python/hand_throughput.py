"""Taxels per second of a hand (five fingertips of 6 x 4 taxels and a palm of 6 x 14, all in contact with a mesh of 5,000 triangles)
compared with one palm alone, and of eight slots of which one is near, compared with one slot. Processor time of this process, which is what
counts on software Vulkan where others use the processor too. Run with LP_NUM_THREADS=1:

    python bench/python/hand_throughput.py
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import taxelsim as ts

SCENES = Path(__file__).parents[2] / "scenes"
PALM = "wts0614_soft_cover.yaml"
LOWEST = {"knob": 0.0, "cylinder": 0.015}  # m, from the lowest point to the origin
NUM_HANDS = 64
NUM_STEPS = 20
NUM_ROUNDS = 5


def batch(device: ts.Device, sensor: str, touching: ts.Object, count: int, slots: int = 1, samples: int = 4) -> ts.Simulator:
    """`count` instances, each 0.2 mm deep in the object at places of their own; in all slots but the first the object is 0.2 m away.

    samples: per side of a taxel.
    """
    model = ts.Model(device, ts.load_sensor(SCENES / "sensors" / sensor).replace(samples_per_taxel=samples), [touching])
    simulator = ts.Simulator(model, count, num_slots=slots, outputs=ts.OutputOptions(tactile_normal_force=True))
    poses = np.zeros((count, slots, 7))
    poses[..., 3] = 1
    poses[:, 0, :2] = np.random.default_rng(1).uniform(-1e-3, 1e-3, (count, 2))
    poses[:, 0, 2] = LOWEST[touching.name] - 2e-4
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
    palm = batch(device, PALM, knob, NUM_HANDS)
    for samples in (4, 3):
        fingers = batch(device, "fingertip_6x4.yaml", knob, 5 * NUM_HANDS, samples=samples)
        alone, hand = seconds([palm], [palm, fingers])
        loaded = [np.count_nonzero(simulator.read().tactile_image) / simulator.num_instances for simulator in (palm, fingers)]
        rate, hand_rate = 84 * NUM_HANDS / alone, (84 + 5 * 24) * NUM_HANDS / hand
        print(f"samples {3.4 / 4:.2f} mm apart on the palm, {2.5 / samples:.2f} mm on fingertips; ", end="")
        print(f"loaded taxels of a palm {loaded[0]:.0f} of 84, of a fingertip {loaded[1]:.0f} of 24")
        print(f"palm alone {rate:,.0f} taxels/s, hand {hand_rate:,.0f} taxels/s: {hand_rate / rate:.2f}")
    for touching in (knob, cylinder):
        for sensor in (PALM, "wts0614_lugre.yaml"):
            one, eight = seconds([batch(device, sensor, touching, NUM_HANDS)], [batch(device, sensor, touching, NUM_HANDS, 8)])
            print(f"{touching.name} on {sensor}: eight slots, one near, take {eight / one:.3f} times the time of one slot")


if __name__ == "__main__":
    main()
