"""What runs on the nodes: plays the episodes of a task."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass

from .._core import Progress
from ..errors import InputError
from ..parts import EvaluationPart, evaluate_part
from .node import Job, Outcome, outcomes, policy_of, scene_and_device


@dataclass(frozen=True)
class EpisodeJob(Job):
    """Episodes of an evaluation."""

    controllers: tuple[str, ...] = ()
    gains: tuple[float, ...] = ()  #: Of a scene of kind grasp.
    kind: tuple[str, ...] = ()  #: kind_of() the first part; empty until there is one.


@dataclass(frozen=True)
class Played:
    """Judged episodes."""

    part: EvaluationPart
    setup_seconds: float  #: s outside of the simulation: device, kernels, probe.
    seconds: float  #: s of the simulation.


def kind_of(part: EvaluationPart) -> tuple[str, str]:
    """Device and probe: machines that compute the same values have the same."""
    content = json.loads(part.to_json())
    return content["device"], content["probe_sha256"]


def play_episodes(job: EpisodeJob, episodes: range) -> Outcome:
    """Plays and judges a range of episodes. Waits for the last."""
    found: list[Outcome] = []
    with outcomes(found) as node:
        found.append(Outcome(node, value=_played(job, episodes)))
    return found[0]


def _played(job: EpisodeJob, episodes: range) -> Played:
    begin, seconds = os.times().elapsed, 0.0

    def on_progress(progress: Progress) -> None:
        nonlocal seconds
        seconds = progress.seconds

    scene, device = scene_and_device(job)
    part = evaluate_part(
        scene,
        job.controllers,
        episodes=episodes,
        gains=job.gains,
        policy=policy_of(job),
        device=device,
        batch_size=job.batch_size,
        num_slices=job.num_slices,
        on_progress=on_progress,
    )
    kind = kind_of(part)
    if job.kind and kind != job.kind:
        there = "; ".join(job.kind)
        raise InputError(f"this node computes other values: {'; '.join(kind)} here, {there} in the evaluation (device; probe_sha256)")
    return Played(part, os.times().elapsed - begin - seconds, seconds)
