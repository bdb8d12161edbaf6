"""What runs on the nodes: scene, device and policy of a task, and what a task came to."""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ray
import ray.cloudpickle

from .. import _core
from .._core import Device, Scene
from ..errors import DeviceError, Error, InputError
from ..policies.policy import Policy
from ..program import SCENES
from .storage import one_line

_PACKAGE = "package:"  # a scene that ships with taxelsim: nodes have it elsewhere


class DamagedError(InputError):
    """A shard that is stored has other bytes than its checksum says."""


@dataclass(frozen=True)
class Outcome:
    """What a task came to. At most one of refusal, failure and error is not empty."""

    node: str  #: Ray's number of the node.
    value: Any = None
    refusal: str = ""  #: This node must not work on the run: it is of another kind.
    failure: str = ""  #: May pass: tried again.
    error: str = ""  #: Bad input: ends the run.


@dataclass(frozen=True)
class SceneName:
    """A scene by what it was loaded from."""

    file: str
    num_episodes: int
    seed: int
    condition: str
    sha256: str  #: Of the resolved text.

    @staticmethod
    def of(scene: Scene) -> SceneName:
        """The name of a scene on all nodes. Files must be at the same place there, except those of the package."""
        file = Path(scene.file).absolute()
        inside = file.is_relative_to(SCENES.absolute())
        name = _PACKAGE + str(file.relative_to(SCENES.absolute())) if inside else str(file)
        return SceneName(name, scene.num_episodes, scene.seed, scene.condition, _sha256(scene))

    def load(self) -> Scene:
        """Reads the scene on this node. Raises InputError if it is another one."""
        file = str(SCENES / self.file.removeprefix(_PACKAGE)) if self.file.startswith(_PACKAGE) else self.file
        scene = _core.load_scene(file, self.num_episodes, self.seed, self.condition)
        if _sha256(scene) != self.sha256:
            raise InputError(f"{file}: is another scene on {os.uname().nodename} than where the run was started")
        return scene


def _sha256(scene: Scene) -> str:
    return hashlib.sha256(scene.resolved.encode()).hexdigest()


@dataclass(frozen=True)
class Job:
    """What all tasks of a run have in common."""

    scene: SceneName
    threads: int  #: Threads of a software driver.
    policy: bytes = b""  #: Of pickled(); empty without a policy.
    batch_size: int = 2048
    num_slices: int = 2
    version: str = _core.version


def pickled(policy: Policy | None) -> bytes:
    """A policy that nodes unpickle within a task, where a missing file or package makes a message of it. Raises InputError."""
    if policy is None:
        return b""
    try:
        content: bytes = ray.cloudpickle.dumps(policy)
    except Exception as error:  # whatever the objects of the policy raise
        raise InputError(f"policy {policy.name}: cannot be pickled: {one_line(error)}") from error
    return content


_loaded = functools.lru_cache(maxsize=4)(SceneName.load)
_opened = functools.lru_cache(maxsize=1)(Device.open)


def scene_and_device(job: Job) -> tuple[Scene, Device]:
    """Loaded and opened once per process. Raises InputError if this node has another version of taxelsim."""
    if job.version != _core.version:
        raise InputError(f"taxelsim {_core.version} is installed, the run is of {job.version}")
    os.environ.setdefault("LP_NUM_THREADS", str(job.threads))
    return _loaded(job.scene), _opened()


def policy_of(job: Job) -> Policy | None:
    """The policy, in the state in which it was sent."""
    policy: Policy | None = ray.cloudpickle.loads(job.policy) if job.policy else None
    return policy


@contextmanager
def outcomes(found: list[Outcome]) -> Iterator[str]:
    """Appends an Outcome for an exception of taxelsim or of the system. Yields the node."""
    node = ray.get_runtime_context().get_node_id()
    try:
        yield node
    except DamagedError as error:
        found.append(Outcome(node, error=one_line(error)))
    except InputError as error:
        found.append(Outcome(node, refusal=one_line(error)))
    except (Error, OSError) as error:
        if isinstance(error, DeviceError):
            _opened.cache_clear()  # it may be lost
        found.append(Outcome(node, failure=one_line(error)))
