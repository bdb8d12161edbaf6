"""The adapters, with the training libraries themselves. Skipped where these are not installed; the campaign `learn` installs them."""

import numpy as np
import pytest

import taxelsim

from .conftest import NUM_STEPS, actions_of

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")


@pytest.fixture
def sb3():
    return pytest.importorskip("stable_baselines3")


@pytest.fixture
def rsl_rl():
    pytest.importorskip("tensordict")
    return pytest.importorskip("rsl_rl")


def test_stable_baselines3_adapter_equals_the_environment(sb3, make):
    from taxelsim.envs.sb3 import StableBaselinesVecEnv

    env, reference = StableBaselinesVecEnv(make(3)), make(3)
    env.seed(4)
    assert np.array_equal(env.reset(), reference.reset(seed=[4, 5, 6])[0])
    for step in range(NUM_STEPS):
        observation, _, done, infos = env.step(actions_of(step, 3))
        expected, _, _, truncated, expected_infos = reference.step(actions_of(step, 3))
    assert np.array_equal(observation, expected)
    assert np.array_equal(done, truncated)
    assert np.array_equal(infos[1]["terminal_observation"], expected_infos["final_obs"][1])
    assert infos[1]["TimeLimit.truncated"]
    with pytest.raises(taxelsim.InputError, match="SameStep"):
        StableBaselinesVecEnv(make(1, autoreset_mode="NextStep"))


@pytest.mark.parametrize(("observations", "policy"), [("contact", "MlpPolicy"), (("contact", "tactile_image"), "MultiInputPolicy")])
def test_stable_baselines3_trains_and_counts_episodes(sb3, make, observations, policy):
    from stable_baselines3.common.vec_env import VecMonitor

    from taxelsim.envs.sb3 import StableBaselinesVecEnv

    envs = StableBaselinesVecEnv(make(4, observations=observations, normalized=True, history=2))
    assert envs.get_attr("max_episode_steps", [0, 2]) == [NUM_STEPS] * 2
    assert envs.env_is_wrapped(VecMonitor) == [False] * 4
    model = sb3.PPO(policy, VecMonitor(envs), n_steps=2 * NUM_STEPS, batch_size=NUM_STEPS, n_epochs=1, device="cpu", seed=1)
    before = [values.clone() for values in model.policy.parameters()]
    model.learn(2 * NUM_STEPS * 4)
    assert model.num_timesteps == 2 * NUM_STEPS * 4
    assert len(model.ep_info_buffer) == 8
    assert {info["l"] for info in model.ep_info_buffer} == {NUM_STEPS}
    assert len(model.ep_success_buffer) == 8
    assert any(not old.equal(new) for old, new in zip(before, model.policy.parameters(), strict=True))


def test_rsl_rl_adapter_equals_the_environment(rsl_rl, make):
    import torch

    from taxelsim.envs.rsl_rl import RslRlVecEnv

    env, reference = RslRlVecEnv(make(3), seed=4), make(3)
    assert np.array_equal(env.get_observations()["policy"], reference.reset(seed=4)[0])
    for step in range(NUM_STEPS):
        assert (env.episode_length_buf == step).all()
        observation, rewards, dones, extras = env.step(torch.as_tensor(actions_of(step, 3)))
        expected, expected_rewards, *_ = reference.step(actions_of(step, 3))
    assert np.array_equal(observation["policy"], expected)
    assert np.array_equal(rewards, expected_rewards.astype(np.float32))
    assert dones.all()
    assert extras["time_outs"].all()
    assert (env.episode_length_buf == 0).all()


def test_rsl_rl_trains(rsl_rl, make):
    from rsl_rl.runners import OnPolicyRunner

    from taxelsim.envs.rsl_rl import RslRlVecEnv

    env = RslRlVecEnv(make(4, observations=("contact", "features"), normalized=True), seed=1)
    settings = {
        "num_steps_per_env": NUM_STEPS,
        "save_interval": 100,
        "obs_groups": {"actor": ["contact", "features"], "critic": ["contact", "features"]},
        "actor": {
            "class_name": "rsl_rl.models:MLPModel",
            "hidden_dims": [16],
            "distribution_cfg": {"class_name": "rsl_rl.modules:GaussianDistribution"},
        },
        "critic": {"class_name": "rsl_rl.models:MLPModel", "hidden_dims": [16]},
        "algorithm": {"class_name": "rsl_rl.algorithms:PPO", "num_mini_batches": 2},
    }
    runner = OnPolicyRunner(env, settings)
    before = [values.clone() for values in runner.alg.actor.parameters()]
    runner.learn(2)
    assert any(not old.equal(new) for old, new in zip(before, runner.alg.actor.parameters(), strict=True))
