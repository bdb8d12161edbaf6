"""The programs in the documents run."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import taxelsim

ROOT = Path(__file__).resolve().parents[2]


def first_program(document: str, heading: str) -> str:
    text = (ROOT / document).read_text()
    return re.search(r"```python\n(.*?)```", text[text.index(heading) :], re.DOTALL).group(1)


@pytest.mark.parametrize(("document", "heading"), [("README.md", "## From Python"), ("docs/python.md", "## A first batch")])
def test_the_first_batch_runs(document, heading, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(taxelsim, "generate", lambda scene, out: taxelsim.load_scene(scene))  # it would take minutes
    names: dict = {}
    exec(first_program(document, heading), names)
    frame = names["frame"]
    assert frame.tactile_image.shape == (4096, 6, 14)
    assert frame.ground_truth.load_reached.all()
    assert frame.ground_truth.total_force[-1] == pytest.approx(5, rel=1e-3)


def test_sensors_and_objects_of_the_document_are_valid(monkeypatch):
    program = first_program("docs/python.md", "## Sensors and objects").replace('taxelsim.load_mesh("bolt_mm.stl", scale=0.001)', "mesh")
    names = {
        "taxelsim": taxelsim,
        "sensor": taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml"),
        "vertices": np.eye(3),
        "triangles": [[0, 1, 2]],
    }
    exec(program, names)
    taxelsim.check_sensor(names["noisy"])
    taxelsim.check_sensor(names["pad"])
