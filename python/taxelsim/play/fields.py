"""Names, units, ranges and meanings of the settings in the browser, from the table of keys that `taxelsim schema` prints."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from functools import cache
from typing import Any

from ..program import PROGRAM


@dataclass(frozen=True)
class Field:
    """A key of a sensor or scene file."""

    name: str
    unit: str  #: Empty without one.
    text: str  #: Its meaning, one sentence.
    low: float
    high: float
    choices: tuple[str, ...]  #: Of an enumeration.

    @property
    def label(self) -> str:
        """Name, and unit where the name does not end with it."""
        return f"{self.name}, {self.unit}" if self.unit and not self.name.endswith(f"_{self.unit}") else self.name


@cache
def _definitions() -> dict[str, Any]:
    text = subprocess.run([PROGRAM, "schema", "scene"], check=True, capture_output=True, text=True).stdout
    definitions: dict[str, Any] = json.loads(text)["definitions"]
    return definitions


def field(block: str, *names: str) -> Field:
    """The field of a key of a block, such as ("readout", "noise"). An alternative of several types is its first one."""
    found = _definitions()[block]
    for name in names:
        found = found["properties"][name]
        found = {**found, **found.get("anyOf", [{}])[0]}
    low, high = found.get("minimum", -float("inf")), found.get("maximum", float("inf"))
    return Field(names[-1], found.get("unit", ""), found["description"], low, high, tuple(found.get("enum", ())))
