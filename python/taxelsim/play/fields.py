"""Ranges and meanings of the settings in the browser, from the table of keys that `taxelsim schema` prints."""

from __future__ import annotations

import json
import subprocess
from functools import cache
from typing import Any

from ..program import PROGRAM


@cache
def _definitions() -> dict[str, Any]:
    text = subprocess.run([PROGRAM, "schema", "scene"], check=True, capture_output=True, text=True).stdout
    definitions: dict[str, Any] = json.loads(text)["definitions"]
    return definitions


def key(block: str, *names: str) -> dict[str, Any]:
    """The schema of a key of a block, such as ("readout", "noise"). An alternative of several types is its first one."""
    found = _definitions()[block]
    for name in names:
        found = found["properties"][name]
        if "anyOf" in found:
            found = {"description": found.get("description", ""), **found["anyOf"][0]}
    return dict(found)


def choices(block: str, *names: str) -> list[str]:
    """Values of an enumeration."""
    return list(key(block, *names)["enum"])
