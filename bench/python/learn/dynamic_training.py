"""PPO of Stable-Baselines3 on the tasks with dynamics: policies that get what the scripts get, with touch, without shear and blind, and
controls that get one observation of touch instead.
"""

from __future__ import annotations

import json
import time
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from gymnasium import spaces
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecEnvWrapper, VecNormalize
from torch import nn

import taxelsim
from taxelsim.envs.dynamics.evaluation import evaluate
from taxelsim.envs.dynamics.vector_env import DynamicVectorEnv
from taxelsim.envs.sb3 import StableBaselinesVecEnv

from .recipe import CONDITIONS, CONTROLS, NUM_THREADS, TRAINING_CONDITION, TRAINING_SEED, DynamicRecipe

EVALUATION_SEED = 1  # that of the scripts, in bench/python/dynamics_success.py
LEAST_FORCE = 0.2  # N, of the start, by which later forces are divided
LIMIT = 5.0  # of an input of the network, in standard deviations


def observations_of(sense: str) -> tuple[str, ...]:
    """Observations of a policy. Those that are no control get contact and shear, or parts of them."""
    return (*((CONTROLS[sense],) if sense in CONTROLS else ("contact", "shear")), "proprioception", "goal")


class Inputs:
    """Observations and step numbers to inputs (N, num_inputs) of a network without memory. Keeps the first observations of each episode.

    Contents: contact, shear, goal, positions of the joints, the lag of each behind its target; contact and shear of the first frame, what
    they changed since, the normal force relative to the first one, and the part of the episode that has passed.
    sense: "shear", "normal" or "blind", as of the scripts; what is not sensed is 0. Of CONTROLS: that observation takes the place of
    contact and shear, and there is no relative force.
    """

    def __init__(self, sense: str, max_steps: int) -> None:
        self._sense, self._max_steps = sense, max_steps
        self._first = np.empty((0, 0))

    def __call__(self, observation: Mapping[str, NDArray[Any]], steps: NDArray[np.int64]) -> NDArray[np.float32]:
        """Inputs (N, num_inputs). steps (N): 0 in the first observation of an episode."""
        felt = self._felt(observation)
        if self._first.shape != felt.shape:
            self._first = felt.copy()
        started = steps == 0
        self._first[started] = felt[started]
        return self._inputs(observation, felt, self._first, steps)

    def last(self, observation: Mapping[str, NDArray[Any]], row: int, step: int) -> NDArray[np.float32]:
        """Inputs (num_inputs) of the last observation of an episode of environment `row`, before the next one begins."""
        one = {name: values[np.newaxis] for name, values in observation.items()}
        return self._inputs(one, self._felt(one), self._first[row : row + 1], np.array([step]))[0]

    def _felt(self, observation: Mapping[str, NDArray[Any]]) -> NDArray[np.float64]:
        if self._sense in CONTROLS:
            values = observation[CONTROLS[self._sense]]
            return values.reshape(len(values), -1).astype(np.float64)
        contact, shear = (observation[name].astype(np.float64) for name in ("contact", "shear"))
        return np.concatenate((contact * (self._sense != "blind"), shear * (self._sense == "shear")), axis=1)

    def _inputs(
        self, observation: Mapping[str, NDArray[Any]], felt: NDArray[np.float64], first: NDArray[np.float64], steps: NDArray[np.int64]
    ) -> NDArray[np.float32]:
        joints = observation["proprioception"].astype(np.float64)
        positions, targets = np.split(joints, 2, axis=1)
        relative = () if self._sense in CONTROLS else (felt[:, 3:4] / np.maximum(first[:, 3:4], LEAST_FORCE),)
        passed = steps[:, np.newaxis] / self._max_steps
        parts = (felt, observation["goal"], positions, targets - positions, first, felt - first, *relative, passed)
        return np.concatenate(parts, axis=1).astype(np.float32)


class InputsVecEnv(VecEnvWrapper):
    """A task with dynamics whose observations are the inputs of the network."""

    def __init__(self, envs: DynamicVectorEnv, sense: str, seed: int) -> None:
        self._inputs = Inputs(sense, envs.max_episode_steps)
        self._steps = np.zeros(envs.num_envs, np.int64)
        observation, _ = envs.reset(seed=seed)
        size = self._inputs(observation, self._steps).shape[1]
        super().__init__(StableBaselinesVecEnv(envs), observation_space=spaces.Box(-np.inf, np.inf, (size,), np.float32))

    def reset(self) -> NDArray[np.float32]:
        self._steps[:] = 0
        return self._inputs(self.venv.reset(), self._steps)

    def step_wait(self) -> Any:
        observation, rewards, done, infos = self.venv.step_wait()
        for i in np.flatnonzero(done):
            infos[i]["terminal_observation"] = self._inputs.last(infos[i]["terminal_observation"], int(i), int(self._steps[i]) + 1)
        self._steps = np.where(done, 0, self._steps + 1)
        return self._inputs(observation, self._steps), rewards, done, infos


class Successes(BaseCallback):
    """Success of the episodes of the training, with random actions: of the last num_envs ones at the start of every tenth rollout."""

    def __init__(self, num_envs: int) -> None:
        super().__init__()
        self.points: list[dict[str, float]] = []
        self._recent: deque[bool] = deque(maxlen=num_envs)
        self._num_rollouts = 0

    def _on_rollout_start(self) -> None:
        if self._num_rollouts % 10 == 0 and self._recent:
            self.points.append({"steps": self.num_timesteps, "success": float(np.mean(self._recent))})
            print(f"{self.num_timesteps:,} steps: {100 * self.points[-1]['success']:.0f} %", flush=True)
        self._num_rollouts += 1

    def _on_step(self) -> bool:
        self._recent.extend(info["is_success"] for info in self.locals["infos"] if "is_success" in info)
        return True


def train(task: str, sense: str, recipe: DynamicRecipe, folder: Path, device: taxelsim.Device, seed: int = TRAINING_SEED) -> None:
    """Trains a policy; writes TASK-SENSE.zip, the policy, TASK-SENSE.npz, the scales of its inputs, and TASK-SENSE.json."""
    torch.set_num_threads(NUM_THREADS)
    envs = _environments(task, sense, recipe.num_envs, TRAINING_CONDITION, device)
    scaled = VecNormalize(InputsVecEnv(envs, sense, seed), clip_obs=LIMIT, gamma=recipe.gamma)  # type: ignore[arg-type]
    model = PPO(
        "MlpPolicy",
        scaled,
        policy_kwargs={"net_arch": recipe.layers, "activation_fn": nn.Tanh, "log_std_init": float(np.log(recipe.deviation))},
        **recipe.arguments(seed),
    )
    successes = Successes(recipe.num_envs)
    begun = time.process_time()
    model.learn(recipe.num_steps, callback=successes)
    content = {
        "points": successes.points,
        "steps": model.num_timesteps,
        "cpu_seconds": round(time.process_time() - begun, 1),  # of all threads
    }
    model.save(folder / f"{task}-{sense}.zip")
    scales = scaled.obs_rms
    assert isinstance(scales, RunningMeanStd)
    np.savez(folder / f"{task}-{sense}.npz", mean=scales.mean, deviation=np.sqrt(scales.var + scaled.epsilon))
    envs.close()
    (folder / f"{task}-{sense}.json").write_text(json.dumps(content, indent=1) + "\n")


def _environments(task: str, sense: str, num_envs: int, condition: str, device: taxelsim.Device) -> DynamicVectorEnv:
    envs = gymnasium.make_vec(
        f"taxelsim/{task}-v0", num_envs=num_envs, condition=condition, device=device, observations=observations_of(sense)
    )
    assert isinstance(envs, DynamicVectorEnv)
    return envs


class TrainedPolicy:
    """The mean action of a policy that train() wrote."""

    def __init__(self, task: str, sense: str, folder: Path, max_steps: int) -> None:
        self._model = PPO.load(folder / f"{task}-{sense}.zip", device="cpu")
        with np.load(folder / f"{task}-{sense}.npz") as scales:
            self._mean, self._deviation = scales["mean"], scales["deviation"]
        self._inputs = Inputs(sense, max_steps)

    def __call__(self, observation: Mapping[str, NDArray[Any]], steps: NDArray[np.int64]) -> NDArray[np.float32]:
        """Actions (N, A)."""
        inputs = np.clip((self._inputs(observation, steps) - self._mean) / self._deviation, -LIMIT, LIMIT).astype(np.float32)
        actions: NDArray[np.float32] = self._model.predict(inputs, deterministic=True)[0]
        return actions


def evaluations(task: str, senses: Sequence[str], folder: Path, num_episodes: int, device: taxelsim.Device) -> dict[str, dict[str, Any]]:
    """Successes by condition and sense, one digit per episode, in the episodes of the scripts. Keeps each in a file of `folder`.

    `peak_force` and `mean_force`, N: medians over the episodes of the largest and the mean true normal force.
    """
    results: dict[str, dict[str, Any]] = {condition: {} for condition in CONDITIONS}
    for condition in CONDITIONS:
        for sense in senses:
            file = folder / f"{task}-{sense}-{condition}-{num_episodes}.json"
            if file.exists():
                results[condition][sense] = json.loads(file.read_text())
                continue
            envs = _environments(task, sense, num_episodes, condition, device)
            found = evaluate(envs, TrainedPolicy(task, sense, folder, envs.max_episode_steps), EVALUATION_SEED)
            envs.close()
            print(f"{task} {condition}: {sense} {found} %", flush=True)
            forces = {name: round(float(np.median(found.metrics[name])), 4) for name in ("peak_force", "mean_force")}
            results[condition][sense] = {"successes": "".join("01"[int(success)] for success in found.success), **forces}
            file.write_text(json.dumps(results[condition][sense]) + "\n")
    return results
