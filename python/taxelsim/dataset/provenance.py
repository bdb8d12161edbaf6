"""Where a data set comes from: what its manifest says besides the columns."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from .. import _core


@dataclass(frozen=True)
class Provenance:
    """Provenance of a data set."""

    format_version: int
    program_version: str
    """Version of taxelsim that wrote it."""
    device: str
    """Name and driver of the device that wrote it."""
    policy: str
    """Identity of the policy that acted; empty: the controllers of the scene."""
    seed: int
    scene: str
    """The resolved scene, YAML."""
    num_shards: int

    @staticmethod
    def of(folder: Path) -> Provenance:
        """The provenance of a complete data set. Raises InputError."""
        reader = _core.IsolatedReader(folder)
        names = ("format_version", "program_version", "device", "policy", "seed")
        return Provenance(**{name: getattr(reader, name) for name in names}, scene=reader.scene.decode(), num_shards=reader.num_shards)

    @property
    def scene_sha256(self) -> str:
        """SHA-256 of the text of the scene."""
        return hashlib.sha256(self.scene.encode()).hexdigest()
