"""What the package depends on, for [[tool.dynamic-metadata]] in pyproject.toml: a wheel for one version of Python has nanobind inside."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any


def dynamic_metadata(settings: Mapping[str, Any], project: Mapping[str, Any]) -> dict[str, Any]:
    """The field `dependencies`."""
    per_version = os.environ.get("TAXELSIM_PER_VERSION", "0").lower() not in ("", "0", "false", "off", "no")
    # NumPy 2.1 is the first that exports read-only arrays through DLPack.
    return {"dependencies": ["numpy>=2.1"] if per_version else ["numpy>=2.1", "nanobind-backend>=1.0"]}
