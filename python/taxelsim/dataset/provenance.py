"""Where a data set comes from: what its manifest says besides the columns."""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
import textwrap
from dataclasses import dataclass
from pathlib import Path

from .. import _core

# A sensor of a resolved scene, and the name of an item of a list, which comes before its sensor.
_SENSOR = re.compile(r"^(?P<indent> *)sensor:\n(?P<settings>(?:(?P=indent)  .*\n)+)", re.MULTILINE)
_ITEM = re.compile(r"^ *- name: (.*)$", re.MULTILINE)


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
        reader = _core.DatasetReader(folder, isolated=True)
        names = ("format_version", "program_version", "device", "policy", "seed")
        return Provenance(**{name: getattr(reader, name) for name in names}, scene=reader.scene.decode(), num_shards=reader.num_shards)

    @property
    def scene_sha256(self) -> str:
        """SHA-256 of the text of the scene."""
        return hashlib.sha256(self.scene.encode()).hexdigest()

    def sensors(self) -> dict[str, _core.Sensor]:
        """The sensors of the scene: of kind grasp by name, else one under ""."""
        result = {}
        with tempfile.TemporaryDirectory() as folder:
            scene = _core.readable_scene(self.scene)
            for found in _SENSOR.finditer(scene):
                file = Path(folder, "sensor.yaml")
                file.write_text("format_version: 1\n" + textwrap.dedent(found["settings"]), encoding="utf-8")
                name = _ITEM.findall(scene, 0, found.start())[-1] if found["indent"] else ""
                result[json.loads(name) if name.startswith('"') else name] = _core.load_sensor(file)
        return result
