"""`taxelsim schema`: every file that ships is valid, and what the readers refuse is not."""

from __future__ import annotations

import json
import re
import subprocess
from functools import cache
from typing import Any

import pytest
import yaml
from jsonschema import Draft7Validator

from taxelsim.program import PROGRAM, SCENES


class Loader(yaml.SafeLoader):
    """YAML 1.2 as the program reads it: 1e-3 is a number, true and dates are texts."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith((":timestamp", ":bool"))]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"), list("-+0123456789."))


@cache
def validator(kind: str) -> Draft7Validator:
    schema = json.loads(subprocess.run([PROGRAM, "schema", kind], check=True, capture_output=True, text=True).stdout)
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema)


def kind_of(content: dict[str, Any]) -> str | None:
    if "kind" in content:
        return "scene"
    if "skin" in content:
        return "sensor"
    return "robot" if {"free_flying", "pan_tilt", "urdf"} & content.keys() else None


def test_shipped_files_are_valid() -> None:
    numbers = dict.fromkeys(("scene", "sensor", "robot"), 0)
    for file in sorted(SCENES.rglob("*.yaml")):
        content = yaml.load(file.read_text(), Loader)
        if (kind := kind_of(content)) is None:
            continue
        assert not [error.message for error in validator(kind).iter_errors(content)], file
        numbers[kind] += 1
    assert min(numbers.values()) > 1


SENSOR = yaml.safe_load("""
format_version: 1
name: pad
num_rows: 2
num_cols: 2
pitch_mm: 3
skin: {thickness_mm: 2, normal_contact_stiffness: 1.0e+8}
readout: {curve: {counts_per_newton: 100}}
""")


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["format_version"], 2),
        (["num_rows"], 129),
        (["num_rows"], 1.5),
        (["pitch_mm"], 0),
        (["pitch_mm"], [1, 2, 3]),
        (["pich"], 1),
        (["depth_sampling"], "areas"),
        (["skin", "mass"], 1),  # belongs to another law
        (["skin", "law"], "proximity"),  # its sensitivity is missing, and it takes no stiffness
        (["skin", "normal_exponent"], 3.5),
        (["readout", "curve", "coefficients"], [1]),  # conflicts with counts_per_newton
        (["readout", "adc_bits"], 17),
        (["taxels"], []),  # conflicts with num_rows
    ],
)
def test_mistakes_are_found(path: list[str], value: object) -> None:
    content = json.loads(json.dumps(SENSOR))
    assert validator("sensor").is_valid(content)
    block = content
    for key in path[:-1]:
        block = block[key]
    block[path[-1]] = value
    assert not validator("sensor").is_valid(content)


@pytest.mark.parametrize("block", [SENSOR, SENSOR["skin"], SENSOR["readout"]])
def test_keys_are_required(block: dict[str, Any]) -> None:
    for key in list(block):
        value = block.pop(key)
        assert not validator("sensor").is_valid(SENSOR) or key in ("num_cols", "pitch_mm"), key
        block[key] = value
    assert validator("sensor").is_valid(SENSOR)


def test_units_are_converted() -> None:
    properties = validator("sensor").schema["definitions"]["pose"]["properties"]
    assert properties["rpy_deg"]["items"]["maximum"] == 360
    randomization = validator("scene").schema["definitions"]["randomization"]["properties"]
    assert randomization["mounting_x_mm"]["anyOf"][0]["maximum"] == 20
    assert randomization["mounting_x"]["anyOf"][0]["maximum"] == 0.02
