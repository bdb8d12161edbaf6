"""What the policies see and command, and how they are trained. The same for all tasks, but for the entries of RECIPES."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from taxelsim.tasks import TASKS

OBSERVATIONS = ("features", "tactile_image", "start_contact", "proprioception")  # of the clone
PPO_OBSERVATIONS = ("features", "start_contact", "proprioception")  # as in examples/train_ppo.py
CONTROLS = {"image": "tactile_image", "center": "center_of_pressure", "binary": "binary_contact"}
"""Observation of touch of a control, by the name of its policy. It takes the place of all others, but for `start_contact`."""
TACTILE = ("features", "tactile_image", "start_contact")  # what a blind policy does not see
HISTORY = 4  # frames, 10 ms apart

EVALUATION_SEED, VALIDATION_SEED, TRAINING_SEED, DEMONSTRATION_SEED = 2, 101, 102, 103
CONDITIONS = ("nominal", "randomized", "unseen")
TRAINING_CONDITION = "randomized"
NUM_THREADS = 1  # of torch: results do not depend on the number of cores


@dataclass(frozen=True, kw_only=True)
class PpoSettings:
    """Settings of PPO."""

    num_steps: int  #: Environment steps.
    num_envs: int = 256
    hidden: tuple[int, ...] = (64, 64)  #: Widths of the hidden layers of policy and value, tanh.
    rollout: int  #: Steps of each environment between updates.
    batch: int
    num_updates: int = 5  #: Passes over a rollout.
    learning_rate: float = 1e-3  #: Falls to 0 linearly.
    gamma: float
    gae_lambda: float

    def arguments(self, seed: int = TRAINING_SEED) -> dict[str, Any]:
        """Arguments of PPO of Stable-Baselines3, without policy and environments."""
        return {
            "n_steps": self.rollout,
            "batch_size": self.batch,
            "n_epochs": self.num_updates,
            "learning_rate": lambda left: self.learning_rate * left,
            "gamma": self.gamma,
            "gae_lambda": self.gae_lambda,
            "seed": seed,
            "device": "cpu",
        }

    @property
    def layers(self) -> dict[str, list[int]]:
        """`net_arch` of Stable-Baselines3."""
        return {"pi": list(self.hidden), "vf": list(self.hidden)}


@dataclass(frozen=True, kw_only=True)
class Recipe(PpoSettings):
    """Settings of one task. PPO is that of examples/train_ppo.py. Scales: m/s and rad/s at action 1, of the clone."""

    linear_scale: float
    angular_scale: float = 1.0
    # Behaviour cloning. Its network has the hidden layers of PPO's.
    num_demonstrations: int = 2000  #: Episodes of all controllers of the scene; those of the first one that succeed are cloned.
    num_epochs: int = 30
    cloning_rate: float = 2e-3  #: Learning rate, falls to 0 by a cosine.
    cloning_batch: int = 2048
    # PPO.
    num_steps: int = 2_000_000
    rollout: int = 16
    batch: int = 512
    gamma: float = 0.95
    gae_lambda: float = 0.9
    deviation: float = math.exp(-2)  #: Initial standard deviation of actions.
    reward_widths: tuple[float, ...] = (1.0, 4.0, 16.0)  #: `widths` of taxelsim.envs.Reward.
    # Learning curves.
    validation_interval: int = 100_000  #: Environment steps.
    num_validations: int = 100  #: Episodes.


@dataclass(frozen=True, kw_only=True)
class DynamicRecipe(PpoSettings):
    """Settings of one task with dynamics."""

    rollout: int = 32
    batch: int = 1024
    gamma: float = 0.98
    gae_lambda: float = 0.95
    deviation: float = 0.4  #: Initial standard deviation of actions.


_FOLLOW = Recipe(linear_scale=0.03, num_demonstrations=4000)

RECIPES = {
    "EdgeFollow": _FOLLOW,
    "SurfaceFollow": _FOLLOW,
    "EdgeAlign": Recipe(linear_scale=0.02),
    "RollTrack": Recipe(linear_scale=0.08),
    "ContourLap": Recipe(linear_scale=0.06),
}


DYNAMIC_RECIPES = {
    "Push": DynamicRecipe(num_steps=1_000_000, rollout=16, batch=512),
    "Roll": DynamicRecipe(num_steps=1_000_000),
    "GraspHold": DynamicRecipe(num_steps=600_000),
    "PegInsert": DynamicRecipe(num_steps=400_000),
}


def recipe_of(task: str, **changes: Any) -> Recipe:
    """Recipe of a task with some settings replaced."""
    return replace(RECIPES[task], **changes)


def ppo_settings(task: str, name: str = "ppo") -> dict[str, Any]:
    """Arguments that TactileVectorEnv and taxelsim.policies.Policy share. Action 1 is the limit of the scene's servo.

    name: of the policy. Those of CONTROLS see that observation instead of the features.
    """
    observations = tuple(CONTROLS.get(name, seen) if seen == "features" else seen for seen in PPO_OBSERVATIONS)
    return {"observations": observations, "actions": TASKS[task].actions, "history": HISTORY, "normalized": True}


def clone_settings(task: str, recipe: Recipe) -> dict[str, Any]:
    """The same for the clone."""
    scales = {"linear_scale": recipe.linear_scale, "angular_scale": recipe.angular_scale}
    return {**ppo_settings(task), "observations": OBSERVATIONS, **scales}
