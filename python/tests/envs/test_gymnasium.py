"""What Gymnasium, threads, processes and training libraries expect."""

import os
import pickle
import threading
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import taxelsim
from taxelsim.envs import CONDITIONS, TASKS, TactileEnv, TactileVectorEnv
from taxelsim.envs.tasks import task_arguments

from .conftest import OF_ANY_SENSOR, actions_of, write_scene


@pytest.mark.filterwarnings("ignore:.*A Box observation space:UserWarning", "ignore:.*not having a spec:UserWarning")
@pytest.mark.parametrize("observations", ["contact", OF_ANY_SENSOR])
def test_single_environment_passes_check_env(device, scene, observations):
    env = TactileEnv(scene, observations=observations, device=device, render_mode="rgb_array")
    with warnings.catch_warnings(record=True) as caught:
        check_env(env)
    messages = [str(warning.message) for warning in caught]
    assert all("Box observation space" in message or "not having a spec" in message for message in messages), messages


def test_single_environment_equals_a_vector_environment_of_one(device, scene, make):
    env, batch = TactileEnv(scene, device=device), make(1)
    observation, info = env.reset(seed=3)
    expected, infos = batch.reset(seed=3)
    assert np.array_equal(observation, expected[0])
    assert info["episode_key"] == infos["episode_key"][0]
    observation, reward, terminated, truncated, info = env.step(actions_of(0, 1)[0])
    expected, rewards, _, _, infos = batch.step(actions_of(0, 1))
    assert np.array_equal(observation, expected[0])
    assert reward == rewards[0]
    assert (terminated, truncated) == (False, False)
    assert info["peak_force"] == infos["peak_force"][0]


def test_make_vec_takes_any_scene_with_a_task(device, tmp_path):
    env = taxelsim.make_vec(write_scene(tmp_path), num_envs=2, device=device)
    assert isinstance(env, TactileVectorEnv)
    assert env.reset(seed=0)[0].shape == (2, 6)


def test_tasks_are_registered(device):
    env = gymnasium.make_vec("taxelsim/EdgeAlign-v0", num_envs=3, device=device, history=2)
    assert isinstance(env, TactileVectorEnv)
    assert env.spec.id == "taxelsim/EdgeAlign-v0"
    assert env.reset(seed=0)[0].shape == (3, 2, 6)
    assert env.step(env.action_space.sample())[1].shape == (3,)
    assert env.single_action_space.shape == (4,)


def test_one_environment_of_a_task(device):
    env = gymnasium.make("taxelsim/EdgeAlign-v0", device=device)
    assert isinstance(env.unwrapped, TactileEnv)
    assert env.reset(seed=0)[0].shape == (6,)


@pytest.mark.parametrize("task", TASKS)
def test_every_task_has_its_three_conditions(task):
    scenes = [task_arguments(task, condition)["scene"] for condition in CONDITIONS]
    assert all(scene.has_task for scene in scenes)
    assert len({scene.resolved for scene in scenes}) == 3
    assert len({scene.sensor.num_taxels for scene in scenes}) == 1


def test_unknown_task_and_condition_are_refused():
    with pytest.raises(taxelsim.InputError, match="'Edge' is not allowed: EdgeFollow"):
        task_arguments("Edge")
    with pytest.raises(taxelsim.InputError, match="'seen' is not allowed: nominal"):
        task_arguments("EdgeFollow", "seen")


def test_two_environments_in_two_threads_equal_one_after_the_other(make):
    def roll(env: TactileVectorEnv, seed: int, record: list[bytes]) -> None:
        env.reset(seed=seed)
        for step in range(15):
            observation, rewards, *_ = env.step(actions_of(step, env.num_envs))
            record.append(observation.tobytes() + rewards.tobytes())

    envs = [make(16), make(5)]
    expected: list[list[bytes]] = [[], []]
    for env, record in zip(envs, expected, strict=True):
        roll(env, 7, record)
    found: list[list[bytes]] = [[], []]
    threads = [threading.Thread(target=roll, args=(env, 7, record)) for env, record in zip(envs, found, strict=True)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == expected


@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
def test_forked_child_gets_an_exception(make):
    env = make(2)
    env.reset(seed=0)
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        results = []
        for use in (lambda: env.step(actions_of(0, 2)), lambda: env.reset(seed=1)):
            try:
                use()
            except Exception as error:
                results.append((type(error).__name__, str(error)))
        env.close()
        os.write(writer, pickle.dumps(results))
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as stream:
        results = pickle.load(stream)
    assert os.waitpid(child, 0)[1] == 0
    assert len(results) == 2
    for name, message in results:
        assert name == "DeviceError"
        assert "fork" in message
    env.step(actions_of(0, 2))
