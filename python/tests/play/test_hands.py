"""The playground of a scene of kind grasp: forces by a closed form, programs that repeat images byte for byte, sliders and drags."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import taxelsim

pytest.importorskip("viser", reason="viser as in python/requirements/test.txt")

from taxelsim.play import Playground
from taxelsim.play.changes import Changes
from taxelsim.play.playground import robot_press_of
from taxelsim.play.skins import UNITS
from taxelsim.play.texts import robot_program_text

from .test_server import wait_until

SCENE = taxelsim.SCENES / "gripper_grasp.yaml"
DEPTH = 1e-4  # m, of both jaws in the box
TOUCH = 0.04 - 0.015  # m, position of the joint `jaw` at first contact: from 40 mm to the side of the box of 30 mm
BEND = -0.3  # rad, away from the box
FORCE_ROUNDING = 1e-5  # relative; depths are differences of poses of 0.1 m in single precision, 1e-8 m of DEPTH


@pytest.fixture(scope="module")
def press_and_settings(device):
    return robot_press_of(device, taxelsim.load_scene(SCENE), ())


def test_forces_are_those_of_the_closed_form(press_and_settings):
    """A flat side covers all taxels of the left pad: stiffness times depth times area."""
    press, settings = press_and_settings
    views = {view.name: view for view in press.views(replace(settings, positions=(TOUCH + DEPTH, BEND)))}
    assert list(views) == ["left", "right", "below"]
    pad = views["left"].sensor
    area = pad.num_taxels * math.prod(pad.patches[0].pitch)
    expected = pad.skin.law.normal_contact_stiffness * DEPTH * area
    assert views["left"].newtons.sum() == pytest.approx(expected, rel=FORCE_ROUNDING)
    assert views["right"].newtons.sum() > expected  # a larger sensor
    assert not views["below"].counts.any()
    assert len(press.groups) == 2  # both pads have one sensor file


def images_of_program(text, folder):
    text = text.replace("for name, image in images.items():", "np.savez('images.npz', **images)\nfor name, image in images.items():")
    subprocess.run([sys.executable, "-c", text], cwd=folder, check=True, capture_output=True)
    return np.load(folder / "images.npz")


@pytest.mark.parametrize("changes", [Changes(), Changes(friction_coefficient=0.5, noise=3.0)], ids=["own", "changed"])
def test_a_program_repeats_all_images(press_and_settings, changes, tmp_path):
    press, settings = press_and_settings
    settings = replace(settings, changes=changes, follows=True)
    press.views(replace(settings, follows=False, positions=(TOUCH + DEPTH, BEND)))
    for k in (1, 2, 3):
        turned = taxelsim.Pose((1e-5 * k, 0, 2e-5 * k), taxelsim.axis_angle((0, 1, 0), 0.01 * k))
        views = press.views(replace(settings, positions=(TOUCH + DEPTH + 1e-5 * k, BEND), objects=(turned,)))
    assert len(views[0].path) == 4
    assert views[0].counts.any()
    assert views[0].shear.any() == (changes.friction_coefficient is not None)
    images = images_of_program(robot_program_text(views, press, str(SCENE)), tmp_path)
    assert sorted(images) == sorted(view.name for view in views)
    for view in views:
        np.testing.assert_array_equal(images[view.name].reshape(-1), view.counts)


@pytest.fixture(scope="module")
def playground(device):
    playground = Playground(SCENE, device=device)
    yield playground
    playground.close()


def test_sliders_and_drags_move_joints_and_objects(playground):
    wait_until(lambda: playground.views)
    assert [view.counts.any() for view in playground.views] == [False] * 3
    sliders = {handle.label: handle for handle in playground._server.gui._gui_input_handle_from_uuid.values()}
    sliders["jaw, mm"].value = 1e3 * (TOUCH + DEPTH)
    wait_until(lambda: playground.views[0].counts.any() and playground.views[1].counts.any())
    handles = playground._scene._handles[0]
    handles.position = (0.0, UNITS * -2 * DEPTH, 0.0)
    playground._drag(0, handles)
    wait_until(lambda: not playground.views[0].counts.any())
    assert playground.views[1].counts.any()
    assert len(playground._panels._figures) == 3
    assert f"\nSCENE = {str(SCENE)!r}\n" in playground._program()


@pytest.mark.parametrize("values", [(np.nan, 0, 0), (np.inf, 0, 0)])
def test_a_pose_that_is_not_finite_is_one_line_on_the_page(playground, values):
    handles = playground._scene._handles[0]
    handles.position = values
    playground._drag(0, handles)
    assert playground._status.value.startswith("position: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((taxelsim.SCENES / "edge_servo.yaml",), "kind: servo is not allowed: a sensor file, or a scene of kind grasp"),
        ((SCENE, ["sphere:0.01"]), "objects: sphere:0.01 is not allowed: a scene has its own objects"),
    ],
)
def test_wrong_scenes_are_refused_in_one_line(arguments, message, device):
    with pytest.raises(taxelsim.InputError, match=f"^[^\n]*{message}$"):
        Playground(*arguments, device=device)
