"""The page of a robot: kinematics by closed forms, sliders that move skins, shapes of a URDF, and refusals in one line."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest

import taxelsim

pytest.importorskip("viser", reason="viser as in python/requirements/test.txt")

from taxelsim._arrays import rotation_matrices
from taxelsim.commands.robot import main
from taxelsim.patterns.links import link_shapes
from taxelsim.play.robot_page import RobotPage
from taxelsim.play.skins import UNITS

ROBOTS = taxelsim.SCENES / "robots"
GRIPPER = ROBOTS / "gripper.yaml"
JAW, BEND = 0.01, 0.3  # m, rad
ROUNDING = 1e-12  # m; poses are in double precision
BONE_ROUNDING = 1e-5  # units of the 3-D scene; capsules are 5 units long, and their rotations are in single precision
SHOWN_ROUNDING = 1e-6  # units of the 3-D scene; positions of up to 5 units are in single precision


def places_of(jaw, bend):
    """Sensors of the gripper in W, m, by its URDF: jaws along y, and two links that bend in the plane of x and z."""
    second = bend + 0.5 * bend - 0.1
    tip = np.array([-0.05, 0, -0.02]) + 0.03 * np.array([math.cos(bend), 0, math.sin(bend)])
    return [(0, 0.04 - jaw, 0), (0, jaw - 0.04, 0), tip + 0.02 * np.array([math.cos(second), 0, math.sin(second)])]


def test_poses_are_those_of_the_closed_form():
    robot = taxelsim.Robot(GRIPPER)
    assert [joint[0] for joint in robot.joints] == ["jaw", "bend"]
    assert [name for name, _ in robot.sensors] == ["left", "right", "below"]
    poses = robot.sensor_poses([JAW, BEND])
    np.testing.assert_allclose([X_WS.position for X_WS in poses], places_of(JAW, BEND), atol=ROUNDING)
    links = dict(zip(robot.links, robot.link_poses([JAW, BEND]), strict=True))
    np.testing.assert_allclose(links["tip"].transform((0.02, 0, 0)), poses[2].position, atol=ROUNDING)
    assert links["body"] == taxelsim.Pose()
    for chain, X_WS in zip(robot.chain_points([JAW, BEND]), poses, strict=True):
        assert chain[0] == [0, 0, 0]
        np.testing.assert_allclose(chain[-1], X_WS.position, atol=ROUNDING)


@pytest.mark.parametrize("positions", [[], [0.0], [0.0, math.nan], [0.0] * 3])
def test_wrong_positions_are_refused_in_one_line(positions):
    with pytest.raises(taxelsim.InputError, match=r"^positions: [^\n]+ not allowed: 2 finite"):
        taxelsim.Robot(GRIPPER).sensor_poses(positions)


def test_a_scene_whose_robot_is_a_scene_is_refused(tmp_path):
    (tmp_path / "scene.yaml").write_text("format_version: 1\nkind: grasp\nrobot: scene.yaml\n")
    with pytest.raises(taxelsim.InputError, match=r"^[^\n]+scene.yaml:2:1: kind: unknown key; [^\n]+$"):
        taxelsim.Robot(tmp_path / "scene.yaml")


@pytest.mark.parametrize("name", ["lwr_palm", "lwr_shadow_hand", "pan_tilt", "shadow_hand"])
def test_sensors_are_where_the_program_says(name):
    file = ROBOTS / f"{name}.yaml"
    page = RobotPage(file)
    page.close()
    document = json.loads(subprocess.run([taxelsim.program.PROGRAM, "robot", file, "--json"], check=True, capture_output=True).stdout)
    initial = [joint["position"] for joint in document["joints"]]
    for X_WS, sensor in zip(page.robot.sensor_poses(initial), document["sensors"], strict=True):
        np.testing.assert_allclose(X_WS.position, sensor["X_WS"]["position"], atol=ROUNDING)
    assert all(np.isfinite(X_WL.position).all() for X_WL in page.robot.link_poses(initial))


def test_a_slider_moves_skins_arrows_and_table():
    page = RobotPage(taxelsim.SCENES / "gripper_grasp.yaml")
    try:
        sliders = {handle.label: handle for handle in page._server.gui._gui_input_handle_from_uuid.values()}
        before = page._table.content
        sliders["jaw, mm"].value = 1e3 * JAW
        sliders["bend, deg"].value = math.degrees(BEND)
        expected = UNITS * np.array(places_of(JAW, BEND))
        sizes = [sensor.num_taxels for _, sensor in page.robot.sensors]
        for skin, place in zip(np.split(page._skins._taxels.batched_positions, np.cumsum(sizes)[:-1]), expected, strict=True):
            np.testing.assert_allclose(skin.mean(0), place, atol=SHOWN_ROUNDING)
        np.testing.assert_allclose(page._drawn._arrows.points[:, 0], expected, atol=SHOWN_ROUNDING)
        assert page._drawn._arrows.points[0, 1, 1] < expected[0][1]  # the left pad faces -y
        bones = page._drawn._bones
        halves = rotation_matrices(bones.batched_wxyzs.astype(float))[:, :, 2] * bones.batched_scales[:, 2:] / 2
        chains = [UNITS * np.array(chain) for chain in page.robot.chain_points([JAW, BEND])]
        for sign, part in ((-1, slice(None, -1)), (1, slice(1, None))):
            np.testing.assert_allclose(
                bones.batched_positions + sign * halves, np.concatenate([chain[part] for chain in chains]), atol=BONE_ROUNDING
            )
        assert page._table.content != before
        assert "30.0" in page._table.content
    finally:
        page.close()


def urdf_of(*shapes):
    """A URDF of one link with shapes: (tag, geometry)."""
    text = "".join(f'<{tag}><origin xyz="0 0 1"/><geometry>{shape}</geometry></{tag}>' for tag, shape in shapes)
    return f'<robot name="r"><link name="a">{text}</link></robot>'


def test_links_are_drawn_where_joints_place_them():
    """The palm's shapes for collisions are boxes; its meshes do not ship. The wrist, which moves no sensor, stays at 0."""
    page = RobotPage(ROBOTS / "shadow_hand.yaml")
    try:
        links = dict(zip(page.robot.links, page._drawn._links, strict=True))
        np.testing.assert_allclose(links["wrist"].position, [0, 0, -0.034 * UNITS], atol=ROUNDING)  # origin of joint WRJ1
        palm = page.robot.links.index("palm")
        shapes = [name for name in page._server.scene._handle_from_node_name if name.startswith(f"/links/{palm}/")]
        assert len(shapes) == 8
        before = links["ffdistal"].position.copy()
        page.move([0.0 if joint[0] == "FFJ3" else joint[-1] for joint in page.robot.joints])
        assert np.linalg.norm(links["ffdistal"].position - before) > 0.01 * UNITS
    finally:
        page.close()


BOX, BALL, ABSENT = '<box size="1 2 3"/>', '<sphere radius="2"/>', '<mesh filename="absent.stl"/>'


@pytest.mark.parametrize(
    ("shapes", "expected"),
    [
        ([("visual", BOX), ("collision", BALL)], [taxelsim.Box([1, 2, 3])]),
        ([("visual", ABSENT), ("collision", BALL), ("collision", BOX)], [taxelsim.Sphere(2), taxelsim.Box([1, 2, 3])]),
        ([("visual", ABSENT), ("collision", ABSENT)], []),
        ([], []),
    ],
)
def test_shapes_of_links(shapes, expected, tmp_path):
    (tmp_path / "r.urdf").write_text(urdf_of(*shapes))
    found = link_shapes(tmp_path / "r.urdf")["a"]
    assert [shape for shape, _ in found] == expected
    assert all(X_LO.position == [0, 0, 1] for _, X_LO in found)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["absent.yaml"], "absent.yaml"),
        ([str(GRIPPER), "--joint", "bend=100"], "bend=100 is not allowed"),
        ([str(GRIPPER), "--closed"], "is not a scene of kind grasp"),
        ([str(GRIPPER), "--unknown"], "--unknown"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(arguments, words, capfd):
    assert main([*arguments, "--view"]) == 2
    assert words in capfd.readouterr().err


def test_the_command_serves_a_page_until_ctrl_c():
    command = [sys.executable, "-m", "taxelsim", "robot", str(taxelsim.SCENES / "shadow_grasp.yaml"), "--closed", "--view"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert "open http://127.0.0.1:" in process.stdout.readline()
            process.send_signal(2)
            assert process.wait(30) == 130
        finally:
            process.kill()
