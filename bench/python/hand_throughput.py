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
NUM_HANDS = 64
NUM_STEPS = 20
NUM_ROUNDS = 5


def batch(device: ts.Device, sensor: str, objects: list[ts.Object], count: int, slots: int, far: bool) -> ts.Simulator:
    """`count` instances, each 0.2 mm deep in the first object at places of their own, the other slots 0.2 m away or empty."""
    model = ts.Model(device, ts.load_sensor(SCENES / "sensors" / sensor), objects)
    simulator = ts.Simulator(model, count, num_slots=slots, outputs=ts.OutputOptions(tactile_normal_force=True))
    ids = np.zeros((count, slots), dtype=np.int32)
    poses = np.zeros((count, slots, 7))
    poses[..., 3] = 1
    poses[:, 0, :2] = np.random.default_rng(1).uniform(-1e-3, 1e-3, (count, 2))
    poses[:, 0, 2] = -2e-4
    if far:
        poses[:, 1:, 2] = 0.2
    simulator.set_objects(ids, poses)
    return simulator


def seconds(simulators: list[ts.Simulator]) -> float:
    """Least processor time of a step of all, s."""
    best = np.inf
    for _ in range(NUM_ROUNDS):
        start = time.process_time()
        for _ in range(NUM_STEPS):
            for simulator in simulators:
                simulator.step(0.01)
            frames = [simulator.read() for simulator in simulators]
        best = min(best, (time.process_time() - start) / NUM_STEPS)
    assert all((frame.total_force > 0).all() for frame in frames), "an instance is not in contact"
    return best


def main() -> None:
    """Measures and prints."""
    device = ts.Device.open()
    knob = ts.Object(ts.load_mesh(SCENES / "objects" / "knob_5k.obj"))
    palm = batch(device, "wts0614_soft_cover.yaml", [knob], NUM_HANDS, 1, False)
    fingers = batch(device, "fingertip_6x4.yaml", [knob], 5 * NUM_HANDS, 1, False)
    slots = batch(device, "wts0614_soft_cover.yaml", [knob], NUM_HANDS, 8, True)
    alone, hand, eight = seconds([palm]), seconds([palm, fingers]), seconds([slots])
    again = seconds([palm])
    rate = 84 * NUM_HANDS / min(alone, again)
    hand_rate = (84 + 5 * 24) * NUM_HANDS / hand
    print(f"{device.info.name}")
    print(f"palm alone {rate:,.0f} taxels/s, hand {hand_rate:,.0f} taxels/s: {hand_rate / rate:.2f}")
    print(f"eight slots, one near: {eight / min(alone, again):.3f} times the time of one slot")


if __name__ == "__main__":
    main()
