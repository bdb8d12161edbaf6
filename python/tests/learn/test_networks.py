"""Networks and demonstrations of the benchmark. Needs torch; the campaign `learn` installs it."""

import numpy as np
import pytest

import taxelsim
from taxelsim.policies import OnnxPolicy, Policy
from taxelsim.tasks import TASKS

torch = pytest.importorskip("torch")

SIZES = {"features": 13, "tactile_image": 84, "start_contact": 6, "proprioception": 7}
TASK = "EdgeAlign"


@pytest.fixture
def observation():
    from learn.recipe import HISTORY, OBSERVATIONS

    random = np.random.default_rng(1)
    shapes = {**SIZES, "tactile_image": (6, 14)}
    return {name: random.normal(size=(5, HISTORY, *np.atleast_1d(shapes[name]))).astype(np.float32) for name in OBSERVATIONS}


def tensors(observation):
    return {name: torch.as_tensor(values) for name, values in observation.items()}


def test_a_blind_network_sees_only_its_own_motion(observation):
    from learn.network import PpoInputs, joined
    from learn.recipe import PPO_OBSERVATIONS

    def inputs(blind):
        return PpoInputs(SIZES, blind=blind)(joined(tensors(observation), PPO_OBSERVATIONS))

    assert torch.equal(inputs(blind=False), joined(tensors(observation), PPO_OBSERVATIONS))
    seen = inputs(blind=True)
    for name in ("features", "start_contact"):
        observation[name] = observation[name] + 1
    assert torch.equal(inputs(blind=True), seen)
    observation["proprioception"] = observation["proprioception"] + 0.1
    assert not torch.equal(inputs(blind=True), seen)


def test_a_gain_of_all_taxels_cancels_in_image_and_forces(observation):
    from learn.network import Inputs, joined
    from learn.recipe import OBSERVATIONS

    inputs = Inputs(SIZES)
    observation["start_contact"][..., 5] = -2.0
    observation["features"][..., :2] = 0.3
    observation["tactile_image"] = np.abs(observation["tactile_image"]) * 0.01
    before = inputs(joined(tensors(observation), OBSERVATIONS))
    for values in (observation["tactile_image"], observation["features"][..., :2], observation["start_contact"][..., 5]):
        values *= 1.3
    changed = (inputs(joined(tensors(observation), OBSERVATIONS)) - before).abs() > 1e-5
    assert changed.any(0).sum() == 1  # the start force itself


@pytest.mark.parametrize("kind", ["clone", "ppo"])
def test_an_onnx_file_acts_as_its_network(observation, tmp_path, kind):
    from learn.network import Inputs, PpoInputs, as_policy, new_actor, write_onnx
    from learn.recipe import clone_settings, ppo_settings, recipe_of

    torch.manual_seed(1)
    settings = ppo_settings(TASK) if kind == "ppo" else clone_settings(TASK, recipe_of(TASK))
    actor = new_actor(PpoInputs(SIZES) if kind == "ppo" else Inputs(SIZES), (16,), len(TASKS[TASK].actions))
    write_onnx(actor, tmp_path / "p.onnx", settings)
    policy = OnnxPolicy(tmp_path / "p.onnx")
    assert policy.settings == settings
    observation = {name: observation[name] for name in settings["observations"]}
    found, expected = policy(observation), as_policy(actor, "p", settings).function(observation)
    assert found.shape == (5, 4)
    assert np.allclose(found, expected, atol=1e-6)
    assert np.abs(found).max() <= 1


def test_demonstrations_are_what_a_policy_observes(device, tmp_path):
    from learn.cloning import Demonstrations
    from learn.network import joined
    from learn.recipe import HISTORY, OBSERVATIONS, clone_settings, recipe_of

    recipe, observed = recipe_of(TASK), []

    def still(observation):
        observed.append(joined(tensors(observation), OBSERVATIONS))
        return np.zeros((len(observed[-1]), len(TASKS[TASK].actions)))

    scene = taxelsim.load_scene(taxelsim.SCENES / TASKS[TASK].scene, num_episodes=2, condition="randomized")
    policy = Policy(still, identity="still", check_batch=False, **clone_settings(TASK, recipe))
    taxelsim.generate(scene, tmp_path / "data", policy=policy, device=device, batch_size=1, num_slices=1)
    data = taxelsim.Dataset(tmp_path / "data")
    demonstrations = Demonstrations(data, np.ones(2, bool), TASK, recipe, scene.sensor.readout.saturation)
    rows = np.arange(data.num_frames)
    found, expected = demonstrations.observation(rows), torch.cat(observed)
    num_observed = len(expected) // 2  # the last frame of an episode takes no action
    kept = np.concatenate([first + np.arange(num_observed) for first in (0, data.num_frames // 2)])
    assert found.shape[1] == HISTORY * sum(SIZES.values())
    assert torch.allclose(found[kept], expected, atol=1e-5)


@pytest.mark.parametrize(("sense", "size"), [("binary", 1), ("center", 3), ("image", 84), ("shear", 7)])
def test_a_control_gets_its_observation_alone(device: taxelsim.Device, sense: str, size: int) -> None:
    """Inputs of two environments: what is felt now, first and as a change, goal, joints and the part of the episode, no other touch."""
    pytest.importorskip("stable_baselines3")
    from learn.dynamic_training import Inputs, _environments, observations_of

    envs = _environments("GraspHold", sense, 2, "nominal", device)
    observation, _ = envs.reset(seed=1)
    assert tuple(observation) == observations_of(sense)
    inputs = Inputs(sense, envs.max_episode_steps)(observation, np.zeros(2, np.int64))
    others = envs.num_goal + observation["proprioception"].shape[1] + 1
    assert inputs.shape == (2, 3 * size + others + (sense == "shear"))
    felt = np.concatenate([observation[name].reshape(2, -1) for name in observations_of(sense)[:-2]], axis=1)
    np.testing.assert_allclose(inputs[:, :size], felt, rtol=1e-6)
