"""Frames from the state of MuJoCo's simulations: stages, batches, slots, shear, refused input."""

import importlib
import sys

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
from taxelsim.mujoco.batch import STATE, Batch

from .models import WTS, direct, mujoco_4, place, scene

N = 5
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return scene()


def moving(model: mujoco.MjModel) -> list[mujoco.MjData]:
    """Balls at several depths and places that move by 0.1 mm in a time step."""
    datas = [mujoco.MjData(model) for _ in range(N)]
    for k, data in enumerate(datas):
        place(model, data, (0.001 * k, -0.002 * k, 0.0095 - 0.0001 * k, *UPRIGHT))
        data.qvel[6:9] = data.site("palm").xmat.reshape(3, 3) @ [0, 0, -0.1]
    return datas


@mujoco_4
def test_a_batch_gives_the_frames_of_its_simulations(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    datas = moving(model)
    batch = Batch(model, N)
    for row, data in zip(batch.state, datas, strict=True):
        mujoco.mj_getState(model, data, row, STATE)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["ball"], num_instances=N, device=device)
    batch.step()
    for data in datas:
        mujoco.mj_step(model, data)
    of_batch = tactile.observe(batch)["palm"].copy()
    of_data = tactile.observe(datas)["palm"]
    assert of_data.ground_truth.total_force.min() > 0
    np.testing.assert_array_equal(of_batch.tactile_image, of_data.tactile_image)
    np.testing.assert_array_equal(of_batch.ground_truth.contact_wrench, of_data.ground_truth.contact_wrench)


def test_poses_are_not_a_step_late(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    datas = moving(model)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["ball"], num_instances=N, device=device)
    for data in datas:
        mujoco.mj_step(model, data)
    late = datas[0].geom("ball").xpos.copy()
    of_data = tactile.observe(datas)["palm"]
    np.testing.assert_array_equal(datas[0].geom("ball").xpos, late)  # observe() only reads
    poses = []
    for data in datas:
        stale = data.geom("ball").xpos.copy()
        mujoco.mj_kinematics(model, data)
        assert np.linalg.norm(data.geom("ball").xpos - stale) > 0.9e-4  # a step late would be visible
        rotation, origin = data.site("palm").xmat.reshape(3, 3), data.site("palm").xpos
        poses.append((*(rotation.T @ (data.geom("ball").xpos - origin)), *UPRIGHT))
    expected = direct(device, taxelsim.Sphere(radius=0.01), *poses).ground_truth.penetration_depth
    np.testing.assert_allclose(of_data.ground_truth.penetration_depth, expected, atol=1e-9)  # m, rounding of poses


def test_one_mjdata(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    data = moving(model)[0]
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["ball"], device=device)
    assert tactile.observe(data)["palm"].total_force.shape == (1,)


@mujoco_4
def test_positions_that_differ_between_simulations(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    batch = Batch(model, N)
    data = moving(model)[0]
    for row in batch.state:
        mujoco.mj_getState(model, data, row, STATE)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["ball"], num_instances=N, device=device)
    lift = data.site("palm").xmat.reshape(3, 3) @ [0, 0, 1]
    turned = np.empty(3)
    mujoco.mju_rotVecQuat(turned, lift, data.qpos[10:] * (1, -1, -1, -1))
    batch.expand("geom_pos")[:, model.geom("ball").id] += np.linspace(0, 0.001, N)[:, np.newaxis] * turned
    batch.expand("geom_sameframe")[:] = 0
    force = tactile.observe(batch)["palm"].ground_truth.total_force
    assert (np.diff(force) <= 0).all()
    assert force[0] > 0.1
    assert force[-1] == 0


def test_several_sensors_and_geoms(device: taxelsim.Device) -> None:
    """Every geom touches every sensor; a site of its own gives a sensor of its own."""
    model = scene(
        '<geom name="ball" size=".01"/><geom name="other" size=".01" pos=".02 0 0"/>',
        pad='<site name="side" pos=".03 0 .02" euler="5 10 15"/>',
    )
    data = mujoco.MjData(model)
    place(model, data, (0, 0, 0.0095, *UPRIGHT))
    sensors = {"palm": WTS, "side": taxelsim.SCENES / "sensors/fingertip_sphere.yaml"}
    frames = taxelsim.mujoco.attach(model, sensors, device=device).observe(data)
    assert set(frames) == {"palm", "side"}
    one = direct(device, taxelsim.Sphere(radius=0.01), (0, 0, 0.0095, *UPRIGHT))
    assert frames["palm"].ground_truth.total_force[0] == pytest.approx(one.ground_truth.total_force[0], rel=1e-5)
    assert frames["side"].ground_truth.total_force[0] > 0.05


def many_balls(count: int) -> mujoco.MjModel:
    """Balls in a row along x of the site, 3 mm apart, all 0.5 mm deep."""
    return scene("".join(f'<geom name="ball{k}" size=".001" pos="{0.003 * (k - 4)} 0 0"/>' for k in range(count)))


def test_more_geoms_than_slots(device: taxelsim.Device) -> None:
    """Of 30 balls only a few are near; as the row passes, slots change hands."""
    model = many_balls(30)
    data = mujoco.MjData(model)
    sensor = taxelsim.load_sensor(WTS).replace(patches=[taxelsim.GridPatch(num_rows=1, num_cols=1, pitch=(0.003, 0.003))])
    tactile = taxelsim.mujoco.attach(model, {"palm": sensor}, [f"ball{k}" for k in range(30)], device=device)
    for shift in np.linspace(0.02, -0.08, 40):
        place(model, data, (shift, 0, 0.0005, *UPRIGHT))
        truth = tactile.observe(data)["palm"].ground_truth
        centres = np.abs(0.003 * (np.arange(30) - 4) + shift)
        assert (truth.total_force[0] > 0) == (centres.min() < 0.0015 + 0.0005)


def test_too_many_near_geoms(device: taxelsim.Device) -> None:
    model = many_balls(9)
    data = mujoco.MjData(model)
    place(model, data, (0, 0, 0.0005, *UPRIGHT))
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, device=device)
    with pytest.raises(taxelsim.InputError, match=r"^instance 0: 9 geoms are near site 'palm', at most 8 allowed; name fewer in geoms="):
        tactile.observe(data)
    place(model, data, (0, 0, 0.5, *UPRIGHT))
    assert tactile.observe(data)["palm"].total_force == 0


@pytest.mark.parametrize("mover", ["object", "pad"])
def test_shear_from_relative_motion(device: taxelsim.Device, mover: str) -> None:
    """The object slides along +x of the sensor, or the sensor along -x under it: the same positive shear."""
    model = scene()
    data = mujoco.MjData(model)
    place(model, data, (0, 0, 0.0095, *UPRIGHT))
    sensor = taxelsim.load_sensor(WTS)
    skin = sensor.skin.replace(friction=taxelsim.Friction(tangential_stiffness=5e7, friction_coefficient=0.8))
    tactile = taxelsim.mujoco.attach(model, {"palm": sensor.replace(skin=skin)}, ["ball"], device=device)
    assert tactile.observe(data)["palm"].ground_truth.contact_wrench[0, 0] == 0
    along = data.site("palm").xmat.reshape(3, 3) @ [5e-5, 0, 0]
    data.joint(0 if mover == "pad" else 1).qpos[:3] += -along if mover == "pad" else along
    truth = tactile.observe(data)["palm"].ground_truth
    # Stick: stiffness times displacement times area; the rim slips, so that less than all of the contact sticks.
    area = 2 * np.pi * 0.01 * 0.0005  # m^2, of the cap of height 0.5 mm
    assert 0.5 < truth.contact_wrench[0, 0] / (5e7 * 5e-5 * area) < 1.05
    tactile.reset()
    assert tactile.observe(data)["palm"].ground_truth.contact_wrench[0, 0] == 0


def test_names(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    def attach(*arguments: object, source: mujoco.MjModel = model) -> None:
        taxelsim.mujoco.attach(source, *arguments, device=device)  # type: ignore[arg-type]

    def message(*arguments: object, **keywords: mujoco.MjModel) -> str:
        with pytest.raises(taxelsim.InputError) as caught:
            attach(*arguments, **keywords)
        return str(caught.value)

    assert message({"plam": WTS}) == "site 'plam' is not in the model; it has 'palm'"
    assert message({"palm": WTS}, ["bal"]) == "geom 'bal' is not in the model; it has 'base', 'ball'"
    assert message({"palm": WTS}, ["ball", "ball"]) == "geoms: geom 'ball' is listed twice"
    assert message({"palm": WTS}, [7]) == "geom number 7 is not in the model, which has 2"
    assert message({"palm": WTS}, []) == "geoms: at least one is needed"
    assert message({}) == "sensors: at least one is needed, as {site: sensor file}"
    empty = mujoco.MjModel.from_xml_string('<mujoco><worldbody><site name="palm"/></worldbody></mujoco>')
    assert message({"palm": WTS}, source=empty) == "the model has no geoms that a sensor could touch"
    assert "missing.yaml" in message({"palm": "missing.yaml"})


def test_without_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.split(".")[0] == "mujoco" or name.startswith("taxelsim.mujoco")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ImportError, match=r"^taxelsim.mujoco needs MuJoCo 3.3 or newer: pip install 'taxelsim\[mujoco\]'$"):
        importlib.import_module("taxelsim.mujoco")


def test_wrong_sources(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["ball"], num_instances=N, device=device)
    with pytest.raises(taxelsim.InputError, match=rf"^MjData: 1 simulations found, {N} attached$"):
        tactile.observe(mujoco.MjData(model))
    with pytest.raises(taxelsim.InputError, match=r"^MjData of another model: ngeom is 3, 2 in the attached model$"):
        tactile.observe([mujoco.MjData(many_balls(2))] * N)
    with pytest.raises(taxelsim.InputError, match=r"^int is not allowed: MjData, a sequence of MjData, or mujoco.batch.Batch$"):
        tactile.observe([1] * N)


@mujoco_4
def test_wrong_batches(device: taxelsim.Device, model: mujoco.MjModel) -> None:
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["ball"], num_instances=N, device=device)
    with pytest.raises(taxelsim.InputError, match=rf"^Batch: 3 simulations found, {N} attached$"):
        tactile.observe(Batch(model, 3))
    with pytest.raises(taxelsim.InputError, match=r"^Batch of another model: ngeom is 3, 2 in the attached model$"):
        tactile.observe(Batch(many_balls(2), N))
    sizes = Batch(model, N)
    sizes.expand("geom_size")
    with pytest.raises(taxelsim.InputError, match=r"^Batch with expanded geom_size"):
        tactile.observe(sizes)
