"""A data set made by the nodes of a cluster."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import _core
from .._core import Scene
from ..errors import InputError, IoError
from ..policies.policy import PolicyLike, as_policy
from ..progress_line import ProgressLine
from ..runs import ScenePath, finish, loaded_scene
from .cluster import Workers, connected, slots
from .node import SceneName, pickled
from .shards import Made, ShardJob, make_shards, runs_of
from .storage import ATTEMPTS, CHECKSUMS, FIRST_DELAY, MANIFEST, VIEW, Storage, is_remote, shard_name
from .tasks import MAX_RETRIES, OnProgress, Tasks, check_tasks, task_length


@dataclass(frozen=True)
class Summary:
    """Result of taxelsim.ray.generate()."""

    num_episodes: int  #: Of the data set.
    num_simulated: int  #: Episodes that this run simulated; the others were there.
    num_tasks: int
    num_retries: int  #: Tasks that were sent again.
    refused: dict[str, str]  #: Nodes that were refused, by Ray's number, with the reason.
    seconds: float  #: s, without the start of a cluster.


def generate(
    scene: ScenePath,
    out: str | os.PathLike[str],
    *,
    policy: PolicyLike | None = None,
    address: str | None = None,
    workers: Workers | None = None,
    num_cpus: int | None = None,
    batch_size: int = 2048,
    num_slices: int = 2,
    repair: bool = False,
    task_seconds: float | None = None,
    max_retries: int = MAX_RETRIES,
    storage_options: Mapping[str, Any] | None = None,
    scratch: str | os.PathLike[str] = "",
    on_progress: OnProgress | None = None,
) -> Summary:
    """Simulates and stores all episodes of the scene that `out` lacks, on a Ray cluster. Waits until the data set is complete and verified.

    The bytes are those of taxelsim.generate(), whatever nodes there are and however many are lost.

    scene: a Scene, or the path of a scene file. The nodes read it from the same path; scenes of the package may be elsewhere there.
    out: a directory that all nodes have under this path (one machine, NFS), or an address of fsspec, e.g. `s3://bucket/set`. Shards of an
        address are made in `scratch` of the node, uploaded, read back, and count when their checksum file is there.
    policy: as in taxelsim.generate(), with an identity. It is pickled; an ONNX file is read by the nodes from the same path.
    address: of a cluster to join, e.g. "auto" or "host:6379". Default: the cluster that this process is connected to, or a local one that
        ends with the call. The local one listens on loopback only; Ray's dashboard is off.
    workers: what a task needs of a node, and the kind of the nodes. Default: one processor, any node.
    num_cpus: tasks that a local cluster runs at once. Default: the logical processors.
    batch_size, num_slices, repair: as in taxelsim.generate().
    task_seconds: s, > 0, length of a task. A lost task loses unfinished shards only. Default: 10 s, or longer where the setup of a
        task would take over 3 % of that.
    max_retries: of one task, >= 0, with delays of 0.5 to 30 s between them. The storage is tried 5 times within each.
    storage_options: of fsspec, e.g. {"endpoint_url": ...}. They are sent to the nodes; leave credentials in the environment there.
    scratch: folder on the nodes for shards that are uploaded. Default: the system's folder for temporary files.
    on_progress: called with (episodes done, episodes of the data set) as tasks end. Default: one line on stderr.

    Raises InputError for bad input, for a data set that is of another scene, version or policy or has damaged shards, and if all nodes
    compute other values than the data set has; IoError if a task fails after its retries, a storage is out of reach, or no node has room
    for a task for 300 s. Ctrl-C raises KeyboardInterrupt. Complete shards are kept, and the same call resumes.
    """
    loaded, needs = loaded_scene(scene), workers or Workers()
    check_tasks(task_seconds, max_retries, batch_size, num_slices)
    needs.needs()
    chosen = None if policy is None else as_policy(policy)
    if chosen is not None and not chosen.identity:
        raise InputError(f"policy {chosen.name}: the identity is empty, which a data set needs")
    target = os.fspath(out)
    job = ShardJob(
        scene=SceneName.of(loaded),
        threads=needs.threads,
        out=target if is_remote(target) else str(Path(target.partition("://")[2] or target).absolute()),
        storage_options=dict(storage_options or {}),
        policy=pickled(chosen),
        batch_size=batch_size,
        num_slices=num_slices,
        repair=repair,
        scratch=os.fspath(scratch),
    )
    line = ProgressLine("episodes")
    with connected(address, num_cpus):
        try:
            return _Run(loaded, job, Tasks(make_shards, needs, max_retries), on_progress or line.show).complete(task_seconds)
        finally:
            line.end()


class _Run:
    def __init__(self, scene: Scene, job: ShardJob, tasks: Tasks[range], on_progress: OnProgress) -> None:
        self._scene = scene
        self._job = job
        self._tasks = tasks
        self._on_progress = on_progress
        self._storage = Storage(job.out, job.storage_options) if is_remote(job.out) else None
        self._num_shards = math.ceil(scene.num_episodes / scene.episodes_per_shard)
        self._stored: dict[int, tuple[str, int]] = {}
        self._num_done = self._num_simulated = self._num_tasks = 0
        self._first: Made | None = None

    def complete(self, task_seconds: float | None) -> Summary:
        begin = time.monotonic()
        missing = self._missing()
        # One task first: it writes the manifest, and shows how long a shard takes.
        first = missing[0] if missing else 0
        self._require_manifest(is_new=self._manifest() is None)
        self._send([range(first, first + 1)])
        self._require_manifest(is_new=False)
        others = [shard for shard in range(self._num_shards) if shard != first]
        self._send(self._split(others, task_seconds))
        self._finish()
        return Summary(
            self._scene.num_episodes,
            self._num_simulated,
            self._num_tasks,
            self._tasks.num_retries,
            dict(self._tasks.refused),
            time.monotonic() - begin,
        )

    def _missing(self) -> list[int]:
        if self._storage is not None:
            names = set(self._storage.sizes())
        else:
            folder = Path(self._job.out)
            names = {file.name for file in folder.iterdir()} if folder.is_dir() else set()
        return [shard for shard in range(self._num_shards) if shard_name(shard) not in names]

    def _manifest(self) -> bytes | None:
        if self._storage is not None:
            return self._storage.read(MANIFEST)
        file = Path(self._job.out) / MANIFEST
        return file.read_bytes() if file.is_file() else None

    def _require_manifest(self, is_new: bool) -> None:
        if is_new:
            return
        manifest = self._manifest()
        if manifest is None:
            raise InputError(f"{self._job.out}: a node wrote shards there that this machine does not see: give a directory that all share")
        self._job = dataclasses.replace(self._job, manifest_sha256=hashlib.sha256(manifest).hexdigest())

    def _send(self, ranges: list[range]) -> None:
        self._num_tasks += len(ranges)
        self._tasks.run(self._job, ranges, self._done)

    def _done(self, shards: range, made: Made) -> None:
        self._first = self._first or made
        self._stored |= made.stored
        self._num_simulated += made.num_episodes
        per_shard = self._scene.episodes_per_shard
        self._num_done += min(shards.stop * per_shard, self._scene.num_episodes) - shards.start * per_shard
        self._on_progress(self._num_done, self._scene.num_episodes)

    def _split(self, shards: list[int], task_seconds: float | None) -> list[range]:
        """Ranges of about `task_seconds`, by the time of the first task."""
        first = self._first
        size = 1
        if first is not None and first.num_episodes > 0:
            seconds = task_length(task_seconds, first.setup_seconds)
            size = max(1, round(seconds / max(first.seconds, 1e-3)))
        fair = math.ceil(len(shards) / max(1, slots(self._tasks.workers, self._tasks.refused)))
        size = max(1, min(size, fair))
        return [run[k : k + size] for run in runs_of(shards) for k in range(0, len(run), size)]

    def _finish(self) -> None:
        if self._storage is None:
            _finish_directory(Path(self._job.out))
            return
        # Every shard was read back; what the storage lists must still be that.
        sizes = self._storage.sizes()
        for shard, (_, size) in sorted(self._stored.items()):
            if sizes.get(shard_name(shard)) != size:
                raise IoError(
                    f"{self._job.out}/{shard_name(shard)}: has {sizes.get(shard_name(shard))} bytes, {size} were uploaded; run again"
                )
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            manifest = self._manifest()
            if manifest is None or hashlib.sha256(manifest).hexdigest() != self._job.manifest_sha256:
                raise InputError(f"{self._job.out}: another run writes here, with another {MANIFEST}")
            (folder / MANIFEST).write_bytes(manifest)
            _core.write_view(folder, self._scene.num_steps)
            checksum = (folder / f"{VIEW}.sha256").read_bytes()
            self._storage.upload(folder / VIEW, checksum[:64].decode())
            self._storage.upload_text(f"{VIEW}.sha256", checksum)
        lines = (f"{digest} {size} {shard_name(shard)}\n" for shard, (digest, size) in sorted(self._stored.items()))
        self._storage.upload_text(CHECKSUMS, "".join(lines).encode())


def _finish_directory(out: Path) -> None:
    """Processes of lost nodes may hold their locks a little longer."""
    for attempt in range(ATTEMPTS):
        try:
            finish(out)
            return
        except IoError:
            if attempt + 1 == ATTEMPTS:
                raise
            time.sleep(FIRST_DELAY * 2**attempt)
