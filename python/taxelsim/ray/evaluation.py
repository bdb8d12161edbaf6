"""An evaluation by the nodes of a cluster."""

from __future__ import annotations

import dataclasses
import math
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from .._core import Evaluation, GraspEvaluation, Scene
from ..errors import InputError
from ..parts import EvaluationPart, merge_evaluations, merge_grasp_evaluations
from ..policies.policy import Policy, PolicyLike
from ..progress_line import ProgressLine
from ..runs import ScenePath, as_names, loaded_scene, policy_calls
from .cluster import Workers, connected, slots
from .episodes import EpisodeJob, Played, kind_of, play_episodes
from .node import SceneName, pickled
from .storage import Storage, is_remote
from .tasks import MAX_RETRIES, OnProgress, Tasks, check_tasks, task_length

if TYPE_CHECKING:
    from typing_extensions import Unpack

_PARTS = re.compile(r"episodes-\d{8}-\d{8}\.json")  # as `taxelsim evaluate --part` names them, both ends included


class Options(TypedDict, total=False):
    """Optional arguments of evaluate() and evaluate_grasp()."""

    policy: PolicyLike | None
    parts: str | os.PathLike[str] | None
    address: str | None
    workers: Workers | None
    num_cpus: int | None
    batch_size: int
    num_slices: int
    task_seconds: float | None
    max_retries: int
    storage_options: Mapping[str, Any] | None
    on_progress: OnProgress | None


def evaluate(scene: ScenePath, controllers: str | Sequence[str] = (), **options: Unpack[Options]) -> list[Evaluation]:
    """Plays and judges the episodes of taxelsim.evaluate() on a Ray cluster. Waits for all. Returns the same evaluations, bit for bit.

    scene, controllers: as of taxelsim.evaluate(). The nodes read the scene from the same path; scenes of the package may be elsewhere.
    policy: as of taxelsim.evaluate(). It is pickled; an ONNX file is read by the nodes from the same path. Each task begins with the policy
        in the state that it has here. It computes on the processors of the nodes: equal ones give equal values.
    parts: a directory of this machine, or an address of fsspec, that keeps the verdicts of each task as this process receives them. The
        same call then resumes, and `taxelsim evaluate --merge` reads them from a directory. Default: nothing is kept.
    address, workers, num_cpus, batch_size, num_slices, task_seconds, max_retries: as of taxelsim.ray.generate().
    storage_options: of fsspec, for `parts`.
    on_progress: called with (episodes done, episodes of the scene) as tasks end. Default: one line on stderr.

    Raises InputError for bad input and for parts that are damaged or of another evaluation, and if all nodes compute other values than the
    first part has; IoError as taxelsim.ray.generate(); what the policy raises. Ctrl-C raises KeyboardInterrupt.
    """
    loaded = loaded_scene(scene)
    if loaded.kind == Scene.Kind.GRASP:
        raise InputError(f"{loaded.file}: a scene of kind grasp is not allowed: taxelsim.ray.evaluate_grasp()")
    if not loaded.has_task:
        raise InputError(f"{loaded.file}: has no task by which episodes could be judged")
    names = as_names(controllers)
    for name in names:
        if name not in loaded.controllers:
            raise InputError(f"controllers: {name} is not allowed: the scene has {', '.join(loaded.controllers)}")
    played, policy = _played(loaded, names, (), **options)
    return merge_evaluations(loaded, played, names, policy=policy)


def evaluate_grasp(scene: ScenePath, gains: Sequence[float] = (), **options: Unpack[Options]) -> list[GraspEvaluation]:
    """The same as evaluate() for taxelsim.evaluate_grasp(): scene and gains are as there, the options and errors as of evaluate()."""
    loaded = loaded_scene(scene)
    if loaded.kind != Scene.Kind.GRASP:
        raise InputError(f"{loaded.file}: a scene of kind grasp is needed: taxelsim.ray.evaluate()")
    numbers = tuple(float(gain) for gain in gains)
    played, policy = _played(loaded, (), numbers, **options)
    return merge_grasp_evaluations(loaded, played, numbers, policy=policy)


def _played(
    scene: Scene,
    controllers: Sequence[str],
    gains: Sequence[float],
    *,
    policy: PolicyLike | None = None,
    parts: str | os.PathLike[str] | None = None,
    address: str | None = None,
    workers: Workers | None = None,
    num_cpus: int | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    task_seconds: float | None = None,
    max_retries: int = MAX_RETRIES,
    storage_options: Mapping[str, Any] | None = None,
    on_progress: OnProgress | None = None,
) -> tuple[list[EvaluationPart], Policy | None]:
    """Parts of all episodes, and the policy of them."""
    needs = workers or Workers()
    check_tasks(task_seconds, max_retries, batch_size, num_slices)
    needs.needs()
    calls = policy_calls(policy, scene)
    chosen = None if calls is None else calls.policy
    job = EpisodeJob(
        scene=SceneName.of(scene),
        threads=needs.threads,
        policy=pickled(chosen),
        batch_size=batch_size,
        num_slices=num_slices,
        controllers=tuple(controllers),
        gains=tuple(gains),
    )
    store = None if parts is None else _Store(os.fspath(parts), storage_options or {})
    found = store.load() if store else {}
    for name, part in found.items():
        part.check(scene, controllers, gains=gains, policy=chosen, name=name)
    line = ProgressLine("episodes")
    run = _Run(scene, job, Tasks(play_episodes, needs, max_retries), on_progress or line.show, store, list(found.values()))
    if run.missing():
        with connected(address, num_cpus):
            try:
                run.complete(task_seconds)
            finally:
                line.end()
    return run.parts, chosen


class _Store:
    """Parts by name in a directory, or where fsspec reaches."""

    def __init__(self, where: str, options: Mapping[str, Any]) -> None:
        self._where = where
        self._storage = Storage(where, options, _PARTS) if is_remote(where) else None
        self._folder = Path(where.partition("://")[2] or where)

    def load(self) -> dict[str, EvaluationPart]:
        """The parts that are there, by their names in messages."""
        if self._storage is None:
            try:
                self._folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InputError(f"parts: {self._folder}: {error.strerror}") from error
            names = sorted(file.name for file in self._folder.iterdir() if _PARTS.fullmatch(file.name))
            return {str(self._folder / name): EvaluationPart.load(self._folder / name) for name in names}
        texts = {f"{self._where}/{name}": self._storage.read(name) for name in sorted(self._storage.sizes())}
        return {name: EvaluationPart.from_json(text.decode("utf-8", "replace"), name) for name, text in texts.items() if text is not None}

    def save(self, part: EvaluationPart) -> None:
        name = f"episodes-{part.episodes.start:08}-{part.episodes.stop - 1:08}.json"
        if self._storage is None:
            part.save(self._folder / name)
        else:
            self._storage.upload_text(name, part.to_json().encode())


class _Run:
    def __init__(
        self, scene: Scene, job: EpisodeJob, tasks: Tasks[range], on_progress: OnProgress, store: _Store | None, found: list[EvaluationPart]
    ) -> None:
        self.parts = found
        self._scene = scene
        self._job = job
        self._tasks = tasks
        self._on_progress = on_progress
        self._store = store
        self._num_done = scene.num_episodes - sum(map(len, self.missing()))
        self._last: Played | None = None

    def missing(self) -> list[range]:
        """Episodes that no part has."""
        return gaps(self._scene.num_episodes, [part.episodes for part in self.parts])

    def complete(self, task_seconds: float | None) -> None:
        # One task runs alone: its time per episode sets the size of the others. Without parts, its device and probe are those of all.
        first = self.missing()[0][: self._scene.episodes_per_shard]
        self._send([first])
        self._send(self._split(task_seconds))

    def _send(self, ranges: list[range]) -> None:
        job = dataclasses.replace(self._job, kind=kind_of(self.parts[0])) if self.parts else self._job
        self._tasks.run(job, ranges, self._done)

    def _done(self, episodes: range, played: Played) -> None:
        self._last = played
        self.parts.append(played.part)
        if self._store:
            self._store.save(played.part)
        self._num_done += len(episodes)
        self._on_progress(self._num_done, self._scene.num_episodes)

    def _split(self, task_seconds: float | None) -> list[range]:
        """Ranges of about `task_seconds`, by the time of the first task."""
        last, missing = self._last, self.missing()
        assert last is not None
        seconds = task_length(task_seconds, last.setup_seconds)
        size = round(seconds * len(last.part.episodes) / max(last.seconds, 1e-3))
        fair = math.ceil(sum(map(len, missing)) / max(1, slots(self._tasks.workers, self._tasks.refused)))
        size = max(1, min(size, fair))
        return [gap[k : k + size] for gap in missing for k in range(0, len(gap), size)]


def gaps(num_episodes: int, played: Sequence[range]) -> list[range]:
    """Ranges of the numbers of episodes that are in no range of `played`."""
    found, next_one = [], 0
    for episodes in sorted(played, key=lambda episodes: episodes.start):
        if episodes.start > next_one:
            found.append(range(next_one, episodes.start))
        next_one = max(next_one, episodes.stop)
    return [*found, range(next_one, num_episodes)] if next_one < num_episodes else found
