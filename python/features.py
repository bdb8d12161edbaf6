#!/usr/bin/env python3
"""Writes the module taxelsim._features, classes with a field per feature: features.py INCLUDE_FOLDER OUTPUT.

From the tables taxelsim/feature_table.h and taxelsim/output_table.h.
"""

import re
import sys
import textwrap
from pathlib import Path
from typing import NamedTuple

ARRAYS = {"float": "FloatArray", "int": "IntArray", "bool": "BoolArray", "ContactType": "IntArray"}
TAXELS = "num_rows, num_cols"


class Group(NamedTuple):
    """A class, and the tables of its fields."""

    name: str
    base: str
    doc: str
    tables: tuple[str, ...]
    forces: str = "the taxel forces"  # what the features are computed from


GROUPS = (
    Group("Features", "Arrays", "Moments of an image of forces.", ("IMAGE_FEATURES",)),
    Group("ReadoutFeatures", "Features", "Features and counts of the readout.", ("READOUT_FEATURES", "MEASURED_TAXELS")),
    Group(
        "TruthFeatures",
        "Features",
        "Features and forces that no sensor could measure.",
        ("TRUTH_FEATURES", "TRUE_TAXELS"),
        "the true taxel forces",
    ),
    Group(
        "ContactFeatures",
        "Features",
        "Features of contacts. Rows: the sensor, each patch, then the regions with the largest force.",
        ("CONTACT_FEATURES", "REGION_FEATURES"),
    ),
    Group(
        "TactileJacobian",
        "Arrays",
        "Derivatives of features by a small twist of the sensor: v of the origin of S (per m), then w (per rad).",
        ("JACOBIAN_FEATURES",),
    ),
    Group(
        "CleanTactileJacobian",
        "TactileJacobian",
        "The same from true forces, and the Jacobian of the contact wrench.",
        ("WRENCH_JACOBIAN",),
        "the true taxel forces",
    ),
)


def rows_of(tables: str, name: str) -> list[list[str]]:
    """The arguments of each row of a table, strings without quotes."""
    body = re.search(rf"#define TAXELSIM_{name}\(X\)((?:.*\\\n)+.*)", tables)
    if not body:
        raise SystemExit(f"{sys.argv[0]}: no table {name}")
    text = re.sub(r'"\s*"', "", body[1].replace("\\\n", " "))  # joins lines and strings
    return [
        [word or string for string, word in re.findall(r'"([^"]*)"|([^",\s][^",]*)', row)]
        for row in re.findall(r'X\(((?:"[^"]*"|[^")])*)\)', text)
    ]


def field_of(table: str, row: list[str], forces: str) -> tuple[str, str, str]:
    """Name, type and description of a field."""
    if table.endswith("_TAXELS"):
        name, _, kind, leading, components, unit, text = row
        shape = ["N", leading * (leading != "1"), TAXELS, components * (components != "1")]
        text += " Sensors of several patches have one axis num_taxels. Missing unless requested."
        frame = "-"
    else:
        _, name, _, components, kind, unit, frame, _, text = row
        width = int(components.rstrip("u"))
        if table.endswith("JACOBIAN") or table == "JACOBIAN_FEATURES":
            last = [str(width // 6) * (width > 6), "6"]
        else:
            last = [str(width) * (width > 1)]
        shape = ["N", "num_rows" * (table in ("CONTACT_FEATURES", "JACOBIAN_FEATURES")), *last]
    inside = "" if frame == "-" else f", in {frame}"
    of = "" if unit == "1" else f", {unit}"
    return name, ARRAYS[kind], f"({', '.join(filter(None, shape))}){of}{inside}. {text.replace('{}', forces)}"


def main() -> None:
    """Writes the module."""
    folder = Path(sys.argv[1]) / "taxelsim"
    tables = "".join((folder / name).read_text() for name in ("feature_table.h", "output_table.h"))
    lines = [
        '"""Classes of the features of a frame, made from the tables of the C++ library."""',
        "",
        "from __future__ import annotations",
        "",
        "from ._named_arrays import Arrays, BoolArray, FloatArray, IntArray",
        "",
        "IMAGE_FEATURES = (",
        *(f'    ("{row[1]}", {row[3].rstrip("u")}, "{row[5]}"),' for row in rows_of(tables, "IMAGE_FEATURES")),
        ")",
        '"""Features of an image: name, number of values, unit."""',
    ]
    for group in GROUPS:
        lines += ["", "", f"class {group.name}({group.base}):", f'    """{group.doc}"""', ""]
        for table in group.tables:
            for row in rows_of(tables, table):
                name, kind, doc = field_of(table, row, group.forces)
                lines += [f"    {name}: {kind}", *textwrap.wrap(f'"""{doc}"""', 120, initial_indent="    ", subsequent_indent="    ")]
    Path(sys.argv[2]).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
