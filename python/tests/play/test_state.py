"""Presses, texts that reproduce them byte for byte, and predictions by the Jacobian."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import taxelsim

pytest.importorskip("viser", reason="viser as in python/requirements/test.txt")

from taxelsim.play.changes import Changes, changed_sensor
from taxelsim.play.state import Item, Press, Settings, settings_at, unit_quaternion
from taxelsim.play.texts import program_text, scene_text

SPEC = "cylinder:0.008,0.04"
ROTATION = unit_quaternion([0.7, 0.7, 0.1, 0.05])
CASES = [
    Settings(x=0.001, y=0.002, rotation=ROTATION, depth=3e-5),
    Settings(rotation=ROTATION, load=5.0, changes=Changes(law="mass_spring_damper", sigma=0.7, depth_sampling="point", noise=3.0)),
]


@pytest.fixture(scope="module")
def press(device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    return Press(device, {"": sensor}, [Item(taxelsim.parse_object(SPEC), SPEC)])


def image_of_program(text, folder):
    """The tactile image that a program of program_text() prints, flat."""
    text = text.replace("print(frame", "np.save('image.npy', frame")
    subprocess.run([sys.executable, "-c", text], cwd=folder, check=True)
    return np.load(folder / "image.npy").reshape(-1)


def fresh(settings):
    return replace(settings, follows=False)


@pytest.mark.parametrize("settings", CASES, ids=["depth", "load"])
def test_texts_reproduce_the_image(press, device, settings, tmp_path):
    (view,) = press.views(fresh(settings))
    assert view.counts.any()
    np.testing.assert_array_equal(image_of_program(program_text(view, press.items[0]), tmp_path), view.counts)
    (tmp_path / "scene.yaml").write_text(scene_text(view, press.items[0]))
    taxelsim.generate(taxelsim.load_scene(tmp_path / "scene.yaml"), tmp_path / "out", device=device)
    np.testing.assert_array_equal(taxelsim.Dataset(tmp_path / "out")["data/tactile_image"][:].reshape(-1), view.counts)


def test_a_path_adds_up_shear_and_its_program_repeats_it(press, tmp_path):
    settings = Settings(rotation=ROTATION, depth=3e-5, changes=Changes(friction_coefficient=0.5))
    press.views(fresh(settings))
    for k in range(1, 6):
        (view,) = press.views(replace(settings, x=1e-6 * k))
    assert len(view.path) == 6
    assert view.shear[:, 0].sum() > 0  # as it acts on the skin, along the motion of the object
    with pytest.raises(taxelsim.InputError, match="path"):
        scene_text(view, press.items[0])
    np.testing.assert_array_equal(image_of_program(program_text(view, press.items[0]), tmp_path), view.counts)
    assert not press.views(fresh(replace(settings, x=5e-6)))[0].shear.any()


def test_a_path_ends_without_contact(press):
    touching = Settings(rotation=ROTATION, depth=3e-5)
    press.views(fresh(touching))
    assert len(press.views(replace(touching, depth=-1e-3))[0].path) == 2
    assert len(press.views(touching)[0].path) == 1


# Share of the change that the prediction may miss. Pressing by a tenth of the depth changes the force of a taxel to second order by half a
# tenth more; sliding, with areas, has the slopes in the middle of cells that are wider than this contact.
PRESSING, SLIDING = 0.1, 0.6


@pytest.mark.parametrize(("moved", "missed"), [({"depth": 3.3e-5}, PRESSING), ({"x": 1e-5}, SLIDING), ({"y": 1e-4}, SLIDING)])
def test_the_jacobian_predicts_small_motions(press, moved, missed):
    """The baseline predicts that nothing changes."""
    settings = fresh(Settings(rotation=ROTATION, depth=3e-5))
    press.views(settings)
    linear = press.linearize()
    (view,) = press.views(replace(settings, **moved))
    errors = [np.abs(forces - view.newtons).sum() for forces in (linear.newtons_at(view.pose), linear.newtons)]
    assert errors[0] < missed * errors[1]
    change = linear.features_at(view.pose).total_force - linear.features.total_force
    assert change == pytest.approx(view.truth.total_force - linear.features.total_force, rel=missed, abs=1e-3 * view.truth.total_force)
    np.testing.assert_allclose(linear.newtons_at(linear.pose), linear.newtons, rtol=1e-9)  # rounding of the pose


def test_a_dragged_pose_is_kept(press):
    moved = settings_at(Settings(), press.items[0].object, [0.001, 0.002, 0.0079], 3 * np.array(ROTATION))
    (view,) = press.views(moved)
    np.testing.assert_allclose(view.pose, [0.001, 0.002, 0.0079, *ROTATION], atol=1e-15)


def test_random_settings_give_finite_frames_or_one_line(press):
    random = np.random.default_rng(7)
    refusals = []
    for _ in range(300):
        values = random.choice([0.0, 1e-5, 1e-3, 0.02, -0.01, 1e9, np.nan, np.inf], 5)
        try:
            settings = settings_at(Settings(), press.items[0].object, values[:3], random.normal(size=4) * values[3])
            (view,) = press.views(settings if values[4] < 0 else Settings(load=float(values[4]), rotation=settings.rotation))
        except taxelsim.InputError as error:
            refusals.append(str(error))
            continue
        assert np.isfinite(view.pose).all()
        assert np.isfinite(view.truth.total_force)
    assert 0 < len(refusals) < 300
    assert not any("\n" in line for line in refusals)


CHANGES = [Changes(law="proximity"), Changes(friction_coefficient=0.5), Changes(noise=12.0, sigma=0.001, depth_sampling="point")]


@pytest.mark.parametrize("changes", CHANGES)
def test_a_changed_sensor_is_valid(press, changes):
    taxelsim.check_sensor(changed_sensor(press.sensors[""], changes))


@pytest.mark.parametrize("changes", [Changes(law="none"), Changes(noise=-1.0), Changes(friction_coefficient=-0.5)])
def test_a_wrong_change_is_refused_in_one_line(press, changes):
    with pytest.raises(taxelsim.InputError, match=r"^[^\n]+$"):
        taxelsim.check_sensor(changed_sensor(press.sensors[""], changes))
