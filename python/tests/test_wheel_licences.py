"""The check of wheels: scripts/wheel_licences.py."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts/wheel_licences.py"
PARTS = [
    "taxelsim/_core.abi3.so",
    "taxelsim/_core.pyi",
    "taxelsim/py.typed",
    "taxelsim/bin/taxelsim",
    "taxelsim/lib/libtaxelsim.so.0.1",
    "taxelsim/scenes/edge_servo.yaml",
    "taxelsim.libs/libassimp-01234567.so.5.2.4",
    "taxelsim-0.1.0.dist-info/METADATA",
]
LICENCES = {"taxelsim-0.1.0.dist-info/licenses/bundled/libassimp5.txt": "libassimp5: libassimp.so.5.2.4\n\nBSD\n"}


def check(file: Path, contents: dict[str, str]) -> subprocess.CompletedProcess[str]:
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in contents.items():
            archive.writestr(name, text)
    return subprocess.run([sys.executable, SCRIPT, "check", file], capture_output=True, text=True)


def test_a_whole_wheel_passes(tmp_path):
    found = check(tmp_path / "a.whl", {**dict.fromkeys(PARTS, ""), **LICENCES})
    assert found.returncode == 0, found.stderr
    assert "1 bundled libraries, 1 licence files" in found.stdout


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ({**LICENCES, "taxelsim.libs/libcholmod-01234567.so.3": ""}, "libcholmod-01234567.so.3 is under the GPL"),
        ({**LICENCES, "taxelsim.libs/libspqr-01234567.so.2": ""}, "libspqr-01234567.so.2 is under the GPL"),
        ({}, "libassimp-01234567.so.5.2.4 has no licence file"),
        ({**LICENCES, "large": "x" * 61_000_000}, "at most 60,000,000 are allowed"),
    ],
)
def test_wheels_with_a_fault_are_refused(tmp_path, contents, message):
    found = check(tmp_path / "a.whl", {**dict.fromkeys(PARTS, ""), **contents})
    assert found.returncode != 0
    assert message in found.stderr


@pytest.mark.parametrize("part", PARTS[:-2])
def test_wheels_without_a_part_are_refused(tmp_path, part):
    found = check(tmp_path / "a.whl", {**dict.fromkeys([name for name in PARTS if name != part], ""), **LICENCES})
    assert found.returncode != 0
    assert "is missing" in found.stderr
