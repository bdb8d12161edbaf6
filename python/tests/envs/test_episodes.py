"""Seeds, resets and automatic resets of vector environments."""

import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode

import taxelsim

from .conftest import NUM_STEPS, actions_of


def roll(env, num_steps: int, seed: int = 11) -> list[list[bytes]]:
    """Observation, reward and ends of every environment after every step, as bytes."""
    observation, infos = env.reset(seed=seed)
    record = [[observation[i].tobytes() + infos["episode_key"][i].tobytes() for i in range(env.num_envs)]]
    for step in range(num_steps):
        observation, rewards, terminated, truncated, infos = env.step(actions_of(step, env.num_envs))
        arrays = (observation, rewards, terminated, truncated, infos["episode_key"], infos["total_force_error"])
        record.append([b"".join(array[i].tobytes() for array in arrays) for i in range(env.num_envs)])
    return record


def test_trajectories_do_not_depend_on_num_envs(make):
    few = roll(make(1), 2 * NUM_STEPS + 3)
    some = roll(make(7), 2 * NUM_STEPS + 3)
    many = roll(make(256), 2 * NUM_STEPS + 3)
    assert [row[:1] for row in some] == few
    assert [row[:7] for row in many] == some
    assert len(set(many[-1])) == 256


def test_trajectories_of_4096_environments_are_those_of_small_batches(device, scene, make):
    some, most, envs = roll(make(7), NUM_STEPS + 2), [], make(4096)
    most = roll(envs, NUM_STEPS + 2)  # the episodes are replaced after NUM_STEPS
    assert [row[:7] for row in most] == some
    assert len(set(most[-1])) == 4096
    # Environments of high index: a small batch runs their episodes by number.
    chosen = np.array([255, 2048, 4095])
    few = taxelsim.Environment(device, scene, len(chosen))
    few.reset(np.ones(len(chosen), bool), taxelsim.episode_keys(11, chosen, 1))
    for step in range(NUM_STEPS, NUM_STEPS + 2):
        few.step(actions_of(step, 4096)[chosen] * np.repeat([0.04, 1.0], 3))
    expected = few.observe()
    for name in ("tactile_image", "total_force", "center_of_pressure", "X_SO", "X_WS"):
        assert envs._frame[name][chosen].tobytes() == expected[name].tobytes(), name


def test_seed_determines_the_episodes(make):
    env = make(3)
    first, second = roll(env, 3), roll(env, 3)
    assert first == second
    assert roll(env, 3, seed=12)[0] != first[0]


def test_reset_without_seed_continues_with_the_next_episodes(make):
    env = make(2)
    keys = [env.reset(seed=4)[1]["episode_key"], env.reset()[1]["episode_key"], env.reset()[1]["episode_key"]]
    expected = [taxelsim.episode_keys(4, [0, 1], count) for count in range(3)]
    assert np.array_equal(keys, expected)
    assert len(np.unique(keys)) == 6


def test_first_reset_without_seed_draws_one(make):
    assert (make(1).reset()[1]["episode_key"] != make(1).reset()[1]["episode_key"]).all()


def test_seeds_may_differ_between_environments(make):
    _, infos = make(2).reset(seed=[8, 9])
    assert infos["episode_key"].tolist() == [*taxelsim.episode_keys(8, 0, 0), *taxelsim.episode_keys(9, 1, 0)]


def test_same_step_replaces_ended_episodes_and_keeps_the_last_observation(make):
    same, disabled = make(3), make(3, autoreset_mode=AutoresetMode.DISABLED)
    assert same.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    same.reset(seed=1)
    disabled.reset(seed=1)
    for step in range(NUM_STEPS):
        observation, _, _, truncated, infos = same.step(actions_of(step, 3))
        last, _, _, ended, last_infos = disabled.step(actions_of(step, 3))
        assert "final_obs" in infos if step == NUM_STEPS - 1 else "final_obs" not in infos
    assert truncated.all()
    assert ended.all()
    assert np.array_equal(np.stack(infos["final_obs"]), last)
    assert infos["_final_obs"].all()
    assert infos["_final_info"].all()
    for name, values in last_infos.items():
        assert np.array_equal(infos["final_info"][name], values), name
    new, _ = disabled.reset()
    assert np.array_equal(observation, new)
    assert np.array_equal(infos["episode_key"], taxelsim.episode_keys(1, range(3), 1))


def test_next_step_resets_one_step_later_without_reward(make):
    env, same = make(2, autoreset_mode="NextStep"), make(2)
    env.reset(seed=1)
    same.reset(seed=1)
    for step in range(NUM_STEPS):
        observation, _, _, truncated, infos = env.step(actions_of(step, 2))
        new, _, _, _, same_infos = same.step(actions_of(step, 2))
    assert truncated.all()
    assert "final_obs" not in infos
    assert np.array_equal(observation, np.stack(same_infos["final_obs"]))
    observation, rewards, terminated, truncated, _ = env.step(actions_of(0, 2))
    assert not rewards.any()
    assert not (terminated | truncated).any()
    assert np.array_equal(observation, new)
    assert np.array_equal(env.step(actions_of(3, 2))[0], same.step(actions_of(3, 2))[0])


def test_reset_mask_starts_the_chosen_environments_and_leaves_the_others(make):
    env, reference = make(4, autoreset_mode=AutoresetMode.DISABLED), make(4, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=2)
    reference.reset(seed=2)
    for step in range(3):
        before = env.step(actions_of(step, 4))[0]
        reference.step(actions_of(step, 4))
    mask = np.array([False, True, False, True])
    observation, infos = env.reset(options={"reset_mask": mask})
    assert np.array_equal(observation[~mask], before[~mask])
    assert (observation[mask] != before[mask]).any(axis=1).all()
    assert np.array_equal(infos["_episode_key"], mask)
    for step in range(3, NUM_STEPS):
        stepped, _, _, truncated, _ = env.step(actions_of(step, 4))
        expected = reference.step(actions_of(step, 4))[0]
        assert np.array_equal(stepped[~mask], expected[~mask])
    assert np.array_equal(truncated, ~mask)
    with pytest.raises(ResetNeeded, match="environment 0 has ended"):
        env.step(actions_of(0, 4))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"reset_mask": [True, False]}, "list is not allowed: a NumPy array of bool"),
        ({"reset_mask": np.array([1, 0])}, "int64 is not allowed: a NumPy array of bool"),
        ({"reset_mask": np.array([True])}, r"shape \(1,\) is not allowed: \(2,\)"),
        ({"reset_mask": np.zeros(2, bool)}, "at least one"),
        ({"mask": 1}, "'mask' is not allowed: only 'reset_mask'"),
    ],
)
def test_refuses_bad_options(make, options, message):
    env = make(2)
    env.reset(seed=0)
    with pytest.raises(taxelsim.InputError, match=message):
        env.reset(options=options)


@pytest.mark.parametrize(
    ("seed", "message"),
    [
        (-1, "-1 is not allowed"),
        (1.5, "float is not allowed for environment 0: an integer"),
        ([1], "1 seeds are not allowed: 2"),
        (2**64, "allowed"),
    ],
)
def test_refuses_bad_seeds(make, seed, message):
    with pytest.raises(taxelsim.InputError, match=message):
        make(2).reset(seed=seed)


def test_first_reset_must_cover_all_and_step_needs_a_reset(make):
    env = make(2)
    with pytest.raises(ResetNeeded, match="before step"):
        env.step(actions_of(0, 2))
    with pytest.raises(ResetNeeded, match="all environments"):
        env.reset(options={"reset_mask": np.array([True, False])})


def test_lost_contact_terminates_after_max_lost_time(make):
    env = make(2, actions="v_z", max_lost_time=0.02, autoreset_mode=AutoresetMode.DISABLED)
    env.reset(seed=3)
    away = np.full((2, 1), -0.2, np.float32)  # 8 mm/s
    contacts = []
    for _ in range(NUM_STEPS):
        _, rewards, terminated, _, infos = env.step(away)
        contacts.append(infos["contact"][0])
        if terminated.any():
            break
    assert terminated[0]
    assert contacts[-4:] == [True, False, False, False]
    assert (rewards[~infos["contact"]] == -1).all()
    assert np.isinf(infos["total_force_error"][0])
    assert infos["num_losses"][0] == 1


def test_closed_environment_says_so(make):
    env = make(1)
    env.reset(seed=0)
    env.close()
    env.close()
    with pytest.raises(RuntimeError, match="closed"):
        env.reset()
