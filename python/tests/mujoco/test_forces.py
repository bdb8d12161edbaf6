"""Frames that carry the forces of MuJoCo's contacts: weights at rest, several objects, batches, refusals, the warning."""

import logging

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
from taxelsim import _log
from taxelsim.mujoco.batch import STATE, Batch

from .models import WTS, mujoco_4

G = 9.81  # m/s^2
SENSORS = taxelsim.SCENES / "sensors"
TRUE = taxelsim.OutputOptions(tactile_normal_force=True, tactile_shear_force=False, penetration_depth=False)


def resting(*masses: float, above: float = 3e-4, angle: float = 0) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Boxes at rest on a pad, 24 mm apart along y of the site. above: m, of the site over the geom that carries them: sets the depth.
    angle: degrees, of pad and gravity about x together.
    """
    boxes = "".join(
        f'<body name="b{k}" pos="0 {0.012 * (2 * k + 1 - len(masses)):g} .0051"><freejoint/>'
        f'<geom name="b{k}" type="box" size=".004 .004 .005" mass="{mass}"/></body>'
        for k, mass in enumerate(masses)
    )
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="0.001" gravity="0 0 -{G}"/><worldbody>
      <body name="pad"><geom name="pad" type="box" size=".02 .03 .005" pos="0 0 -.005"/>
      <site name="palm" pos="0 0 {above}" euler="0 0 {angle}"/></body>{boxes}</worldbody></mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 1500)
    return model, data


@pytest.mark.parametrize("sensor", ["wts0614_soft_cover", "wts0614_elastic_layer", "fingertip_6x4"])
@pytest.mark.parametrize("above", [1e-4, 8e-4])
def test_a_pad_carries_the_weight_whatever_the_depth(device: taxelsim.Device, sensor: str, above: float) -> None:
    model, data = resting(0.1, above=above, angle=25)
    tactile = taxelsim.mujoco.attach(model, {"palm": SENSORS / f"{sensor}.yaml"}, ["b0"], device=device)
    before = data.qpos.copy(), data.qacc.copy(), data.contact.pos.copy()
    frame = tactile.observe(data, forces="engine")["palm"]
    assert frame.ground_truth.contact_wrench[0, 2] == pytest.approx(-0.1 * G, rel=1e-3)
    assert frame.ground_truth.load_reached[0]
    assert all(map(np.array_equal, before, (data.qpos, data.qacc, data.contact.pos)))  # observe() only reads
    by_pose = tactile.observe(data)["palm"].ground_truth.contact_wrench[0, 2]
    assert abs(by_pose + 0.1 * G) > 0.1 * G * 0.2
    assert tactile.observe(data, forces="engine")["palm"].ground_truth.contact_wrench[0, 2] == pytest.approx(-0.1 * G, rel=1e-3)


def test_each_object_presses_with_its_own_weight(device: taxelsim.Device) -> None:
    model, data = resting(0.03, 0.09)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["b0", "b1"], device=device, outputs=TRUE)
    forces = tactile.observe(data, forces="engine")["palm"].ground_truth.tactile_normal_force[0]
    halves = forces[:, :7].sum(), forces[:, 7:].sum()  # columns go along y
    assert halves == pytest.approx((0.03 * G, 0.09 * G), rel=1e-3)


GRIPPER = """<mujoco><option timestep="0.001" integrator="implicitfast" cone="elliptic" impratio="10"/><worldbody>
  <body name="left" pos="-.03 0 .1"><joint name="l" type="slide" axis="1 0 0" damping="5"/>
    <geom type="box" size=".005 .01 .02" mass=".1" pos="-.005 0 0"/><site name="a" pos=".0003 0 0" euler="0 90 0"/></body>
  <body name="right" pos=".03 0 .1"><joint name="r" type="slide" axis="-1 0 0" damping="5"/>
    <geom type="box" size=".005 .01 .02" mass=".1" pos=".005 0 0"/><site name="b" pos="-.0003 0 0" euler="0 -90 0"/></body>
  <body name="held" pos="0 0 .1"><freejoint/><geom name="held" {shape} mass=".1"/></body></worldbody>
  <actuator><motor joint="l" gear="{force}"/><motor joint="r" gear="{force}"/></actuator></mujoco>"""


@pytest.mark.parametrize("sensor", ["wts0614_soft_cover", "fingertip_cylinder"])
@pytest.mark.parametrize(
    "shape", ['type="box" size=".02 .008 .008"', pytest.param('type="cylinder" size=".015 .02" euler="90 0 0"', marks=mujoco_4)]
)
def test_pads_of_a_gripper_read_the_force_of_its_motors(device: taxelsim.Device, shape: str, sensor: str) -> None:
    """The weight of the object hangs on MuJoCo's friction, which the pads do not feel."""
    model = mujoco.MjModel.from_xml_string(GRIPPER.format(shape=shape, force=3))
    data = mujoco.MjData(model)
    data.ctrl[:] = 1
    mujoco.mj_step(model, data, 1000)
    assert abs(data.qvel[:2]).max() < 1e-4
    file = SENSORS / f"{sensor}.yaml"
    tactile = taxelsim.mujoco.attach(model, {"a": file, "b": file}, ["held"], device=device)
    for frame in tactile.observe(data, forces="engine").values():
        assert frame.ground_truth.contact_wrench[0, 2] == pytest.approx(-3, rel=1e-3)


@pytest.mark.parametrize("kind", ["data", pytest.param("batch", marks=mujoco_4)])
def test_several_simulations_and_objects_without_contact(device: taxelsim.Device, kind: str) -> None:
    """An object that is lifted presses on nothing, also where the skin is above the geom that it has left."""
    model, data = resting(0.03, 0.09)
    datas = [mujoco.MjData(model) for _ in range(3)]
    for k, moved in enumerate(datas):
        moved.qpos[:] = data.qpos
        moved.qvel[:] = 0
        moved.qpos[2] += (0, 2.5e-4, 0)[k]  # out of the contact, which is 0.22 mm deep in MuJoCo 3
        moved.qpos[9] += (0, 0, 1e-2)[k]
    source = datas
    if kind == "batch":
        source = Batch(model, 3)
        for row, moved in zip(source.state, datas, strict=True):
            mujoco.mj_getState(model, moved, row, STATE)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["b0", "b1"], num_instances=3, device=device, outputs=TRUE)
    forces = tactile.observe(source, forces="engine")["palm"].ground_truth.tactile_normal_force
    left, right = forces[..., :7].sum((1, 2)), forces[..., 7:].sum((1, 2))
    # Rigid boxes at rest: the forces of mj_forward() at a state of rest are the weights.
    np.testing.assert_allclose(left, [0.03 * G, 0, 0.03 * G], rtol=2e-3)
    np.testing.assert_allclose(right, [0.09 * G, 0.09 * G, 0], rtol=2e-3)


def test_a_difference_is_said_once(device: taxelsim.Device, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_log, "_warned", set())
    model, data = resting(0.1)
    with caplog.at_level(logging.WARNING, "taxelsim"):
        tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["b0"], device=device)
        for _ in range(3):
            tactile.observe(data)
    messages = [record.getMessage() for record in caplog.records if "observe(forces='engine')" in record.getMessage()]
    assert len(messages) == 1
    assert "MuJoCo's contacts have 0.981 N" in messages[0]
    caplog.clear()
    raised = tactile.observe(data, forces="engine")["palm"].ground_truth.load_offset[0]  # m, to where the skin carries the weight
    model, data = resting(0.1, above=3e-4 - raised)
    near = taxelsim.mujoco.attach(model, {"palm": WTS}, ["b0"], device=device)
    near.observe(data)
    assert not [record for record in caplog.records if "MuJoCo's contacts" in record.getMessage()]


def test_what_has_no_normal_forces_is_refused(device: taxelsim.Device) -> None:
    model, data = resting(0.1)
    for file, message in (("wts0614_lugre", "not allowed on a skin with friction"), ("wts0614_proximity", "which has no forces")):
        tactile = taxelsim.mujoco.attach(model, {"palm": SENSORS / f"{file}.yaml"}, ["b0"], device=device)
        with pytest.raises(
            taxelsim.InputError, match=rf"site 'palm': forces='engine' is not allowed .*{message.split('not allowed ')[-1]}"
        ):
            tactile.observe(data, forces="engine")
    with pytest.raises(taxelsim.InputError, match="forces: 'both' is not allowed: skin, engine"):
        tactile.observe(data, forces="both")


def test_loads_of_the_caller_drive_the_skin(device: taxelsim.Device) -> None:
    model, data = resting(0.1)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["b0"], device=device)
    tactile.simulators["palm"].set_loads(0.5)
    assert tactile.observe(data)["palm"].ground_truth.contact_wrench[0, 2] == pytest.approx(-0.5, rel=1e-3)
