"""Two-way coupling: weight at rest, energy after release, several sensors on one body, refused models."""

from typing import Any

import mujoco
import numpy as np
import pytest
from mujoco.batch import Batch

import taxelsim
import taxelsim.mujoco

from .models import WTS

GRAVITY = 9.81
MASSES = np.array([0.02, 0.1, 1.0])  # kg
WEIGHT_TOLERANCE = 0.005  # an object at rest shows its weight within 0.5 %
ENERGY_TOLERANCE = 0.01  # of the work put in
BOX = '<geom name="box" type="box" size=".02 .03 .01" mass="1"/>'  # covers the array
SKINS = {
    "stiff": {"law": taxelsim.Winkler(normal_contact_stiffness=2.5e9)},
    "friction": {"friction": taxelsim.Friction(tangential_stiffness=5e7, friction_coefficient=0.5)},
    "lugre": {"law": taxelsim.LuGre(normal_contact_stiffness=1.73e8)},
}


def model_of(geom: str, *, gravity: float = GRAVITY, options: str = "", pad: str = "", extra: str = "") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
      <option timestep="0.001" gravity="0 0 {-gravity}" {options}/>
      <worldbody>
        <body name="pad"><site name="palm"/>{pad}</body>
        <body name="object" pos="0 0 .01"><freejoint/>{geom}</body>
      </worldbody>{extra}
    </mujoco>""")


def batch_of(model: mujoco.MjModel, masses: np.ndarray) -> Any:
    batch = Batch(model, len(masses))
    body = model.body("object").id
    batch.expand("body_mass")[:, body] = masses
    batch.expand("body_inertia")[:, body] = model.body_inertia[body] * masses[:, np.newaxis]
    batch.set_const()
    return batch


def sensor_of(skin: str) -> taxelsim.Sensor:
    sensor = taxelsim.load_sensor(WTS)
    return sensor.replace(skin=sensor.skin.replace(**SKINS[skin]))


@pytest.mark.parametrize("skin", ["stiff", "friction", "lugre"])
def test_weight_at_rest(device: taxelsim.Device, skin: str) -> None:
    """The stiff skin carries 20 g on the whole array: explicit forces would need time steps of 0.2 ms."""
    batch = batch_of(model_of(BOX), MASSES)
    tactile = taxelsim.mujoco.couple(batch.model, {"palm": sensor_of(skin)}, num_instances=3, device=device)
    truth = tactile.step(batch, 200)["palm"].ground_truth
    np.testing.assert_allclose(-truth.contact_wrench[:, 2] / (MASSES * GRAVITY), 1, atol=WEIGHT_TOLERANCE)
    np.testing.assert_allclose(-tactile.wrenches["palm"][:, 0, 2] / (MASSES * GRAVITY), 1, atol=WEIGHT_TOLERANCE)
    assert np.abs(batch.qvel).max() < 1e-3


def test_large_contact_on_an_elastic_layer(device: taxelsim.Device) -> None:
    """A box over the whole array, thrown: the device's wrench Jacobian would take more loop iterations than software Vulkan allows."""
    batch = batch_of(model_of(BOX, gravity=0), np.array([0.3]))
    elastic = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_elastic_layer.yaml")
    tactile = taxelsim.mujoco.couple(batch.model, {"palm": elastic}, device=device)
    batch.qvel[:, 2] = -0.2  # m/s
    batch.qvel[:, 3] = 0.5  # rad/s
    touched = False
    for _ in range(20):
        truth = tactile.step(batch)["palm"].ground_truth
        touched |= bool(truth.contact_wrench[0, 2] < -10)
    assert touched
    assert truth.contact_wrench[0, 2] == 0
    assert 0 < batch.qvel[0, 2] < 0.2  # thrown back, with less than it had


def test_light_weight_on_an_elastic_layer(device: taxelsim.Device) -> None:
    """20 g on the whole array press this stiff skin by 0.1 um, less than the usual shift of the finite differences."""
    batch = batch_of(model_of(BOX), np.array([0.02]))
    elastic = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_elastic_layer.yaml")
    tactile = taxelsim.mujoco.couple(batch.model, {"palm": elastic}, device=device)
    tactile.step(batch, 20)
    wrenches = []
    for _ in range(20):
        tactile.step(batch)
        wrenches.append(-tactile.wrenches["palm"][0, 0, 2] / (0.02 * GRAVITY))
    assert np.mean(wrenches) == pytest.approx(1, abs=WEIGHT_TOLERANCE)
    # One nanometre, two float32 roundings of heights of 10 mm, is 1 % of the weight.
    assert np.abs(np.array(wrenches) - 1).max() < 0.02


@pytest.mark.parametrize("skin", ["stiff", "lugre"])
def test_energy_after_release(device: taxelsim.Device, skin: str) -> None:
    """Boxes hit the skin with an edge; every other one is pressed against it by a force."""
    masses = np.repeat(MASSES, 4)
    batch = batch_of(model_of(BOX, gravity=0), masses)
    inertia = np.asarray(batch.expanded("body_inertia"))[:, -1]
    random = np.random.default_rng(3)
    batch.qpos[:, 2] += 0.0005
    batch.qvel[:, 2] = -0.4
    batch.qvel[:, 3:] = random.normal(size=(12, 3)) * 3

    def kinetic() -> np.ndarray:
        return (masses * (batch.qvel[:, :3] ** 2).sum(axis=1) + (inertia * batch.qvel[:, 3:] ** 2).sum(axis=1)) / 2

    tactile = taxelsim.mujoco.couple(batch.model, {"palm": sensor_of(skin)}, num_instances=12, device=device)
    put_in, touched = kinetic(), np.zeros(12, bool)
    for k in range(100):
        force = np.where((np.arange(12) % 2 == 0) & (k < 40), 50 * masses, 0)
        batch.xfrc_applied[:, -1, 2] = -force
        velocity = batch.qvel[:, 2].copy()
        force_now = tactile.step(batch)["palm"].ground_truth.contact_wrench[:, 2]
        # A force changes the kinetic energy in a time step by its product with the mean of the velocities before and after.
        put_in -= force * 0.001 * (velocity + batch.qvel[:, 2]) / 2
        touched |= force_now < 0
    assert touched.all()
    released = force_now == 0
    assert released.sum() >= 4
    assert (kinetic()[released] <= (1 + ENERGY_TOLERANCE) * put_in[released]).all()


def test_no_energy_from_the_border(device: taxelsim.Device) -> None:
    """A ball slides onto the array below the level of the skin. Pressure without sideways force would lift it at no cost."""
    model = mujoco.MjModel.from_xml_string("""<mujoco>
      <option timestep="0.001" gravity="0 0 0"/>
      <worldbody>
        <body><site name="palm"/></body>
        <body name="object" pos=".0165 0 .0085"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
          <geom name="ball" size=".01" mass=".1"/></body>
      </worldbody></mujoco>""")
    data = mujoco.MjData(model)
    data.qvel[0] = -0.3
    tactile = taxelsim.mujoco.couple(model, {"palm": WTS}, ["ball"], device=device)
    put_in, largest_force = 0.1 * 0.3**2 / 2, 0.0
    for _ in range(60):
        frame = tactile.step(data)["palm"]
        largest_force = max(largest_force, float(frame.ground_truth.total_force[0]))
        assert 0.1 * (data.qvel**2).sum() / 2 <= (1 + ENERGY_TOLERANCE) * put_in
    assert largest_force > 5


def test_batch_equals_mjdata(device: taxelsim.Device) -> None:
    model = model_of(BOX)
    batch, data = Batch(model, 1), mujoco.MjData(model)
    couplings = [taxelsim.mujoco.couple(model, {"palm": WTS}, device=device) for _ in range(2)]
    data.qfrc_applied[2] = batch.qfrc_applied[0, 2] = -3  # N, the caller's own
    for _ in range(20):
        frames = [couplings[0].step(batch)["palm"], couplings[1].step(data)["palm"]]
    assert frames[0].ground_truth.total_force > 1
    np.testing.assert_array_equal(frames[0].tactile_image, frames[1].tactile_image)
    np.testing.assert_array_equal(batch.qpos[0], data.qpos)
    assert data.qfrc_applied[2] == batch.qfrc_applied[0, 2] == -3


def test_two_pads_hold_an_object(device: taxelsim.Device) -> None:
    """Two pads on actuated slides squeeze a ball of 20 g: both sensors act on one body in one implicit step. Friction carries it."""
    model = mujoco.MjModel.from_xml_string("""<mujoco>
      <option timestep="0.001" integrator="implicitfast"/>
      <worldbody>
        <body name="left" pos="0 -.0097 0">
          <joint name="l" type="slide" axis="0 1 0"/><inertial pos="0 0 0" mass=".1" diaginertia="1e-5 1e-5 1e-5"/>
          <site name="left" zaxis="0 1 0"/></body>
        <body name="right" pos="0 .0097 0">
          <joint name="r" type="slide" axis="0 -1 0"/><inertial pos="0 0 0" mass=".1" diaginertia="1e-5 1e-5 1e-5"/>
          <site name="right" zaxis="0 -1 0"/></body>
        <body name="ball"><freejoint/><geom name="ball" size=".01" mass=".02"/></body>
      </worldbody>
      <actuator><motor joint="l"/><motor joint="r"/></actuator></mujoco>""")
    batch = Batch(model, 1)
    skin = sensor_of("friction")
    tactile = taxelsim.mujoco.couple(model, {"left": skin, "right": skin}, ["ball"], device=device)
    batch.ctrl[:] = 2  # N
    frames = tactile.step(batch, 200)
    for name in ("left", "right"):
        assert -frames[name].ground_truth.contact_wrench[0, 2] == pytest.approx(2, rel=0.02)
    # 0.2 N of weight on two pads with 2 N each and a coefficient of 0.5: the ball stays.
    assert np.abs(batch.qpos[0, 2:5]).max() < 0.001
    for frame in frames.values():
        assert np.linalg.norm(frame.ground_truth.contact_wrench[0, :2]) == pytest.approx(0.02 * GRAVITY / 2, rel=0.05)


def test_several_objects(device: taxelsim.Device) -> None:
    """Each object feels its own force; the frame shows the sum."""
    balls = '<body pos="0 {y} .0095"><freejoint/><geom name="{n}" size=".01" mass="{m}"/></body>'
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.001"/><worldbody><body><site name="palm"/></body>
        {balls.format(y=-0.0136, n="a", m=0.05)}{balls.format(y=0.0136, n="b", m=0.1)}
        </worldbody><contact><exclude body1="world" body2="world"/></contact></mujoco>"""
    )
    data = mujoco.MjData(model)
    tactile = taxelsim.mujoco.couple(model, {"palm": WTS}, ["a", "b"], device=device)
    wrench = np.zeros((2, 6))
    for _ in range(200):
        frame = tactile.step(data)["palm"]
        wrench += tactile.wrenches["palm"][0] / 200
    assert wrench[0, 2] == pytest.approx(-0.05 * GRAVITY, rel=0.1)  # mean over bounces
    assert wrench[1, 2] == pytest.approx(-0.1 * GRAVITY, rel=0.1)
    assert frame.ground_truth.contact_wrench[0, 2] < 0


def test_reset_of_one_instance(device: taxelsim.Device) -> None:
    batch = batch_of(model_of(BOX), MASSES)
    tactile = taxelsim.mujoco.couple(batch.model, {"palm": WTS}, num_instances=3, device=device)
    tactile.step(batch, 20)
    batch.reset(np.array([1]))
    batch.qpos[1, 2] = 0.05
    tactile.reset([1])
    frame = tactile.observe(batch, instances=[1])["palm"]
    force = frame.ground_truth.contact_wrench[:, 2].copy()
    assert force[1] == 0
    assert force[0] < 0
    after = tactile.step(batch)["palm"].ground_truth.contact_wrench[:, 2]
    assert after[1] == 0
    assert after[0] < 0


def test_mocap_pad_lifts(device: taxelsim.Device) -> None:
    """The pad is a mocap body: its motion does work that no joint velocity shows."""
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
      <option timestep="0.001"/>
      <worldbody>
        <body name="pad" mocap="true"><site name="palm"/></body>
        <body name="object" pos="0 0 .00999"><freejoint/>{BOX}</body>
      </worldbody></mujoco>""")
    data = mujoco.MjData(model)
    tactile = taxelsim.mujoco.couple(model, {"palm": WTS}, device=device)
    for _ in range(100):
        data.mocap_pos[0, 2] += 1e-4  # m: 0.1 m/s
        tactile.step(data)
    assert data.qpos[2] - 0.01 == pytest.approx(data.mocap_pos[0, 2], abs=1e-4)
    assert data.qvel[2] == pytest.approx(0.1, rel=0.01)


def test_refused(device: taxelsim.Device) -> None:
    def message(model: mujoco.MjModel, sensor: Any = WTS) -> str:
        with pytest.raises(taxelsim.InputError) as caught:
            taxelsim.mujoco.couple(model, {"palm": sensor}, ["box"], device=device)
        return str(caught.value)

    pad = '<geom name="base" type="box" size=".02 .03 .005" pos="0 0 -.005"/>'
    found = message(model_of(BOX, pad=pad))
    assert found.startswith(
        "geom 'box' and geom 'base', on the body of site 'palm', collide in MuJoCo as well: exclude their bodies by <contact>"
    )
    off = model_of(BOX, pad=pad, extra='<contact><exclude body1="pad" body2="object"/></contact>')
    taxelsim.mujoco.couple(off, {"palm": WTS}, ["box"], device=device)
    on = model_of(BOX, pad=pad, extra='<contact><exclude body1="pad" body2="object"/><pair geom1="base" geom2="box"/></contact>')
    assert "collide in MuJoCo as well" in message(on)
    assert (
        message(model_of(BOX, options='integrator="RK4"'))
        == "integrator RK4 is not allowed: two-way coupling takes Euler, implicit, implicitfast"
    )
    proximity = taxelsim.SCENES / "sensors/wts0614_proximity.yaml"
    assert "law proximity has no forces" in message(model_of(BOX), proximity)
