"""The networks of the clone and of PPO, and their ONNX files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
from onnx import helper
from torch import nn

from taxelsim.policies import FEATURES, Policy

from .recipe import HISTORY, OBSERVATIONS, PPO_OBSERVATIONS, TACTILE

# Factors on normalised observations, so that inputs are of the order of 1.
FEATURE_FACTORS = {"total_force": 0.5, "peak_force": 5.0, "edge_confidence": 2.0, "contact_area": 0.25}
NUM_FORCES = 2  # the first features: total and peak force
IMAGE_FACTOR = 10.0
POSE_FACTORS = (0.3, 0.3, 20.0, 1.0, 1.0, 1.0, 1.0)  # z: 0.1 mm of depth is 0.2
CONTACT_FACTORS = (1.0, 1.0, 1.0, 0.5, 0.5, 0.5)
LIMIT = 5.0  # of an input
TYPICAL_FORCE, LEAST_FORCE = 3.0, 0.2  # N


def _factors(name: str, size: int) -> np.ndarray:
    if name == "features":
        return np.array([FEATURE_FACTORS.get(feature, 1.0) for feature, count, _ in FEATURES for _ in range(count)])
    if name == "tactile_image":
        return np.full(size, IMAGE_FACTOR)
    factors = np.ones(size)
    known = POSE_FACTORS if name == "proprioception" else CONTACT_FACTORS
    factors[: len(known)] = known
    return factors


def _frames(name: str) -> Sequence[int]:
    """Frames of the history that the network uses, 0 is the oldest."""
    return {"features": range(HISTORY), "proprioception": (0, HISTORY - 1)}.get(name, (HISTORY - 1,))


class PpoInputs(nn.Module):
    """Observations (N, HISTORY x all values), joined in the order of `names`, as they are; blind: the tactile ones are 0."""

    def __init__(self, sizes: Mapping[str, int], names: Sequence[str] = PPO_OBSERVATIONS, blind: bool = False) -> None:
        super().__init__()
        seen = [np.full(HISTORY * sizes[name], not (blind and name in TACTILE)) for name in names]
        self.register_buffer("seen", torch.as_tensor(np.concatenate(seen), dtype=torch.float32))
        self.num_observed = self.num_inputs = len(self.seen)

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        return observation * self.seen


class Inputs(nn.Module):
    """Observations (N, HISTORY x all values), joined in the order of OBSERVATIONS, to inputs (N, num_inputs) of the order of 1.

    Forces of the image and of the features are divided by the measured force of the start, so that a gain that all taxels share cancels.
    sizes: values of one frame, by name.
    """

    def __init__(self, sizes: Mapping[str, int]) -> None:
        super().__init__()
        columns, factors, relative, first = [], [], [], 0
        for name in OBSERVATIONS:
            size = sizes[name]
            for frame in _frames(name):
                columns.append(first + frame * size + np.arange(size))
                factors.append(_factors(name, size))
                forces = np.arange(size) < NUM_FORCES if name == "features" else np.full(size, name == "tactile_image")
                relative.append(forces)
            if name == "start_contact":
                self.start_force = first + HISTORY * size - 1  # column of the z component
            first += HISTORY * size
        self.register_buffer("columns", torch.as_tensor(np.concatenate(columns)))
        self.register_buffer("factors", torch.as_tensor(np.concatenate(factors), dtype=torch.float32))
        self.register_buffer("relative", torch.as_tensor(np.concatenate(relative), dtype=torch.float32))
        self.num_observed, self.num_inputs = first, len(self.columns)

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        chosen = torch.index_select(observation, 1, self.columns)
        start = torch.clamp(-observation[:, self.start_force : self.start_force + 1], min=LEAST_FORCE)
        scale = 1 + self.relative * (TYPICAL_FORCE / start - 1)
        return torch.clamp(chosen * self.factors * scale, -LIMIT, LIMIT)


def joined(observation: Mapping[str, torch.Tensor], names: Sequence[str]) -> torch.Tensor:
    """Observations by name, (N, ...) each, as one tensor (N, values), as an ONNX policy with one input gets them."""
    return torch.cat([observation[name].flatten(1) for name in names], dim=1)


def hidden_layers(num_inputs: int, widths: Sequence[int]) -> nn.Sequential:
    """Layers of tanh."""
    layers: list[nn.Module] = []
    for size, width in zip((num_inputs, *widths), widths, strict=False):
        layers += [nn.Linear(size, width), nn.Tanh()]
    return nn.Sequential(*layers)


class Actor(nn.Module):
    """Observations to actions. `inputs`, `hidden` and `action` may come from a policy of Stable-Baselines3."""

    def __init__(self, inputs: Inputs | PpoInputs, hidden: nn.Module, action: nn.Module) -> None:
        super().__init__()
        self.inputs, self.hidden, self.action = inputs, hidden, action

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        return torch.clamp(self.action(self.hidden(self.inputs(observation))), -1.0, 1.0)


def new_actor(inputs: Inputs, widths: Sequence[int], num_actions: int) -> Actor:
    """An actor with random weights."""
    return Actor(inputs, hidden_layers(inputs.num_inputs, widths), nn.Linear(widths[-1], num_actions))


def as_policy(actor: Actor, name: str, settings: Mapping[str, Any]) -> Policy:
    """The actor as it is now, as a policy of taxelsim."""

    def act(observation: Mapping[str, np.ndarray]) -> np.ndarray:
        with torch.no_grad():
            tensors = {key: torch.as_tensor(values, dtype=torch.float32) for key, values in observation.items()}
            return actor(joined(tensors, settings["observations"])).numpy()

    # Unchecked: the validation of a curve may differ in its last bits. The evaluation of the ONNX file is checked.
    return Policy(act, name=name, check_batch=False, **settings)


def write_onnx(actor: Actor, file: Path, settings: Mapping[str, Any]) -> None:
    """Writes the actor with the settings that `taxelsim evaluate` reads from the file."""
    actor = actor.eval()
    example = torch.zeros(2, actor.inputs.num_observed)
    batch = torch.export.Dim("batch")
    torch.onnx.export(
        actor,
        (example,),
        str(file),
        input_names=["observation"],
        output_names=["action"],
        dynamic_shapes=({0: batch},),
        dynamo=True,
        external_data=False,
        verbose=False,
    )
    model = onnx.load(str(file))
    helper.set_model_props(model, {f"taxelsim.{key}": setting_text(value) for key, value in settings.items()})
    onnx.save(model, str(file))


def setting_text(value: Any) -> str:
    """A setting as the metadata of an ONNX policy has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return ",".join(value) if isinstance(value, tuple) else str(value)
