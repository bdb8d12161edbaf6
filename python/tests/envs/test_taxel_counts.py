"""The observation `taxel_counts`: environments and policies of a sensor of three-axis taxels."""

import numpy as np
import pytest
from gymnasium import spaces

import taxelsim
from taxelsim.envs import TactileVectorEnv
from taxelsim.policies import Policy

from .conftest import write_scene

LARGEST = 32767  # counts, saturation in the sensor file


@pytest.fixture(scope="module")
def three_axis_scene(tmp_path_factory) -> taxelsim.Scene:
    folder = tmp_path_factory.mktemp("three_axis")
    file = write_scene(folder, record="tactile_image, taxel_counts, poses, actions")
    shipped = (taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve()
    file.write_text(file.read_text().replace(str(shipped), str((taxelsim.SCENES / "sensors/uskin_like_4x4.yaml").resolve())))
    return taxelsim.load_scene(file)


@pytest.fixture
def make_three_axis(device, three_axis_scene):
    def make(num_envs: int, **arguments) -> TactileVectorEnv:
        return TactileVectorEnv(three_axis_scene, num_envs, device=device, actions=("v_x", "v_y"), linear_scale=0.05, **arguments)

    return make


def test_observes_shear_with_its_sign_within_the_space(make_three_axis):
    env = make_three_axis(2, observations=("taxel_counts", "tactile_image"))
    space = env.single_observation_space["taxel_counts"]
    assert isinstance(space, spaces.Box)
    assert space.shape == (4, 4, 3)
    assert space.dtype == np.int32
    assert space.low.min() == space.low.max() == -LARGEST
    assert space.high.min() == space.high.max() == LARGEST
    observation, _ = env.reset(seed=0)
    for _ in range(4):  # the sensor moves along +x: the object slides along -x over it
        observation, *_ = env.step(np.array([[1, 0], [0, 1]], np.float32))
    assert observation in env.observation_space
    x, y, normal = np.moveaxis(observation["taxel_counts"].astype(float).sum(axis=(1, 2)), -1, 0)
    assert (normal > 500).all()  # of 1 to 3 N, gains 0.8 to 1.2
    assert x[0] < -100
    assert abs(y[0]) < -0.5 * x[0]
    assert y[1] < -100
    assert abs(x[1]) < -0.5 * y[1]


def test_normalized_counts_history_and_a_single_array(make_three_axis):
    plain = make_three_axis(2, observations="taxel_counts").reset(seed=0)[0]
    env = make_three_axis(2, observations="taxel_counts", normalized=True, history=3)
    observation = env.reset(seed=0)[0]
    assert observation.shape == (2, 3, 4, 4, 3)
    assert observation in env.observation_space
    np.testing.assert_allclose(observation[:, 1], plain / LARGEST, rtol=1e-6)


def test_copies_stay_and_live_arrays_change(make_three_axis):
    for copy in (True, False):
        env = make_three_axis(2, observations="taxel_counts", copy=copy)
        first = env.reset(seed=0)[0]
        kept = first.copy()
        env.step(np.ones((2, 2), np.float32))
        assert np.array_equal(first, kept) == copy


def test_several_sensors_have_an_axis_of_their_own(device, three_axis_scene, tmp_path):
    mounts = "robot: {pan_tilt: {position_step_deg: 0, sensors: [{link: tilt}, {link: tilt, mount: {position_mm: [0, 60, 30]}}]}}\n"
    file = tmp_path / "two.yaml"
    file.write_text(three_axis_scene.file.read_text().replace("objects:", mounts + "objects:", 1))
    env = TactileVectorEnv(file, 2, device=device, observations="taxel_counts")
    assert env.single_observation_space.shape == (2, 4, 4, 3)
    assert env.reset(seed=0)[0] in env.observation_space


def test_a_sensor_without_the_electronics_is_refused(make):
    with pytest.raises(taxelsim.InputError, match=r"^observations: 'taxel_counts' needs a sensor with readout.three_axis, which wts0614"):
        make(1, observations="taxel_counts")


def test_a_policy_observes_the_counts_that_the_environment_has(device, three_axis_scene):
    seen = []

    def push(observation: np.ndarray) -> np.ndarray:
        seen.append(observation.copy())
        return np.full((len(observation), 1), 0.5, np.float32)

    policy = Policy(push, observations="taxel_counts", actions="v_x", linear_scale=0.05, check_batch=False)
    taxelsim.evaluate(three_axis_scene, policy=policy, device=device, num_slices=1)
    environment = taxelsim.Environment(device, three_axis_scene, 24, outputs=taxelsim.OutputOptions(taxel_counts=True))
    environment.reset(np.ones(24, bool), np.arange(24))
    for observation in seen[:4]:
        assert np.array_equal(observation, environment.observe().taxel_counts)
        environment.step(np.tile([0.025, 0, 0, 0, 0, 0.0], (24, 1)))
    assert len(seen) >= 4
    assert not np.array_equal(seen[0], seen[3])
