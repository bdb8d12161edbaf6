"""The scenes that bench/python/mujoco_forces.py compares with MuJoCo: objects at rest under their weight."""

from pathlib import Path

import numpy as np
import pytest

import taxelsim
from taxelsim.dataset import Dataset

# Scene: weight, N, and where its line of action passes through the skin, mm.
RESTS = {
    "ball": (0.981, (2, 3)),
    "box": (1.962, (1, -2)),
    "box_off_center": (1.962, (2, 1)),
    "cylinder": (1.962, (1, -2)),
    "roof": (0.981, (1, 2)),
}
SUM_ERROR = 1e-4  # relative: of the load search, which ends at float32's resolution of the depth
CENTRE_ERROR = 0.4  # mm: an image of taxels of 3.4 mm, as docs/notes/validation.md has it


def test_all_scenes_are_here() -> None:
    assert {file.stem for file in (taxelsim.SCENES / "experiments/mujoco").glob("*.yaml")} == set(RESTS)


@pytest.mark.parametrize("name", RESTS)
def test_a_scene_carries_the_weight_where_it_acts(device: taxelsim.Device, tmp_path: Path, name: str) -> None:
    weight, place = RESTS[name]
    scene = taxelsim.load_scene(taxelsim.SCENES / f"experiments/mujoco/{name}.yaml")
    assert (scene.name, scene.randomization["load"]) == (name, (weight, weight))
    taxelsim.generate(scene, tmp_path / "out", device=device)
    data = Dataset(tmp_path / "out")
    assert data["data/ground_truth/total_force"][0] == pytest.approx(weight, rel=SUM_ERROR)
    np.testing.assert_allclose(1e3 * data["data/ground_truth/center_of_pressure"][0, :2], place, atol=CENTRE_ERROR)
