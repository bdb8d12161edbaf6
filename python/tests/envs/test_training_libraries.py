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


@pytest.fixture
def torch():
    return pytest.importorskip("torch")


@pytest.mark.parametrize("autoreset_mode", ["SameStep", "NextStep", "Disabled"])
@pytest.mark.parametrize("backend", ["torch", "jax", "warp"])
def test_a_backend_has_the_numbers_of_numpy(make, backend, autoreset_mode):
    module = pytest.importorskip(backend)
    arguments = {"observations": ("contact", "tactile_image", "proprioception"), "history": 2, "autoreset_mode": autoreset_mode}
    env, reference = make(3, backend=backend, **arguments), make(3, **arguments)
    results, expected = [env.reset(seed=4)], [reference.reset(seed=4)]
    for step in range(NUM_STEPS + 2):
        if autoreset_mode == "Disabled" and step == NUM_STEPS:
            for each, found in ((env, results), (reference, expected)):
                found.append(each.reset(options={"reset_mask": np.ones(3, np.bool_)}))
        results.append(env.step(actions_of(step, 3)))
        expected.append(reference.step(actions_of(step, 3)))
    kinds = {"torch": "Tensor", "jax": "ArrayImpl", "warp": "array"}
    assert type(results[-1][0]["contact"]).__name__ == kinds[backend]
    assert type(results[-1][1]).__module__.startswith((module.__name__, "jaxlib"))
    check_equal(results, expected)


def check_equal(found, expected):
    """Trees of arrays of any library; JAX has 32 bits."""
    if isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for name, value in expected.items():
            check_equal(found[name], value)
    elif isinstance(expected, list | tuple) or (isinstance(expected, np.ndarray) and expected.dtype == object):
        for one, other in zip(found, expected, strict=True):
            check_equal(one, other)
    elif expected is not None:
        values = found.numpy() if hasattr(found, "numpy") else np.asarray(found)
        np.testing.assert_array_equal(values, expected.astype(values.dtype))


def test_torch_shares_memory_and_refuses_tensors_elsewhere(make, torch):
    env = make(3, backend="torch", observations="tactile_image", copy=False)
    observation, _ = env.reset(seed=1)
    env.step(torch.from_numpy(actions_of(0, 3)).requires_grad_())
    image = env._frame.tactile_image
    assert observation.data_ptr() == image.ctypes.data
    with pytest.raises(taxelsim.InputError, match=r"^actions: a tensor of torch.float32 on meta is not allowed"):
        env.step(torch.zeros((3, 6), device="meta"))


@pytest.mark.filterwarnings("ignore:To copy construct from a tensor")  # which its wrapper does
def test_skrl_wraps_the_environment(make, torch):
    wrappers = pytest.importorskip("skrl.envs.wrappers.torch")
    env, reference = wrappers.wrap_env(make(3, backend="torch"), wrapper="gymnasium", verbose=False), make(3)
    env._seed = 4
    observation, _ = env.reset()
    np.testing.assert_array_equal(observation.numpy(), reference.reset(seed=4)[0])
    observation, reward, *_ = env.step(torch.from_numpy(actions_of(0, 3)))
    expected = reference.step(actions_of(0, 3))
    np.testing.assert_array_equal(observation.numpy(), expected[0])
    np.testing.assert_array_equal(reward.numpy()[:, 0], expected[1].astype(np.float32))


def test_torchrl_wraps_the_environment(make, scene, device, torch):
    libs = pytest.importorskip("torchrl.envs.libs.gym")
    from taxelsim.envs import TactileEnv

    env, reference = libs.GymWrapper(TactileEnv(scene, device=device)), TactileEnv(scene, device=device)
    env.set_seed(4)
    rollout = env.rollout(2)
    assert rollout["observation"].shape == (2, *reference.observation_space.shape)
    assert torch.isfinite(rollout["next", "reward"]).all()


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
