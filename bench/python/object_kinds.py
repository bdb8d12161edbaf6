"""Cost of a frame of an object in a model with objects of other kinds, compared with a model of this object alone: a cylinder, a prism
of 24 triangles, a knob, and two scanned objects. And of a batch in which the five take turns, compared with the mean of the five alone.

Every object presses with 3 N at a random yaw and jumps by 1 mm between frames, so that no triangles are kept. Lower quartile of the
processor time of this process, cases in turns. Run with LP_NUM_THREADS=1:

    python bench/python/object_kinds.py
"""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt
from report import ROOT

import taxelsim as ts

OBJECTS: dict[str, ts.Object | ts.Cylinder] = {
    "cylinder": ts.Cylinder(radius=0.008, length=0.04),
    **{
        name: ts.load_mesh(ROOT / "scenes/objects" / file)
        for name, file in (
            ("prism", "hex_prism.obj"),
            ("knob", "knob_5k.obj"),
            ("banana", "YcbBanana.obj"),
            ("drill", "YcbPowerDrill.obj"),
        )
    },
}
NUM_INSTANCES = 2000
NUM_ROUNDS = 31
LOAD = 3.0  # N
JUMP = 1e-3  # m
CLEARANCE = 0.02  # m, from the skin to the origin of an object before the load search

Poses = npt.NDArray[np.float64]


def resting(model: ts.Model, name: str, random: np.random.Generator) -> Poses:
    """(NUM_INSTANCES, 7): poses of the only object of `model` at which it presses with LOAD; a cylinder lies."""
    half_yaw = random.uniform(-np.pi / 2, np.pi / 2, NUM_INSTANCES)
    lying = np.sqrt(0.5) if name == "cylinder" else 0.0
    upright = np.sqrt(1 - lying**2)
    poses = np.zeros((NUM_INSTANCES, 7))
    poses[:, :2] = random.uniform(-3e-3, 3e-3, (NUM_INSTANCES, 2))
    poses[:, 2] = CLEARANCE
    poses[:, 3], poses[:, 4] = np.cos(half_yaw) * upright, np.cos(half_yaw) * lying
    poses[:, 5], poses[:, 6] = np.sin(half_yaw) * lying, np.sin(half_yaw) * upright
    simulator = ts.Simulator(model, NUM_INSTANCES)
    simulator.set_objects(0, poses)
    simulator.set_loads(np.full(NUM_INSTANCES, LOAD))
    simulator.step(0.01)
    poses[:, 2] += simulator.read().ground_truth.load_offset
    return poses


class Case:
    """A batch whose objects jump back and forth."""

    def __init__(self, model: ts.Model, ids: npt.NDArray[np.int64], poses: Poses) -> None:
        self._simulator, self._ids, self._poses = ts.Simulator(model, NUM_INSTANCES), ids, poses
        self._seconds: list[float] = []

    def step(self, number: int) -> None:
        moved = self._poses.copy()
        moved[:, 0] += JUMP * (number % 5 - 2)
        self._simulator.set_objects(self._ids, moved)
        start = time.process_time()
        self._simulator.step(0.01)
        frame = self._simulator.read()
        self._seconds.append(time.process_time() - start)
        assert (frame.total_force > 0).mean() > 0.9, "most objects must be in contact"

    def microseconds(self) -> float:
        """Of a frame of one instance, without the first frames."""
        return float(np.quantile(self._seconds[3:], 0.25) / NUM_INSTANCES * 1e6)


def main() -> None:
    """Print the costs and their ratios."""
    device = ts.Device.open()
    sensor = ts.load_sensor(ROOT / "bench/sensors/wts0614.yaml")
    together = ts.Model(device, sensor, list(OBJECTS.values()))
    random = np.random.default_rng(1)
    alone: dict[str, Case] = {}
    among: dict[str, Case] = {}
    poses: list[Poses] = []
    for number, (name, touching) in enumerate(OBJECTS.items()):
        model = ts.Model(device, sensor, [touching])
        poses.append(resting(model, name, random))
        alone[name] = Case(model, np.zeros(NUM_INSTANCES, dtype=np.int64), poses[-1])
        among[name] = Case(together, np.full(NUM_INSTANCES, number), poses[-1])
    turns = np.arange(NUM_INSTANCES) % len(OBJECTS)
    mixed = Case(together, turns, np.stack([poses[k][i] for i, k in enumerate(turns)]))
    for number in range(NUM_ROUNDS):
        for case in (*alone.values(), *among.values(), mixed):
            case.step(number)
    print(f"{device.info.name}, {device.info.driver}, {NUM_INSTANCES} instances, processor time of a frame")
    for name in OBJECTS:
        one, other = alone[name].microseconds(), among[name].microseconds()
        print(f"  {name:10s} alone {one:6.2f} us, in a model of {len(OBJECTS)} {other:6.2f} us: {100 * (other / one - 1):+.1f} %")
    mean, turns_cost = float(np.mean([case.microseconds() for case in alone.values()])), mixed.microseconds()
    print(f"  in turns {turns_cost:.2f} us, mean of the objects alone {mean:.2f} us: {100 * (turns_cost / mean - 1):+.1f} %")


if __name__ == "__main__":
    main()
