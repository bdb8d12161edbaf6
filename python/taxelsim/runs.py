"""Runs over all episodes of a scene: data sets and evaluations."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from . import _core
from ._core import Device, Evaluation, GenerateResult, Progress, Scene

ScenePath = Scene | str | os.PathLike[str]


def _loaded(scene: ScenePath) -> Scene:
    return scene if isinstance(scene, Scene) else _core.load_scene(os.fspath(scene))


def reload_scene(file: os.PathLike[str], num_episodes: int, seed: int) -> Scene:
    """Unpickles a scene: reads its file again."""
    return _core.load_scene(file, num_episodes, seed)


def generate(
    scene: ScenePath,
    out: str | os.PathLike[str],
    *,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
) -> GenerateResult:
    """Simulates and writes all episodes of the scene that the directory `out` lacks.

    scene: a Scene, or the path of a scene file.
    device: default Device.open().
    batch_size: instances over all slices, >= 1. Neither it nor `num_slices` changes a byte of the data set.
    on_progress: called a few times a second, in the calling thread. If it raises, the run stops and the exception continues.

    Ctrl-C stops the run and raises KeyboardInterrupt; complete shards are kept, and the same call resumes.
    """
    loaded = _loaded(scene)
    return _core.generate(device or Device.open(), loaded, os.fspath(out), batch_size, num_slices, on_progress)


def evaluate(
    scene: ScenePath,
    controllers: Sequence[str] = (),
    *,
    device: Device | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    on_progress: Callable[[Progress], object] | None = None,
) -> list[Evaluation]:
    """Plays the same episodes of the scene with each of its controllers and judges them by the scene's task.

    scene: a Scene, or the path of a scene file.
    controllers: names as in the scene; empty for all.
    device, batch_size, num_slices, on_progress: as in generate(); none of them changes a verdict.
    """
    loaded = _loaded(scene)
    return _core.evaluate(device or Device.open(), loaded, list(controllers), batch_size, num_slices, on_progress)
