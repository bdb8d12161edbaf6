"""Observations, actions, rewards and pictures of vector environments."""

import numpy as np
import pytest
from gymnasium import spaces

import taxelsim
from taxelsim.envs import ACTIONS, FEATURES, SCALES, Reward, TactileVectorEnv

from .conftest import NUM_STEPS, OF_ANY_SENSOR, actions_of, write_scene


def test_observations_are_in_their_spaces_and_in_si_units(make):
    env = make(3, observations=OF_ANY_SENSOR)
    observation, _ = env.reset(seed=0)
    assert observation in env.observation_space
    assert {name: values.shape[1:] for name, values in observation.items()} == {
        "contact": (6,),
        "tactile_image": (6, 14),
        "binary_contact": (1,),
        "binary_image": (6, 14),
        "center_of_pressure": (3,),
        "features": (13,),
        "start_contact": (6,),
        "proprioception": (7,),
    }
    assert observation["tactile_image"].dtype == np.int32
    assert np.allclose(observation["proprioception"], [0, 0, 0, 1, 0, 0, 0])
    contact, features = observation["contact"], observation["features"]
    assert np.array_equal(contact[:, :3], features[:, 2:5])
    assert np.array_equal(contact[:, :3], observation["center_of_pressure"])
    assert (observation["binary_contact"] == 1).all()
    assert np.array_equal(-contact[:, 5], features[:, 0])
    assert ((features[:, 0] > 0.5) & (features[:, 0] < 4)).all()
    assert (np.abs(contact[:, :2]) < 0.03).all()


def test_binary_observations_and_the_center_follow_from_the_image(make):
    """At rest over the object nothing is touched: both states occur in an episode that lifts the sensor."""
    env = make(4, observations=OF_ANY_SENSOR)
    observation, seen = env.reset(seed=0)[0], set()
    for _ in range(8):  # an episode lasts longer
        image = observation["tactile_image"]
        assert np.array_equal(observation["binary_image"], image > 0)
        assert np.array_equal(observation["binary_contact"][:, 0], (image > 0).any(axis=(1, 2)))
        assert np.array_equal(observation["center_of_pressure"], observation["contact"][:, :3])
        seen |= set(observation["binary_contact"][:, 0])
        lift = np.zeros((4, env.single_action_space.shape[0]), np.float32)
        lift[:2, 2] = -1  # along -z, off the object, in two of the environments
        observation = env.step(lift)[0]
    assert seen == {0, 1}


def test_one_name_gives_an_array(make):
    assert isinstance(make(1).single_observation_space, spaces.Box)
    assert isinstance(make(1, observations=("contact",)).single_observation_space, spaces.Dict)


def test_newtons_follow_the_nominal_curve(make, sensor):
    counts = make(1, observations="tactile_image").reset(seed=0)[0]
    newtons = make(1, observations="tactile_image", image_unit="newtons").reset(seed=0)[0]
    index = np.unravel_index(counts.argmax(), counts.shape)
    assert newtons[index] == pytest.approx(taxelsim.nominal_force(sensor.readout, int(counts[index])))
    assert (newtons[counts == 0] == 0).all()


def test_normalized_observations_are_divided_by_their_scales(make, sensor):
    plain = make(2, observations=OF_ANY_SENSOR).reset(seed=0)[0]
    env = make(2, observations=OF_ANY_SENSOR, normalized=True)
    normalized = env.reset(seed=0)[0]
    assert normalized in env.observation_space
    assert np.allclose(normalized["tactile_image"], plain["tactile_image"] / sensor.readout.saturation)
    scales = [SCALES[unit] for _, size, unit in FEATURES for _ in range(size)]
    assert np.allclose(normalized["features"], plain["features"] / scales)


def test_history_holds_the_latest_frames_oldest_first(make):
    env, single = make(2, history=3), make(2)
    observation, first = env.reset(seed=0)[0], single.reset(seed=0)[0]
    assert np.array_equal(observation, np.repeat(first[:, np.newaxis], 3, axis=1))
    frames = [first, first, first]
    for step in range(14):  # over the end of an episode
        observation = env.step(actions_of(step, 2))[0]
        frame, _, _, truncated, _ = single.step(actions_of(step, 2))
        frames = [frame] * 3 if truncated.all() else [*frames[1:], frame]
        assert np.array_equal(observation, np.stack(frames, axis=1)), step


@pytest.mark.parametrize("history", [1, 2])
def test_copies_stay_and_live_arrays_change(make, history):
    for copy in (True, False):
        env = make(2, observations="tactile_image", copy=copy, history=history)
        first = env.reset(seed=0)[0]
        kept = first.copy()
        env.step(np.full((2, 6), 0.5, np.float32))
        assert np.array_equal(first, kept) == copy
    assert not make(1, observations="tactile_image", copy=False).reset(seed=0)[0].flags.writeable


def test_actions_are_scaled_components_of_the_twist(make):
    env = make(2, observations="proprioception", actions=("v_y", "w_z"), linear_scale=0.01, angular_scale=0.5)
    env.reset(seed=0)
    observation = env.step(np.array([[1, 0], [0, -1]], np.float32))[0]
    assert observation[0, :3] == pytest.approx([0, 1e-4, 0], abs=1e-9)
    assert observation[1, 6] == pytest.approx(np.sin(-0.5 * 0.01 / 2), rel=1e-3)


def test_actions_beyond_the_range_are_clipped(make):
    env = make(2, observations="proprioception")
    env.reset(seed=0)
    observation = env.step(np.array([[1] + [0] * 5, [70] + [0] * 5], np.float32))[0]
    assert np.array_equal(observation[0], observation[1])


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        (np.full((3, 6), np.nan, np.float32), "nan found in environment 0"),
        (np.where(np.arange(18).reshape(3, 6) == 14, np.inf, 0), "inf found in environment 2, dimension 2"),
        (np.zeros((6, 3)), r"shape \(6, 3\) is not allowed: \(3, 6\); did you mean"),
        (np.zeros((3, 5)), r"shape \(3, 5\) is not allowed: \(3, 6\)"),
        (np.zeros((3, 6), int), "dtype int64 is not allowed"),
        (np.full((3, 6), "x"), "dtype <U1 is not allowed"),
    ],
)
def test_bad_actions_are_refused_and_change_nothing(make, actions, message):
    env, reference = make(3), make(3)
    env.reset(seed=0)
    reference.reset(seed=0)
    with pytest.raises(taxelsim.InputError, match=message):
        env.step(actions)
    assert np.array_equal(env.step(actions_of(0, 3))[0], reference.step(actions_of(0, 3))[0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"observations": "image"}, "'image' is not allowed: contact, tactile_image"),
        ({"observations": ()}, "observations: empty"),
        ({"actions": ("v_x", "v_x")}, "'v_x' found twice"),
        ({"actions": "x"}, "is not allowed: v_x"),
        ({"history": 0}, "history: 0 is not allowed"),
        ({"history": 1.5}, "history: float is not allowed: an integer"),
        ({"image_unit": "mV"}, "is not allowed: counts, newtons"),
        ({"linear_scale": 0}, "linear_scale: 0 is not allowed"),
        ({"angular_scale": float("nan")}, "angular_scale: nan is not allowed"),
        ({"max_lost_time": -1}, "max_lost_time: -1 is not allowed"),
        ({"render_mode": "human"}, "'human' is not allowed"),
        ({"reward": lambda: Reward(force_limit=0)}, "force_limit: 0 is not allowed"),
        ({"reward": lambda: Reward(widths=())}, "reward.widths: empty"),
        ({"reward": lambda: Reward(widths=(1, 0))}, "reward.widths: 0 is not allowed"),
    ],
)
def test_refuses_bad_arguments(make, arguments, message):
    with pytest.raises(taxelsim.InputError, match=message):
        make(1, **{name: value() if callable(value) else value for name, value in arguments.items()})


@pytest.mark.parametrize("num_envs", [0, -1, 1.5, True])
def test_refuses_bad_num_envs(make, num_envs):
    with pytest.raises(taxelsim.InputError, match="num_envs"):
        make(num_envs)


def test_refuses_a_scene_without_task(device):
    with pytest.raises(taxelsim.InputError, match="no `task`"):
        TactileVectorEnv(taxelsim.SCENES / "edge_servo.yaml", device=device)


@pytest.mark.parametrize("history", [1, 3])
def test_start_contact_is_that_of_the_first_frame(make, history):
    env = make(3, observations=("contact", "start_contact"), history=history)
    observation, _ = env.reset(seed=0)
    assert np.array_equal(observation["start_contact"], observation["contact"])
    first = observation["contact"].copy()
    for step in range(NUM_STEPS - 1):
        observation = env.step(actions_of(step, 3))[0]
        assert np.array_equal(observation["start_contact"], first)
        assert not np.array_equal(observation["contact"], first)
    observation, *_, infos = env.step(actions_of(NUM_STEPS - 1, 3))  # ends the episodes
    assert np.array_equal(infos["final_obs"][1]["start_contact"], first[1])
    assert np.array_equal(observation["start_contact"], observation["contact"])
    assert not np.array_equal(observation["start_contact"], first)


def test_start_contact_of_an_environment_that_is_reset_alone(make):
    env = make(2, observations=("contact", "start_contact"), autoreset_mode="Disabled")
    first = env.reset(seed=0)[0]["contact"].copy()
    env.step(actions_of(0, 2))
    observation, _ = env.reset(options={"reset_mask": np.array([False, True])})
    assert np.array_equal(observation["start_contact"][0], first[0])
    assert np.array_equal(observation["start_contact"][1], observation["contact"][1])
    assert not np.array_equal(observation["start_contact"][1], first[1])


def test_reward_averages_over_its_widths():
    errors, tolerances = np.array([[3.0, 2.0]]), np.array([1.0, 2.0])
    found = Reward(widths=(1, 3))(errors, tolerances, np.ones(1), np.ones(1, bool), np.zeros(1))
    assert found == pytest.approx([np.mean(np.exp([-9, -1, -1, -1 / 9]))])


def test_reward_follows_its_formula():
    reward = Reward(lost_penalty=2, force_penalty=0.5, force_limit=4)
    errors = np.array([[np.nan, 0, 0], [np.nan, 1, 2], [np.nan, np.inf, np.inf], [np.nan, 0, 0]])
    tolerances = np.array([np.nan, 1, 2])
    contact, force = np.array([True, True, False, True]), np.array([1.0, 1, 0, 6])
    progress = np.array([1, 0.5, 1, -3])
    found = reward(errors, tolerances, progress, contact, force)
    assert found == pytest.approx([1, np.exp(-1) * 0.75, -2, 0.5 - 0.5 * 0.5])


def test_reward_is_best_where_the_errors_are_smallest(make):
    env = make(64)
    env.reset(seed=0)
    _, rewards, _, _, infos = env.step(np.zeros((64, 6), np.float32))
    error = (infos["edge_angle_error"] / np.deg2rad(20)) ** 2 + infos["total_force_error"] ** 2
    assert rewards[error.argmin()] == rewards.max()
    assert (rewards <= 1).all()


def test_progress_earns_reward_in_tasks_with_travel(device, tmp_path):
    scene = taxelsim.load_scene(write_scene(tmp_path, travel=1.2))
    env = TactileVectorEnv(scene, 2, device=device, actions="v_y", linear_scale=0.01)  # 0.1 mm a step, as the task requires
    env.reset(seed=0)
    _, rewards, _, _, infos = env.step(np.array([[1], [0]], np.float32))
    errors = np.array([infos["edge_angle_error"] / np.deg2rad(20), infos["total_force_error"]])
    tracking = np.exp(-(errors**2)).mean(axis=0)
    assert rewards == pytest.approx(tracking * [1, 0.5], rel=1e-2)


def test_several_frames_per_control_tick(device, tmp_path):
    scene = taxelsim.load_scene(write_scene(tmp_path, rate=200))
    env = TactileVectorEnv(scene, 2, device=device, observations="proprioception", linear_scale=0.01)
    assert env.step_time == pytest.approx(0.01)
    assert env.max_episode_steps == 12
    env.reset(seed=0)
    assert env.step(np.full((2, 6), [1, 0, 0, 0, 0, 0], np.float32))[0][:, 0] == pytest.approx(1e-4, rel=1e-3)
    truncated = [env.step(np.zeros((2, 6), np.float32))[3].all() for _ in range(11)]
    assert truncated == [False] * 10 + [True]


@pytest.mark.parametrize("history", [1, 2])
def test_last_step_of_an_episode_may_be_shorter_than_a_control_period(device, tmp_path, history):
    scene = taxelsim.load_scene(write_scene(tmp_path, rate=200, num_frames=24))  # control ticks at frames 0, 2, ..., 22
    env = TactileVectorEnv(scene, 2, device=device, history=history, autoreset_mode="Disabled")
    references = [taxelsim.Environment(device, scene, 1) for _ in range(2)]
    scales = np.repeat(taxelsim._core.servo_limits(scene), 3)

    def latest(observation: np.ndarray) -> np.ndarray:
        return observation if history == 1 else observation[:, -1]

    env.reset(seed=0)
    references[0].reset([True], taxelsim.episode_keys(0, 0, 0))
    for step in range(12):
        if step == 3:
            env.reset(options={"reset_mask": np.array([False, True])})
            references[1].reset([True], taxelsim.episode_keys(0, 1, 1))
        observation, _, _, truncated, infos = env.step(actions_of(step, 2))
        for i in range(2 if step >= 3 else 1):
            twist = actions_of(step, 2)[i : i + 1].astype(float) * scales
            references[i].step(twist, 1 if i == 0 and step == 11 else 2)
            frame = references[i].observe()
            assert np.array_equal(latest(observation)[i, :3], frame.center_of_pressure[0]), (step, i)
    assert env.max_episode_steps == 12
    assert truncated.tolist() == [True, False]
    assert frame.frame_numbers[0] == 18
    assert references[0].observe().frame_numbers[0] == 23
    assert infos["success"][0] == references[0].judge([0])["success"][0]
    assert infos["total_force_error"][0] == references[0].task_state().errors[0, 1]


def test_render_draws_the_tactile_image(make):
    env = make(3, render_mode="rgb_array")
    assert env.render() is None
    env.reset(seed=0)
    frames = env.render()
    assert len(frames) == 3
    assert frames[0].shape == (72, 168, 3)
    assert frames[0].dtype == np.uint8
    counts = make(3, observations="tactile_image").reset(seed=0)[0]
    row, col = np.unravel_index(counts[1].argmax(), counts[1].shape)
    assert frames[1][12 * row + 6, 12 * col + 6].sum() == frames[1].sum(axis=2).max()
    assert make(1).render() is None


def test_all_actions_are_available(make):
    assert make(1).single_action_space.shape == (len(ACTIONS),)
