"""PPO of Stable-Baselines3 from random weights: a policy that feels, controls with one observation of touch, and a blind one."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
import torch
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

import taxelsim
from taxelsim.envs import Reward
from taxelsim.envs.sb3 import StableBaselinesVecEnv
from taxelsim.tasks import TASKS

from .network import Actor, PpoInputs, as_policy, joined, write_onnx
from .recipe import HISTORY, NUM_THREADS, TRAINING_CONDITION, TRAINING_SEED, VALIDATION_SEED, Recipe, ppo_settings


class Extractor(BaseFeaturesExtractor):
    """The inputs of the network, for Stable-Baselines3."""

    def __init__(self, space: spaces.Dict, names: Sequence[str], blind: bool) -> None:
        sizes = {name: int(torch.Size(box.shape).numel()) // HISTORY for name, box in space.items()}
        inputs = PpoInputs(sizes, names, blind)
        super().__init__(space, inputs.num_inputs)
        self.names, self.inputs = names, inputs

    def forward(self, observation: dict[str, torch.Tensor]) -> torch.Tensor:
        inputs: torch.Tensor = self.inputs(joined(observation, self.names))
        return inputs


def actor_of(model: PPO) -> Actor:
    """The network of the mean action."""
    policy: Any = model.policy
    return Actor(policy.features_extractor.inputs, policy.mlp_extractor.policy_net, policy.action_net)


class Curve(BaseCallback):
    """Success of the mean action on validation episodes, every `validation_interval` steps."""

    def __init__(self, task: str, name: str, recipe: Recipe) -> None:
        super().__init__()
        self.points: list[dict[str, float]] = []
        self._settings, self._name, self._recipe = ppo_settings(task, name), name, recipe
        self._scene = taxelsim.load_scene(
            taxelsim.SCENES / TASKS[task].scene,
            num_episodes=recipe.num_validations,
            seed=VALIDATION_SEED,
            condition=TRAINING_CONDITION,
        )
        self._device = taxelsim.Device.open()
        self._next = 0

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self._next:
            self._next += self._recipe.validation_interval
            self.validate()

    def _on_step(self) -> bool:
        return True

    def validate(self) -> None:
        """Adds a point."""
        assert isinstance(self.model, PPO)
        policy = as_policy(actor_of(self.model), self._name, self._settings)
        (evaluation,) = taxelsim.evaluate(self._scene, policy=policy, device=self._device)
        point = {
            "steps": self.num_timesteps,
            "success": evaluation.total.success_rate,
            "num_lost": evaluation.total.num_lost,
            "errors": [error.median for error in evaluation.total.steady_error],
        }
        self.points.append(point)
        print(f"{self._name}: {json.dumps(point)} std {self.model.policy.log_std.exp().tolist()}", flush=True)


def train(task: str, name: str, recipe: Recipe, folder: Path) -> None:
    """Trains a policy; writes NAME.onnx, and NAME.curve.json with the points of its learning curve."""
    torch.set_num_threads(NUM_THREADS)
    settings = ppo_settings(task, name)
    scene = taxelsim.load_scene(taxelsim.SCENES / TASKS[task].scene, seed=TRAINING_SEED, condition=TRAINING_CONDITION)
    envs = gymnasium.make_vec(
        f"taxelsim/{task}-v0",
        num_envs=recipe.num_envs,
        scene=scene,
        condition=TRAINING_CONDITION,
        reward=Reward(widths=recipe.reward_widths),
        **settings,
    )
    model = PPO(
        "MultiInputPolicy",
        StableBaselinesVecEnv(envs),
        policy_kwargs={
            "net_arch": recipe.layers,
            "activation_fn": nn.Tanh,
            "log_std_init": math.log(recipe.deviation),
            "features_extractor_class": Extractor,
            "features_extractor_kwargs": {"names": settings["observations"], "blind": name == "blind"},
        },
        **recipe.arguments(),
    )
    curve = Curve(task, name, recipe)
    begun = time.process_time()
    model.learn(recipe.num_steps, callback=curve)
    cpu_seconds = time.process_time() - begun
    curve.validate()
    write_onnx(actor_of(model), folder / f"{name}.onnx", settings)
    content = {
        "points": curve.points,
        "steps": model.num_timesteps,
        "cpu_seconds": round(cpu_seconds, 1),  # of all threads, with validation
    }
    (folder / f"{name}.curve.json").write_text(json.dumps(content, indent=1) + "\n")
