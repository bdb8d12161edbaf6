"""Tasks with dynamics: episodes, batches, autoreset modes, what scripts gain from touch, refused input."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import taxelsim
from taxelsim.envs import DYNAMIC_TASKS
from taxelsim.envs.dynamics import observations, peg_insert, scripts
from taxelsim.envs.dynamics.evaluation import evaluate

ALL = observations.OBSERVATIONS


def make(task: str, num_envs: int, device: taxelsim.Device, **options):
    return gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=num_envs, device=device, **options)


def record(envs, num_steps: int) -> list[list[bytes]]:
    """Observations, rewards and ends of every environment, as bytes. Every third step has an action of its own per environment."""
    observation, infos = envs.reset(seed=5)
    rows = [[b"".join(values[i].tobytes() for values in observation.values()) for i in range(envs.num_envs)]]
    for step in range(num_steps):
        wave = [[np.sin(0.7 * step + i + k) for k in range(envs.single_action_space.shape[0])] for i in range(envs.num_envs)]
        observation, rewards, terminated, truncated, infos = envs.step(np.array(wave, np.float32))
        arrays = [*observation.values(), rewards, terminated, truncated, infos["episode_key"], infos["peak_force"]]
        rows.append([b"".join(array[i].tobytes() for array in arrays) for i in range(envs.num_envs)])
    return rows


@pytest.mark.parametrize("task", DYNAMIC_TASKS)
def test_trajectories_do_not_depend_on_num_envs(device: taxelsim.Device, task: str) -> None:
    few = record(make(task, 2, device, observations=ALL, condition="randomized"), 8)
    many = record(make(task, 9, device, observations=ALL, condition="randomized"), 8)
    assert [row[:2] for row in many] == few
    assert len(set(many[-1])) == 9


def test_peak_and_mean_force_are_those_of_the_frames(device: taxelsim.Device) -> None:
    envs = make("GraspHold", 3, device)
    _, infos = envs.reset(seed=1)
    assert not infos["mean_force"].any()
    forces = []
    for _ in range(12):
        infos = envs.step(np.full((3, *envs.single_action_space.shape), 0.5, np.float32))[-1]
        forces.append(envs._frame.ground_truth.total_force.copy())
        np.testing.assert_allclose(infos["mean_force"], np.mean(forces, axis=0), rtol=1e-6)
        np.testing.assert_array_equal(infos["peak_force"], np.max(forces, axis=0))
    assert (infos["mean_force"] > 0).all()


@pytest.mark.parametrize("task", DYNAMIC_TASKS)
def test_observations_are_in_their_space(device: taxelsim.Device, task: str) -> None:
    envs = make(task, 3, device, observations=ALL, condition="unseen")
    observation, _ = envs.reset(seed=1)
    assert envs.observation_space.contains(observation)
    observation, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())
    assert envs.observation_space.contains(observation)
    assert np.isfinite(rewards).all()
    assert not (terminated | truncated | infos["success"]).any()
    one = make(task, 3, device, observations="shear")
    assert one.reset(seed=1)[0].shape == (3, 3)


def test_shear_does_not_move_the_bodies(device: taxelsim.Device) -> None:
    with_shear, without = make("GraspHold", 3, device, observations=ALL), make("GraspHold", 3, device, observations=ALL, shear=False)
    for envs in (with_shear, without):
        envs.reset(seed=2)
        for _ in range(60):
            observation, *_ = envs.step(np.zeros((3, 1), np.float32))
        envs.last = observation
    np.testing.assert_array_equal(with_shear.batch.qpos, without.batch.qpos)
    np.testing.assert_array_equal(with_shear.last["tactile_image"], without.last["tactile_image"])
    assert (np.abs(with_shear.last["shear"][:, :2]).max(axis=1) > 0.3).all()
    assert (with_shear.last["shear_image"] != 0).any()
    assert not without.last["shear"].any()
    assert not without.last["shear_image"].any()


def test_masked_reset_leaves_the_others(device: taxelsim.Device) -> None:
    envs, alone = (make("Roll", 4, device, autoreset_mode=AutoresetMode.DISABLED) for _ in range(2))
    for e in (envs, alone):
        e.reset(seed=3)
        for _ in range(5):
            e.step(np.full((4, 2), 0.5, np.float32))
    before = envs.batch.qpos.copy()
    mask = np.array([False, True, False, True])
    _, infos = envs.reset(options={"reset_mask": mask})
    np.testing.assert_array_equal(envs.batch.qpos[~mask], before[~mask])
    assert (envs.batch.qpos[mask] != before[mask]).any(axis=1).all()
    assert (infos["episode_key"][mask] == taxelsim.episode_keys(3, [1, 3], 1)).all()
    left, *_ = envs.step(np.full((4, 2), 0.5, np.float32))
    right, *_ = alone.step(np.full((4, 2), 0.5, np.float32))
    for name in left:
        np.testing.assert_array_equal(left[name][~mask], right[name][~mask])


def test_same_step_and_next_step(device: taxelsim.Device) -> None:
    same, after = make("Roll", 2, device), make("Roll", 2, device, autoreset_mode=AutoresetMode.NEXT_STEP)
    for envs in (same, after):
        envs.reset(seed=4)
        for _ in range(envs.max_episode_steps):
            result = envs.step(np.zeros((2, 2), np.float32))
        assert result[3].all()
        envs.result = result
    final = same.result[4]["final_obs"][0]
    np.testing.assert_array_equal(final["contact"], after.result[0]["contact"][0])
    first, rewards, *_ = after.step(np.zeros((2, 2), np.float32))
    assert not rewards.any()
    for name in first:
        np.testing.assert_array_equal(first[name], same.result[0][name])


@pytest.mark.parametrize(("task", "episodes"), [("Push", 12), ("Roll", 12), ("GraspHold", 16), ("PegInsert", 16)])
def test_touch_helps(device: taxelsim.Device, task: str, episodes: int) -> None:
    """The lower end of the interval of the script with touch is above the rate of the blind one."""
    rates = {sense: evaluate(make(task, episodes, device), scripts.SCRIPTS[task](sense), seed=1).rate for sense in ("shear", "blind")}
    assert rates["shear"][1] > rates["blind"][0], rates


def test_shear_helps_to_hold(device: taxelsim.Device) -> None:
    rates = [evaluate(make("GraspHold", 24, device), scripts.GraspHold(sense), seed=1).rate for sense in ("shear", "normal")]
    assert rates[0][1] > rates[1][0], rates


def test_the_reward_of_the_peg_is_its_progress(device: taxelsim.Device) -> None:
    """Over the plate the rewards add up to the way towards the axis of the hole, and waiting wins nothing."""
    envs = make("PegInsert", 6, device)
    envs.reset(seed=3)
    hole = envs.unwrapped._hole()
    total = np.zeros(6)
    for step in range(30):
        observation, rewards, terminated, truncated, _ = envs.step(np.full((6, 3), (0.4, -0.2, 0) if step < 15 else 0.0, np.float32))
        total += rewards
        assert not (terminated | truncated).any()
    moved = observation["proprioception"][:, :2]
    way = np.linalg.norm(hole, axis=1) - np.linalg.norm(moved - hole, axis=1)
    np.testing.assert_allclose(total, way / peg_insert.OFFSET, atol=1e-4)  # float32 positions of 2 mm, over 3 mm
    for _ in range(20):
        rewards = envs.step(np.zeros((6, 3), np.float32))[1]
    assert np.abs(rewards).max() < 1e-3


def test_a_push_that_loses_contact_wins_nothing(device: taxelsim.Device) -> None:
    """Rewards are not negative, so that ending an episode gains nothing: a policy that backs off gets no more than one that stays."""
    totals = {}
    for name, forward in (("back off", -1), ("stay", 0)):
        envs = make("Push", 6, device)
        envs.reset(seed=3)
        totals[name], lengths = np.zeros(6), np.zeros(6)
        running = np.ones(6, np.bool_)
        for _ in range(envs.max_episode_steps):
            rewards, terminated, truncated = envs.step(np.tile(np.float32((forward, 0, 0)), (6, 1)))[1:4]
            assert ((rewards >= 0) & (rewards <= 2)).all()
            totals[name] += rewards * running
            lengths += running
            running &= ~(terminated | truncated)
        assert (lengths < envs.max_episode_steps).all() == (name == "back off")
    assert (totals["back off"] <= totals["stay"]).all(), totals


def test_the_reward_of_a_push_is_largest_at_the_goal(device: taxelsim.Device) -> None:
    """The script ends less than 5 mm from the goal, and from the path: at least (1 + 1 / e) / 2 (1 - 5 / 120) + 1 / e."""
    envs = make("Push", 6, device)
    observation, _ = envs.reset(seed=3)
    script = scripts.Push("shear")
    rewards = []
    for step in range(envs.max_episode_steps):
        observation, reward, *_ = envs.step(script(observation, np.full(6, step)))
        rewards.append(reward)
    assert (rewards[0] < 0.1).all(), rewards[0]
    assert (rewards[-1] > (1 + np.exp(-1)) / 2 * (1 - 5 / 120) + np.exp(-1)).all(), rewards[-1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"condition": "dark"}, "condition: 'dark' is not allowed: nominal, randomized, unseen"),
        ({"shear": 1}, "shear: 1 is not allowed: True and False"),
        ({"observations": ["contact", "smell"]}, "observations: 'smell' is not allowed: contact,"),
        ({"render_mode": "human"}, "render_mode: 'human' is not allowed"),
    ],
)
def test_refused_options(device: taxelsim.Device, options: dict[str, object], message: str) -> None:
    with pytest.raises(taxelsim.InputError, match=message):
        make("Push", 1, device, **options)


def test_pictures(device: taxelsim.Device) -> None:
    envs = make("Push", 2, device, render_mode="rgb_array")
    assert envs.render() is None
    envs.reset(seed=0)
    envs.step(np.full((2, 3), 0.3, np.float32))
    assert envs.render()[1].shape[-1] == 3
    envs.close()
    with pytest.raises(RuntimeError, match="closed"):
        envs.step(np.zeros((2, 3), np.float32))
