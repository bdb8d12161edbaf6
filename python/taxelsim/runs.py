"""Runs over all episodes of a scene: data sets and evaluations."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from . import _core
from ._core import Device, Evaluation, GenerateResult, GraspEvaluation, OutputOptions, Progress, Scene
from .errors import InputError
from .policies.failures import check_failures, failed_episodes
from .policies.policy import PolicyCalls, PolicyLike, as_policy

ScenePath = Scene | str | os.PathLike[str]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended evaluate() or evaluate_grasp()."""

    def __init__(self, partial: Sequence[Any] = ()) -> None:
        super().__init__("the evaluation was interrupted")
        self.partial = list(partial)  #: Evaluations of the policy and the controllers, or of the gains, that were complete, in their order.


def loaded_scene(scene: ScenePath) -> Scene:
    """The scene, read from its file unless it is one."""
    return scene if isinstance(scene, Scene) else _core.load_scene(os.fspath(scene))


def as_names(names: str | Sequence[str]) -> list[str]:
    """The names as a list; a text is one name."""
    return [names] if isinstance(names, str) else list(names)


def policy_calls(policy: PolicyLike | None, scene: Scene) -> PolicyCalls | None:
    """The calls of the policy in the scene."""
    return None if policy is None else PolicyCalls(as_policy(policy), scene)


def policy_argument(calls: PolicyCalls | None) -> tuple[str, str, bool, OutputOptions, PolicyCalls] | None:
    """The argument `policy` of runs in C++."""
    return None if calls is None else (calls.policy.name, calls.policy.identity, calls.by_joints, calls.outputs, calls)


def reload_scene(file: os.PathLike[str], num_episodes: int, seed: int, condition: str) -> Scene:
    """Unpickles a scene: reads its file again."""
    return _core.load_scene(file, num_episodes, seed, condition)


def generate(
    scene: ScenePath,
    out: str | os.PathLike[str],
    *,
    policy: PolicyLike | None = None,
    episodes: Iterable[int] | None = None,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
    repair: bool = False,
    shards: range | None = None,
) -> GenerateResult:
    """Simulates and writes all episodes of the scene that the directory `out` lacks.

    scene: a Scene, or the path of a scene file.
    policy: acts instead of the scene's controllers; a taxelsim.Policy with an identity, or the path of an ONNX file. Called in this thread.
    episodes: numbers of the episodes, all different, in the order of the data set; each has the frames that it has in the whole data set.
        Such a data set resumes with the same numbers only. Default: all episodes of the scene.
    device: default Device.open().
    batch_size: instances over all slices, >= 1. Neither it nor `num_slices` changes a byte of the data set.
    on_progress: called a few times a second, in the calling thread. If it raises, the run stops and the exception continues.
    repair: whether to make damaged shards, and shards of another data set, again; without it they raise InputError.
    shards: numbers of the shards to make, a range with step 1 that is not empty, in a directory that other processes may write at the same
        time; finish() completes the data set. Shards that another process has claimed are awaited. Default: the whole data set.

    Ctrl-C stops the run and raises KeyboardInterrupt; complete shards are kept, and the same call resumes.
    """
    loaded = loaded_scene(scene)
    chosen = [] if episodes is None else [int(number) for number in episodes]
    if episodes is not None and not chosen:
        raise InputError("episodes: none found, at least 1 needed")
    if shards is not None and (shards.step != 1 or not 0 <= shards.start < shards.stop):
        raise InputError(f"shards: {shards} is not allowed: a range of one number or more with step 1, from 0")
    limits = None if shards is None else (shards.start, shards.stop)
    argument = policy_argument(policy_calls(policy, loaded))
    opened = device or Device.open()
    return _core.generate(opened, loaded, os.fspath(out), batch_size, num_slices, on_progress, argument, chosen, repair, limits)


def finish(out: str | os.PathLike[str], *, card: bool = False, license_id: str = "unknown") -> None:
    """Completes a data set whose shards were made by generate(shards=...): verifies all bytes and writes dataset.h5 and dataset.checksums.

    card: whether to write README.md as well, the card of the data set for the Hugging Face Hub, unless there is one.
    license_id: of the card, as the Hub names licences, such as "cc-by-4.0".

    InputError names missing and broken shards; IoError says that another process is still writing. May be repeated. Ctrl-C stops it.
    """
    from .report.card import checked_license, write_card  # which use this module

    checked_license(license_id)
    _core.finish(os.fspath(out))
    if card:
        write_card(Path(out), license_id)


def evaluate(
    scene: ScenePath,
    controllers: str | Sequence[str] = (),
    *,
    policy: PolicyLike | None = None,
    save_failures: str | os.PathLike[str] | None = None,
    max_failures: int = 64,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
) -> list[Evaluation]:
    """Plays the same episodes of the scene with a policy and with controllers of the scene, and judges them by the scene's task.

    scene: a Scene, or the path of a scene file.
    controllers: a name, or names, as in the scene; empty for all, or for none if there is a policy.
    policy: any function of a batch of observations, a taxelsim.Policy, or the path of an ONNX file. Its Evaluation is the first. Called in
        this thread; an exception that it raises ends the run and continues.
    save_failures: new or empty directory for a data set of the first `max_failures` episodes in which the policy fails, for
        `taxelsim render` and taxelsim.Dataset. Not made if the policy always succeeds. They are played again after the evaluation, and have
        the same frames and verdicts, bit for bit.
    device, batch_size, num_slices, on_progress: as in generate(); none of them changes a verdict.

    Ctrl-C raises Interrupted, a KeyboardInterrupt; its `partial` has the evaluations that are complete.
    """
    names = as_names(controllers)
    loaded, calls = _with_policy(scene, policy, save_failures, max_failures)
    opened = device or Device.open()
    complete: list[Evaluation] = []
    try:
        complete += _core.evaluate(opened, loaded, names, batch_size, num_slices, on_progress, policy_argument(calls), complete)
        _keep_failures(complete, loaded, calls, save_failures, max_failures, opened, batch_size)
    except KeyboardInterrupt as interrupt:
        raise Interrupted(complete) from interrupt
    return complete


def evaluate_grasp(
    scene: ScenePath,
    gains: Sequence[float] = (),
    *,
    policy: PolicyLike | None = None,
    save_failures: str | os.PathLike[str] | None = None,
    max_failures: int = 64,
    device: Device | None = None,
    batch_size: int = 256,
    on_progress: Callable[[Progress], object] | None = None,
) -> list[GraspEvaluation]:
    """Plays the same episodes of a scene of kind grasp with a policy and with gains of its force control, and judges every finger.

    scene: a Scene, or the path of a scene file. InputError for a scene of another kind.
    gains: 1/s, > 0 to the simulation rate of the scene; empty for the gain of the scene, or for none if there is a policy.
    policy, save_failures, max_failures: as in evaluate(). The policy moves the joints instead of the law of the scene.
    device: default Device.open().
    batch_size: instances of the hand, >= 1. It does not change a verdict.
    on_progress: as in generate(); Progress.num_episodes counts the episodes of all gains.

    Submits, waits, and releases the GIL. Ctrl-C raises Interrupted, a KeyboardInterrupt; its `partial` has the gains that are complete.
    """
    loaded, calls = _with_policy(scene, policy, save_failures, max_failures)
    numbers = [float(gain) for gain in gains]
    opened = device or Device.open()
    complete: list[GraspEvaluation] = []
    try:
        complete += _core.evaluate_grasp(opened, loaded, numbers, batch_size, on_progress, policy_argument(calls), complete)
        _keep_failures(complete, loaded, calls, save_failures, max_failures, opened, batch_size)
    except KeyboardInterrupt as interrupt:
        raise Interrupted(complete) from interrupt
    return complete


def _with_policy(
    scene: ScenePath, policy: PolicyLike | None, save_failures: str | os.PathLike[str] | None, max_failures: int
) -> tuple[Scene, PolicyCalls | None]:
    """The scene and the calls of the policy in it. Raises InputError if failures could not be kept."""
    loaded = loaded_scene(scene)
    calls = policy_calls(policy, loaded)
    if save_failures is not None:
        if calls is None:
            raise InputError("save_failures: keeps failed episodes of a policy, and there is no policy")
        check_failures(loaded, Path(save_failures), max_failures)
    return loaded, calls


def _keep_failures(
    complete: Sequence[Evaluation] | Sequence[GraspEvaluation],
    scene: Scene,
    calls: PolicyCalls | None,
    save_failures: str | os.PathLike[str] | None,
    max_failures: int,
    device: Device,
    batch_size: int,
) -> None:
    if save_failures is None or calls is None:
        return
    failed = failed_episodes(complete[0])[:max_failures]
    if len(failed):
        generate(scene, save_failures, policy=calls.checked_policy(), episodes=failed, device=device, batch_size=batch_size)
