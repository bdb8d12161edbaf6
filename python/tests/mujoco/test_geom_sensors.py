"""Sensors on geoms: from a model without sites to tactile images."""

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
import taxelsim.patterns

from .models import WTS, mujoco_4

FINGERS = ("thumb", "index", "middle", "ring", "little")
# A hand without sites: five fingers on slides, whose tips are a capsule, a sphere, a box, an ellipsoid and a mesh, and a plate above them.
TIPS = {
    "thumb": 'type="capsule" size=".009" fromto="0 -.006 0 0 .006 0"',
    "index": 'type="sphere" size=".009"',
    "middle": 'type="box" size=".008 .01 .009"',
    "ring": 'type="ellipsoid" size=".009 .012 .009"',
    "little": 'type="mesh" mesh="tip"',
}
TIP_MESH = (
    "-.008 -.01 -.009  .008 -.01 -.009  -.008 .01 -.009  .008 .01 -.009  -.006 -.008 .009  .006 -.008 .009  -.006 .008 .009  .006 .008 .009"
)
OFF = 'contype="0" conaffinity="0"'
BODY = '<body pos="{} 0 0"><joint type="slide" axis="0 0 1"/><geom name="{}_tip" {} {}/></body>'
HAND = f"""<mujoco>
  <asset><mesh name="tip" vertex="{TIP_MESH}"/></asset>
  <worldbody>
    <body name="palm" pos="0 0 .1">{"".join(BODY.format(0.03 * k, finger, OFF, TIPS[finger]) for k, finger in enumerate(FINGERS))}</body>
    <body name="plate" pos=".06 0 .1295"><freejoint/><geom name="plate" type="box" size=".1 .05 .02" {OFF}/></body>
  </worldbody>
</mujoco>"""


def test_an_unknown_hand_in_fifteen_lines(device: taxelsim.Device) -> None:
    """Five fingertips of five shapes feel a plate that overlaps each of them. The lines between the marks are the user's own."""
    # begin
    model = mujoco.MjModel.from_xml_string(HAND)
    tips = [f"{finger}_tip" for finger in FINGERS]
    sensors = {tip: taxelsim.mujoco.cover_geom(model, tip, pitch=0.002, direction=(0, 0, 1), raised=0.001) for tip in tips}
    tactile = taxelsim.mujoco.attach(model, sensors, ["plate"], device=device)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    images = {tip: frame.tactile_image for tip, frame in tactile.observe(data).items()}
    # end
    for tip, image in images.items():
        assert image.shape == (1, sensors[tip].sensor.num_taxels)
        assert image.max() > 0, tip
    # The plate is 9.5 mm above the middles: tips of 9 mm, raised by 1 mm, are pressed by 0.5 mm on their tops.
    depths = {tip: simulator.read().ground_truth.penetration_depth.max() for tip, simulator in tactile.simulators.items()}
    for tip in ("middle_tip", "little_tip"):
        assert depths[tip] == pytest.approx(0.0005, abs=2e-6), tip  # flat tops; a mesh is in float32 of 20 mm
    for tip in ("thumb_tip", "index_tip", "ring_tip"):
        assert depths[tip] == pytest.approx(0.0005, abs=5e-5), tip  # a taxel lies in the tangent plane of the skin


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
def test_a_grid_on_a_turned_box_presses_as_the_sensor_alone(device: taxelsim.Device, axis: tuple[int, int, int]) -> None:
    """The same taxels and object without MuJoCo; the body and the geom are turned, the direction is that of the body."""
    size = np.array([0.02, 0.015, 0.01])
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><worldbody>
      <body name="pad" pos=".1 .2 .3" euler="20 -30 40"><freejoint/>
        <geom name="pad" type="box" size="{" ".join(map(str, size))}" pos=".01 0 0" euler="0 90 0"/></body>
      <body name="ball"><freejoint/><geom name="ball" size=".01"/></body>
    </worldbody></mujoco>""")
    placed = taxelsim.mujoco.grid_on_geom(model, "pad", 4, 5, 0.002, direction=axis, like=WTS)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    half = size[[2, 1, 0]] @ np.abs(axis)  # the geom is turned by 90 degrees about y
    rotation = data.body("pad").xmat.reshape(3, 3)
    center = data.body("pad").xpos + rotation @ ([0.01, 0, 0] + np.array(axis) * (half + 0.0095))
    data.joint(1).qpos[:3] = center
    frame = taxelsim.mujoco.attach(model, {"pad": placed}, ["ball"], device=device).observe(data)["pad"]
    assert frame.tactile_image.shape == (1, 4, 5)
    simulator = taxelsim.Simulator(taxelsim.Model(device, placed.sensor, [taxelsim.Sphere(0.01)]), 1)
    simulator.set_objects(0, [[0, 0, 0.0095, 1, 0, 0, 0]])
    simulator.step(0.001)
    expected = simulator.read()
    assert expected.total_force > 0.01
    np.testing.assert_allclose(frame.ground_truth.contact_wrench, expected.ground_truth.contact_wrench, rtol=1e-5, atol=1e-7)


@mujoco_4
def test_a_sensor_of_a_geom_is_that_of_a_site(device: taxelsim.Device) -> None:
    """Two-way coupling on a geom and on a site with the same frame take the same steps."""
    text = """<mujoco><option timestep=".001"/><worldbody>
      <geom name="pad" type="box" size=".02 .03 .01" contype="0" conaffinity="0"/><site name="pad" pos="0 0 .01"/>
      <body name="ball" pos=".001 0 .0195"><freejoint/><geom name="ball" size=".01" mass=".05"/></body>
    </worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    placed = taxelsim.mujoco.grid_on_geom(model, "pad", 6, 14, 0.0034, like=WTS)
    ends = []
    for source in (placed, placed.sensor):
        data = mujoco.MjData(model)
        taxelsim.mujoco.couple(model, {"pad": source}, ["ball"], device=device).step(data, nstep=20)
        ends.append(data.qpos.copy())
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)
    assert 0.019 < ends[0][2] < 0.0200


def test_equal_tips_share_a_model(device: taxelsim.Device) -> None:
    geoms = "".join(f'<body pos="0 0 {k}"><joint/><geom name="tip{k}" size=".008"/></body>' for k in range(3))
    model = mujoco.MjModel.from_xml_string(f'<mujoco><worldbody>{geoms}<geom name="floor" type="plane" size="1 1 1"/></worldbody></mujoco>')
    sensors = {f"tip{k}": taxelsim.mujoco.cover_geom(model, f"tip{k}", 0.002, direction=(0, 0, -1)) for k in range(3)}
    tactile = taxelsim.mujoco.attach(model, sensors, ["floor"], device=device)
    assert len({id(simulator.model) for simulator in tactile.simulators.values()}) == 1


INERTIA = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = f"""<robot name="finger"><link name="base">{INERTIA}</link>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="tip">{INERTIA}<collision><origin xyz="0.01 0 0.02" rpy="0.1 0.2 0.3"/>
    <geometry><cylinder radius="0.008" length="0.02"/></geometry></collision></link>
</robot>"""


def test_a_link_is_covered_as_mujoco_covers_it(tmp_path) -> None:
    """MuJoCo's importer of URDF places the geom; ours must put the taxels to the same places in the link."""
    file = tmp_path / "finger.urdf"
    file.write_text(URDF)
    model = mujoco.MjModel.from_xml_path(str(file))
    found = taxelsim.mujoco.cover_geom(model, "tip", 0.002, direction=(1, 0, 0))
    placed = taxelsim.patterns.cover_link(file, "tip", 0.002, direction=(1, 0, 0))
    assert placed.sensor.num_taxels == found.sensor.num_taxels > 100
    X_BG = taxelsim.Pose(list(model.geom_pos[found.geom]), list(model.geom_quat[found.geom]))
    ours = [placed.X_BS.transform(p) for p in np.asarray(placed.sensor.taxel_positions)]
    theirs = [(X_BG * found.X_GS).transform(p) for p in np.asarray(found.sensor.taxel_positions)]
    np.testing.assert_allclose(ours, theirs, atol=1e-9)


PLATE = """<mujoco><worldbody><body name="b"><geom name="a" size=".01"/><geom size=".01"/></body>
  <geom name="p" type="plane" size="1 1 1"/></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: taxelsim.mujoco.cover_geom(m, "x", 0.002), "geom 'x' is not in the model; it has 'p', 'a'"),
        (lambda m: taxelsim.mujoco.cover_geom(m, "b", 0.002), "body 'b' has 2 geoms, 1 allowed"),
        (lambda m: taxelsim.mujoco.cover_geom(m, "p", 0.002), "geom 'p' is a plane, which is not allowed"),
        (lambda m: taxelsim.mujoco.cover_geom(m, "a", 0.1), "pitch: 0.1 m is not allowed: it makes 0 taxels"),
        (lambda m: taxelsim.mujoco.cover_geom(m, "a", 0.0003), "it makes 13963 taxels, 1 to 4096 are possible"),
        (lambda m: taxelsim.mujoco.cover_geom(m, "a", 0.002, direction=(0, 0, 0)), "direction: a vector of length 0 is not allowed"),
        (lambda m: taxelsim.mujoco.cover_geom(m, "a", 0.002, direction=(0, 1, 0), half_angle=4), "half_angle: 4 is not allowed: above 0"),
        (lambda m: taxelsim.mujoco.grid_on_geom(m, "a", 6, 6, (0.1, 0.1, 0.1)), "pitch: shape (3,) is not allowed"),
        (lambda m: taxelsim.mujoco.grid_on_geom(m, "a", 6, 6, 0.002), "off the surface is not allowed: at most half a pitch"),
        (lambda m: taxelsim.mujoco.grid_on_geom(m, "a", 1, 1, 0.002, raised=-1), "raised: -1 is not allowed"),
    ],
)
def test_bad_input_is_one_line(call, message: str) -> None:
    with pytest.raises(taxelsim.InputError) as error:
        call(mujoco.MjModel.from_xml_string(PLATE))
    assert message in str(error.value)
    assert "\n" not in str(error.value)
