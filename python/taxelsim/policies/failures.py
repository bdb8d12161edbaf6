"""Keeps failed episodes of a policy as a data set."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._core import Evaluation, GraspEvaluation, Scene
from ..errors import InputError


def check_failures(scene: Scene, folder: Path, max_failures: int) -> None:
    """Raises InputError, before anything is simulated, if the failed episodes of the scene could not be kept in `folder`."""
    if max_failures < 1:
        raise InputError(f"max_failures: {max_failures} is not allowed: at least 1")
    if "tactile_image" not in scene.record:
        raise InputError(f"{scene.file}: record: tactile_image is missing, which `taxelsim render` needs to draw failed episodes")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder}: failed episodes need a new or an empty directory")


def failed_episodes(evaluation: Evaluation | GraspEvaluation) -> NDArray[np.uint64]:
    """Numbers of the failed episodes, in their order."""
    verdicts = evaluation.verdicts
    failed: NDArray[np.uint64] = verdicts["episode"][~verdicts["success"]]
    return failed
