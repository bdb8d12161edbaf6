"""Touch in environments of Gymnasium. Those of other packages: robots.py."""

import copy

import gymnasium
import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
from taxelsim.mujoco.environments import TactileObservation

FEET = ("left_ankle_geom", "right_ankle_geom", "third_ankle_geom", "fourth_ankle_geom")
NAMES = ("tactile_image", "binary_contact", "center_of_pressure", "shear_image")
RAISED = 0.02  # m, of the skin over the foot, which MuJoCo keeps 0 to 1 cm above the floor
PITCH, RADIUS = 0.04, 0.08 + RAISED  # m, of the taxels, and of the skin of a foot
# m. A taxel is flat: its corners lie over the round skin. Of its four samples a side, two are in a contact that is this deep.
LIFTED, LEAST_DEPTH = PITCH**2 / 2 / (2 * RADIUS), (PITCH / 4) ** 2 / (2 * RADIUS)


@pytest.fixture(scope="module")
def env(device: taxelsim.Device) -> TactileObservation:
    """Ant with taxels around its four feet, which have one shape."""

    def feet(model: mujoco.MjModel) -> dict[str, taxelsim.mujoco.GeomSensor]:
        foot = taxelsim.mujoco.cover_geom(model, FEET[0], PITCH, raised=RAISED)
        return {name: taxelsim.mujoco.GeomSensor(foot.sensor, model.geom(name).id, foot.X_GS) for name in FEET}

    return TactileObservation(gymnasium.make("Ant-v5"), feet, ["floor"], device=device, observations=NAMES)


def depth(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> float:
    """m, of the skin of a foot, a capsule along z of its geom, in the floor."""
    now = copy.copy(data)
    mujoco.mj_kinematics(model, now)
    radius, half_length, _ = model.geom(name).size
    return float(RAISED + radius + half_length * abs(now.geom(name).xmat[8]) - now.geom(name).xpos[2])


def test_feet_feel_the_floor_when_they_touch_it(env: TactileObservation) -> None:
    model, data = env.unwrapped.model, env.unwrapped.data
    observation, _ = env.reset(seed=1)
    felt, depths = [], []
    for step in range(60):
        assert env.observation_space.contains(observation)
        np.testing.assert_array_equal(observation["observation"], env.unwrapped._get_obs())
        felt += [observation[f"{name}/binary_contact"][0] == 1 for name in FEET]
        assert [(observation[f"{name}/tactile_image"] > 0).any() for name in FEET] == felt[-4:]
        depths += [depth(model, data, name) for name in FEET]
        observation, *_ = env.step(np.sin(step / 3 + np.arange(8)))
    felt, depths = np.array(felt), np.array(depths)
    assert felt[depths > LEAST_DEPTH].all()
    assert not felt[depths < -LIFTED].any()
    assert min((depths > LEAST_DEPTH).sum(), (depths < -LIFTED).sum()) > 10


def test_sensors_move_to_a_new_model(env: TactileObservation) -> None:
    before = env.touch.tactile
    env.reset(seed=1)
    assert env.touch.tactile is before
    env.unwrapped.model = copy.copy(env.unwrapped.model)
    env.unwrapped.data = mujoco.MjData(env.unwrapped.model)
    env.reset(seed=1)
    assert env.touch.tactile.model is env.unwrapped.model


def test_refused_input(env: TactileObservation, device: taxelsim.Device) -> None:
    with pytest.raises(taxelsim.InputError, match=r"^env: CartPoleEnv without 'model' is not allowed: environments of MuJoCo$"):
        TactileObservation(gymnasium.make("CartPole-v1"), {}, device=device)
    with pytest.raises(taxelsim.InputError, match=r"^observations: 'image' is not allowed: contact, tactile_image"):
        TactileObservation(env.env, {}, device=device, observations="image")
    sensors = {name: taxelsim.mujoco.GeomSensor(env.touch.tactile.sensors[name], 4, taxelsim.Pose()) for name in FEET}
    with pytest.raises(
        taxelsim.InputError, match=r"^sensors: 'fourth_ankle_geom/tactile_image' is an observation of the environment already$"
    ):
        TactileObservation(env, sensors, ["floor"], device=device)
