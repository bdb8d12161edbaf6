"""Evaluations in parts: each process or machine plays a range of the episodes of a scene."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from . import _core
from ._core import Device, Evaluation, GraspEvaluation, Progress, Scene
from ._files import write_whole
from .errors import InputError
from .policies.policy import PolicyLike, as_policy
from .runs import ScenePath, as_names, loaded_scene, policy_argument, policy_calls

MAX_HANDS = 256
"""Instances of a hand at a time."""


class EvaluationPart:
    """Verdicts of a range of episodes, with what identifies scene, seed, condition, program version, device and policy.

    Made by evaluate_part(), from_json() or load(). May be pickled. Equal parts have equal content.
    """

    def __init__(self, core: _core.EvaluationPart) -> None:
        self._core = core

    @property
    def episodes(self) -> range:
        """Numbers of the episodes."""
        return range(*self._core.episodes)

    @property
    def controllers(self) -> list[str]:
        """Names of the policy, if any, and of the controllers."""
        return self._core.controllers

    @property
    def policy(self) -> str:
        """Identity of the policy. Empty without a policy, and for a policy without an identity: such policies are compared by name only."""
        return self._core.policy

    @property
    def device(self) -> str:
        """Name and driver of the device."""
        return self._core.device

    def to_json(self) -> str:
        """The part as text, with a SHA-256 of its content (docs/reference/other_files.md)."""
        return self._core.text()

    @classmethod
    def from_json(cls, text: str, name: str = "part") -> EvaluationPart:
        """The part of such a text. name: for messages. InputError for other, damaged and altered text."""
        return cls(_core.parse_evaluation_part(text, name))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the text to a file, which never has half of it."""
        write_whole(Path(file), self.to_json().encode())

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> EvaluationPart:
        """Reads a part from a file. Raises what from_json() raises, and InputError if there is no such file."""
        try:
            text = Path(file).read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{os.fspath(file)}: cannot be read as part of an evaluation ({error})") from error
        return cls.from_json(text, os.fspath(file))

    def check(
        self,
        scene: ScenePath,
        controllers: str | Sequence[str] = (),
        *,
        gains: Sequence[float] = (),
        policy: PolicyLike | None = None,
        device: Device | None = None,
        name: str = "part",
    ) -> None:
        """Raises InputError, which begins with `name`, unless it is a part of an evaluation with these arguments by this program version.

        device: default any. Whether it computes the same values is not checked here, but by merge_evaluations().
        """
        loaded = loaded_scene(scene)
        _core.check_evaluation_part(name, self._core, loaded)
        played = None if policy is None else as_policy(policy)
        expected = ([] if played is None else [played.name]) + _names(loaded, controllers, gains, played is None)
        pairs = [("policy", self.policy or "none", (played and played.identity) or "none")]
        pairs.append(("set of controllers", ", ".join(self.controllers), ", ".join(expected)))
        if device is not None:
            pairs.append(("device", self.device, f"{device.info.name}, {device.info.driver}"))
        for what, found, wanted in pairs:
            if found != wanted:
                raise InputError(f"{name}: has another {what} ({found} there, {wanted} expected)")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, EvaluationPart) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __reduce__(self) -> tuple[Callable[[str], EvaluationPart], tuple[str]]:
        return EvaluationPart.from_json, (self.to_json(),)

    def __repr__(self) -> str:
        return f"<taxelsim.EvaluationPart: episodes {self.episodes.start} to {self.episodes.stop - 1}, {', '.join(self.controllers)}>"


def check_players(scene: Scene, controllers: str | Sequence[str], gains: Sequence[float]) -> None:
    """Raises InputError for controllers of a scene of kind grasp, and for gains of another."""
    if scene.kind == Scene.Kind.GRASP and controllers:
        raise InputError(f"{scene.file}: controllers are not allowed in a scene of kind grasp: gains")
    if scene.kind != Scene.Kind.GRASP and len(gains):
        raise InputError(f"{scene.file}: gains are for scenes of kind grasp: the controllers of this scene have their gains")


def _names(scene: Scene, controllers: str | Sequence[str], gains: Sequence[float], with_defaults: bool) -> list[str]:
    """Names of the controllers, or of the gains of a scene of kind grasp; with_defaults: of the scene's own if none are given."""
    if scene.kind != Scene.Kind.GRASP:
        return as_names(controllers or (scene.controllers if with_defaults else ()))
    return [_core.gain_name(float(gain)) for gain in gains or ([_core.grasp_gain_of(scene)] if with_defaults else [])]


def evaluate_part(
    scene: ScenePath,
    controllers: str | Sequence[str] = (),
    *,
    episodes: range,
    gains: Sequence[float] = (),
    policy: PolicyLike | None = None,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
) -> EvaluationPart:
    """Plays some episodes of evaluate(), or in a scene of kind grasp of evaluate_grasp(), for merge_evaluations().

    episodes: numbers of the episodes, a range with step 1 that is not empty, within the episodes of the scene.
    Other arguments: as of evaluate() and evaluate_grasp().

    Ctrl-C raises KeyboardInterrupt; there is no part then.
    """
    loaded = loaded_scene(scene)
    if episodes.step != 1 or not 0 <= episodes.start < episodes.stop <= loaded.num_episodes:
        raise InputError(
            f"episodes: {episodes} is not allowed: a range of one number or more with step 1 within {range(loaded.num_episodes)}"
        )
    argument = policy_argument(policy_calls(policy, loaded))
    limits = (episodes.start, episodes.stop)
    opened = device or Device.open()
    check_players(loaded, controllers, gains)
    if loaded.kind == Scene.Kind.GRASP:
        size, numbers = min(batch_size, MAX_HANDS), [float(gain) for gain in gains]
        return EvaluationPart(_core.evaluate_grasp_part(opened, loaded, numbers, limits, size, on_progress, argument))
    return EvaluationPart(_core.evaluate_part(opened, loaded, as_names(controllers), limits, batch_size, num_slices, on_progress, argument))


def merge_evaluations(
    scene: ScenePath,
    parts: Iterable[EvaluationPart | str | os.PathLike[str]],
    controllers: str | Sequence[str] = (),
    *,
    policy: PolicyLike | None = None,
) -> list[Evaluation]:
    """The evaluations of evaluate(scene, controllers, policy=policy) from parts of it, bit for bit.

    scene, controllers, policy: as they were for evaluate_part(). The policy is not called.
    parts: EvaluationPart or files, in any order, which cover all episodes of the scene. They may overlap.

    InputError names a part of another scene, condition, seed, number of episodes, program version, device, probe, policy or set of
    controllers, a damaged one, parts that contradict each other, and missing episodes.
    """
    loaded = loaded_scene(scene)
    return _core.merge_evaluation_parts(loaded, _checked_parts(loaded, parts, controllers, (), policy))


def merge_grasp_evaluations(
    scene: ScenePath,
    parts: Iterable[EvaluationPart | str | os.PathLike[str]],
    gains: Sequence[float] = (),
    *,
    policy: PolicyLike | None = None,
) -> list[GraspEvaluation]:
    """The evaluations of evaluate_grasp(scene, gains, policy=policy) from parts of it, bit for bit; as merge_evaluations()."""
    loaded = loaded_scene(scene)
    return _core.merge_grasp_parts(loaded, _checked_parts(loaded, parts, (), gains, policy))


def _checked_parts(
    scene: Scene,
    parts: Iterable[EvaluationPart | str | os.PathLike[str]],
    controllers: str | Sequence[str],
    gains: Sequence[float],
    policy: PolicyLike | None,
) -> list[tuple[str, _core.EvaluationPart]]:
    """The parts with their names in messages, checked."""
    named = []
    for number, part in enumerate(parts):
        name = f"part {number}" if isinstance(part, EvaluationPart) else os.fspath(part)
        content = part if isinstance(part, EvaluationPart) else EvaluationPart.load(part)
        content.check(scene, controllers, gains=gains, policy=policy, name=name)
        named.append((name, content._core))
    return named
