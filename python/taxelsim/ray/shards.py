"""What runs on the nodes: makes the shards of a task."""

from __future__ import annotations

import contextlib
import dataclasses
import fcntl
import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .._core import Progress
from ..errors import InputError, IoError
from ..runs import generate
from .node import DamagedError, Job, Outcome, outcomes, policy_of, scene_and_device
from .storage import MANIFEST, Storage, checksum_line, is_remote, shard_name
from .upload import Uploader

_SCRATCH = "taxelsim-scratch-"


@dataclass(frozen=True)
class ShardJob(Job):
    """Shards of a data set."""

    out: str = ""
    storage_options: Mapping[str, Any] = field(default_factory=dict)
    repair: bool = False
    scratch: str = ""  #: Folder for shards before they are uploaded; empty: that of the system.
    manifest_sha256: str = ""  #: Of dataset.yaml; empty until the first task has written it.


@dataclass(frozen=True)
class Made:
    """Shards that are complete where the data set is."""

    num_episodes: int  #: That this task simulated.
    setup_seconds: float  #: s outside of the simulation: device, kernels, probe, uploads.
    seconds: float  #: s of the simulation, with shards written to disk.
    stored: dict[int, tuple[str, int]]  #: SHA-256 and bytes by shard; of remote data sets.


def make_shards(job: ShardJob, shards: range) -> Outcome:
    """Makes the shards of a range that the data set lacks. Waits until they are stored."""
    found: list[Outcome] = []
    with outcomes(found) as node:
        found.append(Outcome(node, value=_uploaded(job, shards) if is_remote(job.out) else _written(job, shards)))
    return found[0]


def _generated(job: ShardJob, folder: Path, shards: range, on_progress: Callable[[Progress], object] | None = None) -> Made:
    scene, device = scene_and_device(job)
    result = generate(
        scene,
        folder,
        policy=policy_of(job),
        device=device,
        batch_size=job.batch_size,
        num_slices=job.num_slices,
        on_progress=on_progress,
        repair=job.repair,
        shards=shards,
    )
    if not result.complete:
        raise IoError(f"{folder}: shards {shards.start} to {shards.stop - 1} are not complete")
    progress = result.progress
    return Made(progress.episodes_done - progress.episodes_resumed, 0.0, progress.seconds, {})


def _require_manifest(job: ShardJob, content: bytes | None) -> None:
    """The manifest of the first task, on this node: a mount may have vanished, and another run may have begun in the same place."""
    if not job.manifest_sha256:
        return
    if content is None:
        raise IoError(f"{job.out}: {MANIFEST} cannot be seen on {os.uname().nodename}: all nodes must reach the data set by this name")
    if hashlib.sha256(content).hexdigest() != job.manifest_sha256:
        raise InputError(f"{job.out}: another run writes here, with another {MANIFEST}")


def _written(job: ShardJob, shards: range) -> Made:
    """Directly into a directory that the nodes share, with claims."""
    begin = os.times().elapsed
    folder = Path(job.out)
    manifest = folder / MANIFEST
    _require_manifest(job, manifest.read_bytes() if manifest.is_file() else None)
    made = _generated(job, folder, shards)
    return dataclasses.replace(made, setup_seconds=os.times().elapsed - begin - made.seconds)


def _uploaded(job: ShardJob, shards: range) -> Made:
    """In a scratch folder, from which another thread uploads."""
    begin = os.times().elapsed
    storage = Storage(job.out, job.storage_options)
    manifest = storage.read(MANIFEST)
    _require_manifest(job, manifest)
    stored = {shard: found for shard in shards if (found := _stored(job, storage, shard))}
    missing = [shard for shard in shards if shard not in stored]
    num_episodes, seconds = 0, 0.0
    with _scratch(job) as folder:
        if manifest is not None:
            (folder / MANIFEST).write_bytes(manifest)
        uploader = Uploader(storage, folder, missing, has_manifest=manifest is not None)
        uploader.start()
        try:
            for run in runs_of(missing):
                made = _generated(job, folder, run, lambda _: uploader.check())
                num_episodes, seconds = num_episodes + made.num_episodes, seconds + made.seconds
        finally:
            uploader.end()
        uploader.check()
    return Made(num_episodes, os.times().elapsed - begin - seconds, seconds, stored | uploader.stored)


def _stored(job: ShardJob, storage: Storage, shard: int) -> tuple[str, int] | None:
    """SHA-256 and bytes of a shard that counts: it has a checksum file, and the bytes that this says."""
    name = shard_name(shard)
    line = storage.read(name + ".sha256")
    digest = (line or b"")[:64].decode("ascii", "replace")
    if line is None or line != checksum_line(digest, name):
        return None  # an upload was cut off
    found = storage.digest(name)
    if found is not None and found[0] != digest:
        if not job.repair:
            raise DamagedError(
                f"{storage.url}/{name}: its SHA-256 is {found[0]}, not {digest} as in {name}.sha256; repair=True makes it again"
            )
        return None
    return found


def runs_of(shards: list[int]) -> list[range]:
    """Ranges of numbers that follow each other."""
    runs: list[range] = []
    for shard in shards:
        if runs and runs[-1].stop == shard:
            runs[-1] = range(runs[-1].start, shard + 1)
        else:
            runs.append(range(shard, shard + 1))
    return runs


@contextmanager
def _scratch(job: ShardJob) -> Iterator[Path]:
    """A folder that this process locks. Removes those of processes that were killed: their locks are free."""
    root = Path(job.scratch or tempfile.gettempdir())
    root.mkdir(parents=True, exist_ok=True)
    for left in root.glob(_SCRATCH + "*"):
        with contextlib.suppress(OSError), _locked(left, fcntl.LOCK_EX | fcntl.LOCK_NB):
            shutil.rmtree(left, ignore_errors=True)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=_SCRATCH, dir=root))
        with _locked(folder, fcntl.LOCK_EX):
            if not folder.exists():
                continue  # another process took it for one that was left
            try:
                yield folder
            finally:
                shutil.rmtree(folder, ignore_errors=True)
            return


@contextmanager
def _locked(folder: Path, operation: int) -> Iterator[None]:
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(descriptor, operation)
        yield
    finally:
        os.close(descriptor)
