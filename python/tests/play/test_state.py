"""Presses, and texts that reproduce them byte for byte."""

import subprocess
import sys

import numpy as np
import pytest

import taxelsim

pytest.importorskip("viser", reason="viser as in python/requirements/test.txt")

from taxelsim.play.state import Changes, Press, Settings, changed_sensor, settings_at, unit_quaternion
from taxelsim.play.texts import program_text, scene_text

SPEC = "cylinder:0.008,0.04"
ROTATION = unit_quaternion([0.7, 0.7, 0.1, 0.05])
CASES = [
    Settings(x=0.001, y=0.002, rotation=ROTATION, depth=3e-5),
    Settings(rotation=ROTATION, load=5.0, changes=Changes(law="mass_spring_damper", spread=0.7, sampling="point", noise=3.0)),
]


@pytest.fixture(scope="module")
def press(device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    return Press(device, sensor, [taxelsim.parse_object(SPEC)])


@pytest.mark.parametrize("settings", CASES, ids=["depth", "load"])
def test_texts_reproduce_the_image(press, device, settings, tmp_path):
    view = press.view(settings)
    assert view.counts.any()
    text = program_text(view, press.objects[0], SPEC).replace("print(simulator", "np.save('image.npy', simulator")
    subprocess.run([sys.executable, "-c", text], cwd=tmp_path, check=True)
    np.testing.assert_array_equal(np.load(tmp_path / "image.npy").reshape(-1), view.counts)
    (tmp_path / "scene.yaml").write_text(scene_text(view, press.objects[0], SPEC))
    taxelsim.generate(taxelsim.load_scene(tmp_path / "scene.yaml"), tmp_path / "out", device=device)
    np.testing.assert_array_equal(taxelsim.Dataset(tmp_path / "out")["data/tactile_image"][:].reshape(-1), view.counts)


def test_a_dragged_pose_is_kept(press):
    moved = settings_at(Settings(), press.objects[0], [0.001, 0.002, 0.0079], 3 * np.array(ROTATION))
    view = press.view(moved)
    np.testing.assert_allclose(view.pose, [0.001, 0.002, 0.0079, *ROTATION], atol=1e-15)


def test_random_settings_give_finite_frames_or_one_line(press):
    random = np.random.default_rng(7)
    refusals = []
    for _ in range(300):
        values = random.choice([0.0, 1e-5, 1e-3, 0.02, -0.01, 1e9, np.nan, np.inf], 5)
        try:
            settings = settings_at(Settings(), press.objects[0], values[:3], random.normal(size=4) * values[3])
            view = press.view(settings if values[4] < 0 else Settings(load=float(values[4]), rotation=settings.rotation))
        except taxelsim.InputError as error:
            refusals.append(str(error))
            continue
        assert np.isfinite(view.pose).all()
        assert np.isfinite(view.features["total_force"])
    assert 0 < len(refusals) < 300
    assert not any("\n" in line for line in refusals)


@pytest.mark.parametrize("changes", [Changes(law="proximity"), Changes(friction=0.5), Changes(noise=12.0, spread=0.0, sampling="point")])
def test_a_changed_sensor_is_valid(press, changes):
    taxelsim.check_sensor(changed_sensor(press.base, changes))


@pytest.mark.parametrize("changes", [Changes(law="none"), Changes(noise=-1.0), Changes(friction=-0.5)])
def test_a_wrong_change_is_refused_in_one_line(press, changes):
    with pytest.raises(taxelsim.InputError, match=r"^[^\n]+$"):
        taxelsim.check_sensor(changed_sensor(press.base, changes))
