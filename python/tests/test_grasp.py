"""Scenes of kind grasp from Python: sensors by name, a data set with columns grouped by sensor."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import taxelsim as ts
from taxelsim.dataset import Dataset

SCENES = Path(__file__).parents[2] / "scenes"


def test_generates_and_reads_a_grasp(tmp_path: Path) -> None:
    scene = ts.load_scene(SCENES / "gripper_grasp.yaml", num_episodes=2)
    assert scene.kind == ts.Scene.Kind.GRASP
    assert [name for name, _ in scene.sensors] == ["left", "right", "below"]
    assert [sensor.name for _, sensor in scene.sensors] == ["fingertip_6x4", "wts0614_soft_cover", "fingertip_6x4"]
    assert ts.generate(scene, tmp_path / "out", batch_size=2).complete
    data = Dataset(tmp_path / "out")
    assert data["data/left/tactile_image"][100:102].shape == (2, 6, 4)
    assert data["data/right/tactile_image"][0].shape == (6, 14)
    held = np.array([data["data/left/total_force"][-1], data["data/below/total_force"][-1]])
    # 24 taxels, each off by at most a count of 1/2400 N, one at its trigger of 0.002 N.
    np.testing.assert_allclose(held, data["meta/target_force"][1], atol=24 / 2400 + 0.002)
