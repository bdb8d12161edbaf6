"""Runs over all episodes of a scene: data sets and evaluations."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from . import _core
from ._core import Device, Evaluation, GenerateResult, Progress, Scene
from .policies.policy import PolicyCalls, PolicyLike, as_policy

ScenePath = Scene | str | os.PathLike[str]


def _loaded(scene: ScenePath) -> Scene:
    return scene if isinstance(scene, Scene) else _core.load_scene(os.fspath(scene))


def _calls(policy: PolicyLike | None, scene: Scene) -> tuple[str, str, bool, PolicyCalls] | None:
    if policy is None:
        return None
    calls = PolicyCalls(as_policy(policy), scene)
    return calls.policy.name, calls.policy.identity, calls.by_joints, calls


def reload_scene(file: os.PathLike[str], num_episodes: int, seed: int, condition: str) -> Scene:
    """Unpickles a scene: reads its file again."""
    return _core.load_scene(file, num_episodes, seed, condition)


def generate(
    scene: ScenePath,
    out: str | os.PathLike[str],
    *,
    policy: PolicyLike | None = None,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
) -> GenerateResult:
    """Simulates and writes all episodes of the scene that the directory `out` lacks.

    scene: a Scene, or the path of a scene file.
    policy: acts instead of the scene's controllers; a taxelsim.Policy with an identity, or the path of an ONNX file. Called in this thread.
    device: default Device.open().
    batch_size: instances over all slices, >= 1. Neither it nor `num_slices` changes a byte of the data set.
    on_progress: called a few times a second, in the calling thread. If it raises, the run stops and the exception continues.

    Ctrl-C stops the run and raises KeyboardInterrupt; complete shards are kept, and the same call resumes.
    """
    loaded = _loaded(scene)
    return _core.generate(device or Device.open(), loaded, os.fspath(out), batch_size, num_slices, on_progress, _calls(policy, loaded))


def evaluate(
    scene: ScenePath,
    controllers: Sequence[str] = (),
    *,
    policy: PolicyLike | None = None,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
) -> list[Evaluation]:
    """Plays the same episodes of the scene with a policy and with controllers of the scene, and judges them by the scene's task.

    scene: a Scene, or the path of a scene file.
    controllers: names as in the scene; empty for all, or for none if there is a policy.
    policy: any function of a batch of observations, a taxelsim.Policy, or the path of an ONNX file. Its Evaluation is the first. Called in
        this thread; an exception that it raises ends the run and continues.
    device, batch_size, num_slices, on_progress: as in generate(); none of them changes a verdict.
    """
    loaded = _loaded(scene)
    return _core.evaluate(device or Device.open(), loaded, list(controllers), batch_size, num_slices, on_progress, _calls(policy, loaded))
