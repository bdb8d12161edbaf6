"""Environments with a 64-64 network of PyTorch: backend="torch" and backend="numpy" in turns. Needs torch.

python tensors.py [--num-envs 2048] [--turns 7] [--json FILE]

Verifies first that both backends give the same observations and rewards. Then it prints environment steps per second, the share of the time
in the C++ batch, which runs the device and waits for it, and the largest allocation of a step.
"""

from __future__ import annotations

import argparse
import time
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import torch
from report import machine, ratio, summary, write_json

import taxelsim
from taxelsim.envs.tasks import make_vec

NUM_STEPS = 40  # of a turn
BACKENDS = ("numpy", "torch")


class Side:
    """Environments of one backend, driven by a network."""

    def __init__(self, backend: str, num_envs: int, device: taxelsim.Device) -> None:
        self.backend = backend
        self.envs = make_vec("EdgeFollow", num_envs, device=device, backend=backend)
        size, num_actions = self.envs.single_observation_space.shape[0], self.envs.single_action_space.shape[0]
        torch.manual_seed(1)
        layers = (torch.nn.Linear(size, 64), torch.nn.Tanh(), torch.nn.Linear(64, 64), torch.nn.Tanh(), torch.nn.Linear(64, num_actions))
        self.network = torch.nn.Sequential(*layers, torch.nn.Tanh())
        self.observation = self.envs.reset(seed=1)[0]
        self.seconds_in_batch = 0.0
        batch = self.envs._batch
        for name in ("step", "observe", "task_state", "judge", "reset"):
            setattr(batch, name, self._timed(getattr(batch, name)))

    def _timed(self, function: Any) -> Any:
        def call(*arguments: Any) -> Any:
            begun = time.perf_counter()
            result = function(*arguments)
            self.seconds_in_batch += time.perf_counter() - begun
            return result

        return call

    def step(self) -> Any:
        """One step of the network and the environments."""
        with torch.no_grad():
            seen = self.observation if self.backend == "torch" else torch.from_numpy(self.observation)
            actions = 0.1 * self.network(seen)
        results = self.envs.step(actions if self.backend == "torch" else actions.numpy())
        self.observation = results[0]
        return results

    def turn(self) -> tuple[float, float]:
        """Steps per second of all environments together, and the share of the batch in the time."""
        self.seconds_in_batch, begun = 0.0, time.perf_counter()
        for _ in range(NUM_STEPS):
            self.step()
        seconds = time.perf_counter() - begun
        return NUM_STEPS * self.envs.num_envs / seconds, self.seconds_in_batch / seconds


def main() -> None:
    """Prints and writes the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--num-envs", type=int, default=2048)
    parser.add_argument("--turns", type=int, default=7)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    sides = [Side(backend, options.num_envs, device) for backend in BACKENDS]
    for _ in range(NUM_STEPS):
        found = [side.step() for side in sides]
        for one, other in zip(found[0][:4], found[1][:4], strict=True):
            np.testing.assert_array_equal(one, np.asarray(other))
    turns = [[side.turn() for side in sides] for _ in range(options.turns)]
    rates = [[turn[i][0] for turn in turns] for i in range(2)]
    shares = [float(np.median([turn[i][1] for turn in turns])) for i in range(2)]
    largest = []
    for side in sides:
        tracemalloc.start()
        peaks = []
        for _ in range(5):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            side.step()
            peaks.append(tracemalloc.get_traced_memory()[1] - before)
        tracemalloc.stop()
        largest.append(max(peaks))
    results = {}
    for backend, rate, share, size in zip(BACKENDS, rates, shares, largest, strict=True):
        results[backend] = {"steps_per_second": summary(rate), "share_of_batch": share, "bytes_of_a_step": size}
        print(
            f"{backend:6} {np.median(rate):10,.0f} environment steps/s, {share:.0%} of the time in the batch, {size / 1e6:.2f} MB in a step"
        )
    of_numpy = ratio(rates[1], rates[0])
    print(f"torch over numpy: {of_numpy:.3f}")
    write_json(options.json, {"machine": machine(device), "num_envs": options.num_envs, "results": results, "torch_over_numpy": of_numpy})


main()
