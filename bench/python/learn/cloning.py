"""Behaviour cloning: a network fitted to a data set of the scripted servo that `taxelsim generate` wrote."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import torch

import taxelsim
from taxelsim.envs import ACTIONS, SCALES
from taxelsim.policies import FEATURES
from taxelsim.tasks import TASKS

from .network import Actor, Inputs, new_actor, write_onnx
from .recipe import DEMONSTRATION_SEED, HISTORY, NUM_THREADS, OBSERVATIONS, TRAINING_CONDITION, Recipe, clone_settings

SERVO = 0  # index of the cloned controller in the scene
VALIDATION_PART = 0.1  # of the demonstrations, by episode


def chosen_episodes(data: taxelsim.Dataset) -> np.ndarray:
    """(num_episodes) bool: successful episodes of the servo."""
    chosen: np.ndarray = (data["meta/controller"][:] == SERVO) & (data["meta/success"][:] == 1)
    return chosen


class Demonstrations:
    """Frames of the `chosen` episodes of a data set: observations by name (frames, values), normalised, and actions (frames, actions).

    saturation: counts, of the sensor.
    """

    def __init__(self, data: taxelsim.Dataset, chosen: np.ndarray, task: str, recipe: Recipe, saturation: int) -> None:
        ends = data.episode_ends.astype(np.int64)
        firsts = np.concatenate(([0], ends[:-1]))
        self.num_episodes = int(chosen.sum())
        rows = np.concatenate([np.arange(first, end) for first, end in zip(firsts[chosen], ends[chosen], strict=True)])
        lengths = (ends - firsts)[chosen]
        self.episodes = np.repeat(np.arange(self.num_episodes), lengths)
        starts = np.concatenate(([0], np.cumsum(lengths)[:-1]))
        self.starts = np.repeat(starts, lengths)  # (frames), first frame of the episode
        names = [f"data/{name}" for name, _, _ in FEATURES]
        columns = data.frames(rows, [*names, "data/tactile_image", "data/sensor_pose", "data/action"])
        scales = np.array([SCALES[unit] for _, size, unit in FEATURES for _ in range(size)])
        features = np.hstack([columns[name].reshape(len(rows), -1) for name in names]) / scales
        force, center = features[:, :1], features[:, 2:5]
        contact = np.hstack((center, np.zeros((len(rows), 2)), -force))  # a flat skin without friction has no shear
        x, y, z, qw, qx, qy, qz = columns["data/sensor_pose"].T
        pose = np.column_stack((x / SCALES["m"], y / SCALES["m"], z / SCALES["m"], qw, qx, qy, qz))
        image = columns["data/tactile_image"].reshape(len(rows), -1) / saturation
        values = {"features": features, "tactile_image": image, "start_contact": contact[self.starts], "proprioception": pose}
        self.observations = {name: torch.as_tensor(values[name], dtype=torch.float32) for name in OBSERVATIONS}
        used = [ACTIONS.index(action) for action in TASKS[task].actions]
        limits = np.repeat([recipe.linear_scale, recipe.angular_scale], 3)
        actions = np.clip(columns["data/action"] / limits, -1, 1)[:, used]
        self.actions = torch.as_tensor(actions, dtype=torch.float32)

    def inputs(self, inputs: Inputs, part: int = 20_000) -> torch.Tensor:
        """Inputs (frames, num_inputs) of the network, computed `part` frames at a time."""
        rows = np.arange(len(self.actions))
        return torch.cat([inputs(self.observation(rows[first : first + part])) for first in range(0, len(rows), part)])

    def observation(self, rows: np.ndarray) -> torch.Tensor:
        """Observations (rows, HISTORY x values) as a policy gets them: an episode starts with copies of its first frame."""
        lags = np.arange(HISTORY - 1, -1, -1)
        frames = torch.as_tensor(np.maximum(rows[:, np.newaxis] - lags, self.starts[rows][:, np.newaxis]))
        return torch.cat([self.observations[name][frames].flatten(1) for name in OBSERVATIONS], dim=1)

    def sizes(self) -> dict[str, int]:
        """Values of one frame, by name."""
        return {name: values.shape[1] for name, values in self.observations.items()}


def generate(task: str, recipe: Recipe, folder: Path) -> None:
    """Writes the data set, or what is missing of it, by the command line."""
    scene = taxelsim.SCENES / TASKS[task].scene
    command = [sys.executable, "-m", "taxelsim", "generate", scene, "-o", folder, "--condition", TRAINING_CONDITION]
    command += ["--seed", DEMONSTRATION_SEED, "--episodes", recipe.num_demonstrations]
    subprocess.run([str(word) for word in command], check=True)


def fit(demonstrations: Demonstrations, recipe: Recipe) -> tuple[Actor, float, float]:
    """The network, and its mean squared error, relative to the variance of the actions, in training and on episodes left out."""
    torch.manual_seed(DEMONSTRATION_SEED)
    random = np.random.default_rng(DEMONSTRATION_SEED)
    left_out = demonstrations.episodes >= (1 - VALIDATION_PART) * demonstrations.num_episodes
    training, validation = np.flatnonzero(~left_out), np.flatnonzero(left_out)
    actions = demonstrations.actions
    mean, deviation = actions[training].mean(0), actions[training].std(0).clamp(min=1e-6)
    actor = new_actor(Inputs(demonstrations.sizes()), recipe.hidden, actions.shape[1])
    inputs = demonstrations.inputs(actor.inputs)
    optimizer = torch.optim.Adam(actor.parameters(), recipe.cloning_rate)
    num_batches = len(training) // recipe.cloning_batch
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, recipe.num_epochs * num_batches)

    def loss_of(rows: np.ndarray) -> torch.Tensor:
        found = actor.action(actor.hidden(inputs[rows]))
        return ((found - (actions[rows] - mean) / deviation) ** 2).mean()

    training_loss = 0.0
    for epoch in range(recipe.num_epochs):
        order = random.permutation(training)
        losses = []
        for k in range(num_batches):
            loss = loss_of(order[k * recipe.cloning_batch : (k + 1) * recipe.cloning_batch])
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            losses.append(loss.item())
        training_loss = float(np.mean(losses))
        print(f"clone: epoch {epoch + 1} of {recipe.num_epochs}, loss {training_loss:.4f}", flush=True)
    with torch.no_grad():
        validation_loss = loss_of(validation).item()
        actor.action.weight *= deviation[:, None]  # from relative to actual actions
        actor.action.bias.copy_(actor.action.bias * deviation + mean)
    return actor, training_loss, validation_loss


def clone(task: str, name: str, recipe: Recipe, folder: Path) -> None:
    """Generates demonstrations and fits the network; writes NAME.onnx and NAME.json."""
    torch.set_num_threads(NUM_THREADS)
    data_set = folder / "demonstrations"
    generate(task, recipe, data_set)
    saturation = taxelsim.load_scene(taxelsim.SCENES / TASKS[task].scene).sensor.readout.saturation
    data = taxelsim.Dataset(data_set)
    demonstrations = Demonstrations(data, chosen_episodes(data), task, recipe, saturation)
    begun = time.process_time()
    actor, training_loss, validation_loss = fit(demonstrations, recipe)
    write_onnx(actor, folder / f"{name}.onnx", clone_settings(task, recipe))
    content = {
        "num_demonstrations": demonstrations.num_episodes,
        "num_frames": len(demonstrations.actions),
        "cpu_seconds": round(time.process_time() - begun, 1),  # of the training
        "training_loss": training_loss,
        "validation_loss": validation_loss,
    }
    (folder / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")
