"""Scenes of kind grasp from Python: sensors by name, a data set with columns grouped by sensor."""

from pathlib import Path

import numpy as np
import pytest

import taxelsim as ts
from taxelsim.dataset import Dataset

SCENES = Path(__file__).parents[2] / "scenes"
READING = 24 / 2400 + 0.002  # N: 24 taxels, each off by at most a count of 1/2400 N, one at its trigger of 0.002 N


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
    np.testing.assert_allclose(held, data["meta/target_force"][1], atol=READING)


def test_conditions_vary_the_readout_of_each_sensor(device: ts.Device, tmp_path: Path) -> None:
    """A reading is the force times the gain that is drawn for its sensor and episode."""
    text = (SCENES / "gripper_grasp.yaml").read_text().replace("robots/", f"{SCENES.resolve()}/robots/")
    (tmp_path / "scene.yaml").write_text(
        text.replace("{gain: [1.25, 1.4], gain_spread: [0.35, 0.44], noise: [25, 40]}", "{gain: [0.6, 0.9]}")
    )
    scene = ts.load_scene(tmp_path / "scene.yaml", num_episodes=3, condition="unseen")
    assert scene.conditions == ["randomized", "unseen"]
    ts.generate(scene, tmp_path / "out", device=device, batch_size=2)
    data = Dataset(tmp_path / "out")
    gains = data["meta/gain"][:]
    assert gains.shape == (3, 3)
    assert len(set(gains.ravel())) == 9
    assert ((gains >= 0.6) & (gains <= 0.9)).all()
    for s, name in ((0, "left"), (2, "below")):
        read, true = (data[f"data/{name}/{column}"][149::150] for column in ("total_force", "ground_truth/total_force"))
        assert (true > 0.1).all()
        np.testing.assert_allclose(read, gains[:, s] * true, atol=READING)
    assert "meta/gain" not in Dataset(nominal(tmp_path, device))


def nominal(folder: Path, device: ts.Device) -> Path:
    ts.generate(ts.load_scene(folder / "scene.yaml", num_episodes=1), folder / "nominal", device=device)
    return folder / "nominal"


def test_evaluates_gains_in_the_same_episodes(device: ts.Device, tmp_path: Path) -> None:
    """The verdicts are those of the forces in a data set of the same episodes."""
    scene = ts.load_scene(SCENES / "gripper_grasp.yaml", num_episodes=3)
    slow, fast = ts.evaluate_grasp(scene, [2, 10], device=device, batch_size=2)
    assert (slow.gain, fast.gain) == (2, 10)
    assert [score.name for score in fast.fingers] == ["left", "below"]
    assert (fast.total.num_episodes, fast.total.num_held, fast.total.held_rate) == (3, 3, 1)
    verdicts = fast.verdicts
    assert verdicts["success"].tolist() == verdicts["held"].all(axis=1).tolist() == [True, True, True]
    # A force error falls by exp(-2 t) in the slow run, and by exp(-10 t) in the fast one.
    later = slow.verdicts["settling_time"]
    assert np.isnan(later[:, 0]).all()
    assert slow.fingers[0].num_held == slow.total.num_held == 0
    assert (later[:, 1] > verdicts["settling_time"][:, 1]).all()
    assert fast.fingers[1].peak_force.max == verdicts["peak_force"][:, 1].max()

    ts.generate(scene, tmp_path / "out", device=device)  # with the gain of the scene, 10
    data = Dataset(tmp_path / "out")
    forces = np.stack([data[f"data/{name}/total_force"][:].reshape(3, -1) for name in ("left", "below")], axis=2)
    np.testing.assert_allclose(verdicts["target_force"], data["meta/target_force"][:], rtol=1e-6)
    np.testing.assert_allclose(verdicts["peak_force"], forces.max(axis=1), atol=READING)

    again = ts.evaluate_grasp(scene, device=device)[0]
    for name, values in verdicts.items():
        np.testing.assert_array_equal(again.verdicts[name], values)


def test_refuses_another_kind_and_gains_out_of_range(device: ts.Device) -> None:
    with pytest.raises(ts.InputError, match=r"edge_servo\.yaml: not a scene of kind grasp"):
        ts.evaluate_grasp(SCENES / "edge_servo.yaml", device=device)
    with pytest.raises(ts.InputError, match="gain: 0 "):
        ts.evaluate_grasp(SCENES / "gripper_grasp.yaml", [0], device=device)
