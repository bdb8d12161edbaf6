"""The check of wheels: scripts/wheel_licences.py."""

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
    "taxelsim.libs/libhdf5_serial-01234567.so.103.3.0",
    "taxelsim-0.1.0.dist-info/METADATA",
]
METADATA = {"taxelsim-0.1.0.dist-info/METADATA": "Name: taxelsim\nRequires-Dist: nanobind-backend>=1.0\n"}
LICENCES = {"taxelsim-0.1.0.dist-info/licenses/bundled/libhdf5-103-1.txt": "libhdf5-103-1: libhdf5_serial.so.103.3.0\n\nBSD\n"}


def check(file: Path, contents: dict[str, str]) -> subprocess.CompletedProcess[str]:
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in contents.items():
            archive.writestr(name, text)
    return subprocess.run([sys.executable, SCRIPT, "check", file], capture_output=True, text=True)


def test_a_whole_wheel_passes(tmp_path):
    found = check(tmp_path / "a.whl", {**dict.fromkeys(PARTS, ""), **METADATA, **LICENCES})
    assert found.returncode == 0, found.stderr
    assert "1 bundled libraries, 1 licence files" in found.stdout


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ({}, "libhdf5_serial-01234567.so.103.3.0 has no licence file"),
        ({**LICENCES, "large": "x" * 61_000_000}, "at most 60,000,000 are allowed"),
    ],
)
def test_wheels_with_a_fault_are_refused(tmp_path, contents, message):
    found = check(tmp_path / "a.whl", {**dict.fromkeys(PARTS, ""), **METADATA, **contents})
    assert found.returncode != 0
    assert message in found.stderr


@pytest.mark.parametrize("part", PARTS[:-2])
def test_wheels_without_a_part_are_refused(tmp_path, part):
    found = check(tmp_path / "a.whl", {**dict.fromkeys([name for name in PARTS if name != part], ""), **METADATA, **LICENCES})
    assert found.returncode != 0
    assert "is missing" in found.stderr


def test_a_module_for_one_version_of_python_must_not_require_the_backend(tmp_path):
    names = [name.replace("_core.abi3.so", "_core.cpython-311-x86_64-linux-gnu.so") for name in PARTS]
    found = check(tmp_path / "a.whl", {**dict.fromkeys(names, ""), **METADATA, **LICENCES})
    assert "requires nanobind-backend: True, while the module does not need it" in found.stderr
    plain = dict.fromkeys(METADATA, "Name: taxelsim\n")
    assert check(tmp_path / "b.whl", {**dict.fromkeys(names, ""), **plain, **LICENCES}).returncode == 0
    found = check(tmp_path / "c.whl", {**dict.fromkeys(PARTS, ""), **plain, **LICENCES})
    assert "requires nanobind-backend: False, while the module needs it" in found.stderr
