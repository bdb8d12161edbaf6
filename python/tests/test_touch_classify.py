"""TouchClassify: labels, reward, independence of the batch size, and classification of the object from touches."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import taxelsim
from taxelsim.envs.touch_classify import TouchClassifyVectorEnv

K = 8
NO_CHANGE = ("", "")


def make(device: taxelsim.Device, num_envs: int, **kwargs: Any) -> TouchClassifyVectorEnv:
    return TouchClassifyVectorEnv(num_envs, device=device, **kwargs)


def random_actions(envs: TouchClassifyVectorEnv, seed: int, step: int) -> np.ndarray:
    """Actions that depend on the index of the environment, not on the number of environments."""
    rows = [np.random.default_rng((seed, step, i)).uniform(-1, 1, 3 + K) for i in range(envs.num_envs)]
    return np.array(rows, np.float32)


def record(envs: TouchClassifyVectorEnv, num_steps: int, keep: int) -> list[bytes]:
    """Bytes of everything that the first `keep` environments return."""
    trajectory = []
    observation, infos = envs.reset(seed=5)
    for step in range(num_steps):
        observation, reward, terminated, truncated, infos = envs.step(random_actions(envs, 1, step))
        arrays = [*observation.values(), reward, terminated, truncated, infos["label"], infos["peak_force"], infos["success"]]
        trajectory += [array[:keep].tobytes() for array in arrays]
    return trajectory


def scene_with(folder: Path, sensors: tuple[str, str], key: str) -> Path:
    """The scene of the benchmark with the first sensor replaced by the second, and a further key of `randomization`."""
    scenes = taxelsim.SCENES
    text = (scenes / "benchmark/touch_classify.yaml").read_text().replace("../", f"{scenes}/").replace(*sensors)
    assert text.count("\nrandomization:\n") == 1
    file = folder / "scene.yaml"
    file.write_text(text.replace("\nrandomization:\n", f"\nrandomization:\n  {key}\n"))
    return file


@pytest.mark.parametrize("condition", ["nominal", "unseen"])
def test_trajectories_do_not_depend_on_the_number_of_environments(device: taxelsim.Device, condition: str) -> None:
    def trajectory(num_envs: int, keep: int) -> list[bytes]:
        return record(make(device, num_envs, num_touches=4, condition=condition), 9, keep)

    assert trajectory(7, 1) == trajectory(1, 1)
    if condition == "nominal":
        assert trajectory(64, 7) == trajectory(7, 7)


def test_labels_are_balanced_and_follow_the_seed(device: taxelsim.Device) -> None:
    envs = make(device, 2048)
    labels = envs.reset(seed=3)[1]["label"]
    expected = len(labels) / K
    # 5 standard deviations of a binomial count
    assert np.abs(np.bincount(labels, minlength=K) - expected).max() < 5 * math.sqrt(expected * (1 - 1 / K))
    assert (envs.reset(seed=3)[1]["label"] == labels).all()
    assert (envs.reset(seed=4)[1]["label"] != labels).any()
    assert (envs.reset()[1]["label"] != labels).any()  # the next episode of each environment


def test_reward_is_the_gain_of_log_likelihood(device: taxelsim.Device) -> None:
    envs = make(device, 5, num_touches=3, autoreset_mode=AutoresetMode.DISABLED)
    labels = envs.reset(seed=1)[1]["label"]
    actions = np.zeros((5, 3 + K), np.float32)
    rewards = envs.step(actions)[1]
    np.testing.assert_allclose(rewards, 0, atol=1e-12)  # equal logits: as before the first touch
    actions[np.arange(5), 3 + labels] = 0.1  # logit 1
    likelihood = 1 - math.log(math.e + K - 1)
    np.testing.assert_allclose(envs.step(actions)[1], likelihood + math.log(K))
    actions[np.arange(5), 3 + labels] = 1
    actions[0, 3 + labels[0]] = -1
    _, rewards, terminated, truncated, infos = envs.step(actions)
    sure = -math.log(1 + (K - 1) * math.exp(-10))
    np.testing.assert_allclose(rewards[1:], sure - likelihood)
    np.testing.assert_allclose(rewards[0], -10 - math.log(math.exp(-10) + K - 1) - likelihood)
    assert terminated.all()
    assert not truncated.any()
    assert infos["success"].tolist() == [False, True, True, True, True]


def test_observation_shows_the_touch_and_the_touches_left(device: taxelsim.Device) -> None:
    envs = make(device, 3, num_touches=2)
    observation, _ = envs.reset(seed=0)
    assert envs.observation_space.contains(observation)
    assert not observation["tactile_image"].any()
    assert (observation["touches_left"] == 1).all()
    actions = np.zeros((3, 3 + K), np.float32)
    actions[1, :2] = 1  # off the object
    actions[1, 2] = 0.25  # by 45 degrees: the corner of the array stays away
    actions[2, 0] = 0.1
    observation, _, _, _, infos = envs.step(actions)
    assert envs.observation_space.contains(observation)
    assert (observation["touch"] == actions[:, :3]).all()
    assert (observation["touches_left"] == 0.5).all()
    assert infos["contact"].tolist() == [True, False, True]
    assert observation["tactile_image"].any((1, 2)).tolist() == [True, False, True]
    np.testing.assert_allclose(infos["peak_force"], [1, 0, 1], rtol=1e-3)
    observation, _, terminated, _, infos = envs.step(actions)
    assert terminated.all()
    assert infos["final_obs"][0]["touches_left"] == 0
    assert infos["final_info"]["peak_force"][2] == pytest.approx(1, rel=1e-3)
    assert not observation["tactile_image"].any()


def test_a_touch_over_the_middle_looks_the_same_for_all_objects(device: taxelsim.Device, tmp_path: Path) -> None:
    # With equal gains: the gains of the benchmark's sensors differ between episodes, whatever the object is.
    envs = make(device, 256, scene=scene_with(tmp_path, ("wts0614_soft_cover_calibrated", "wts0614_soft_cover"), "noise: 5"))
    labels = envs.reset(seed=2)[1]["label"]
    envs._object_poses[:] = 0
    image = envs.step(np.zeros((256, 3 + K), np.float32))[0]["tactile_image"]
    assert len(set(labels.tolist())) == K
    newtons = image / 2400
    # noise of 5 counts is 0.002 N; the bumps off the middle would show 0.05 N and more
    assert np.abs(newtons - np.median(newtons, 0)).max() < 0.03


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"observation": "image"}, "observation: 'image' is not allowed"),
        ({"num_touches": 0}, "num_touches: 0 is not allowed"),
        ({"workspace": math.nan}, "workspace: nan is not allowed"),
        ({"render_mode": "human"}, "render_mode: 'human' is not allowed"),
        ({"condition": "hard"}, "condition hard: not in this scene; it has nominal, randomized, unseen"),
    ],
)
def test_rejects_wrong_arguments(device: taxelsim.Device, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make(device, 2, **arguments)


@pytest.mark.parametrize(("name", "key"), [("stiffness", "stiffness: [0.5, 2]"), ("mounting_yaw", "mounting_yaw_deg: [0, 2]")])
def test_rejects_ranges_that_touches_do_not_draw(device: taxelsim.Device, tmp_path: Path, name: str, key: str) -> None:
    file = scene_with(tmp_path, NO_CHANGE, key)
    with pytest.raises(taxelsim.InputError, match=f"randomization.{name}: this environment touches with the sensor's own skin"):
        make(device, 1, scene=file)


def test_gymnasium_makes_it_and_renders(device: taxelsim.Device) -> None:
    envs = gymnasium.make_vec("taxelsim/TouchClassify-v0", num_envs=2, render_mode="rgb_array", observation="contact")
    assert isinstance(envs, TouchClassifyVectorEnv)
    assert envs.reset(seed=0)[0]["contact"].shape == (2, 3)
    pictures = envs.render()
    assert pictures is not None
    assert len(pictures) == 2
    assert pictures[0].dtype == np.uint8
    envs.close()


# A policy for places: (step, centre of the middle bump (N, 2) in m after the first touch) -> touches (N, 3) in [-1, 1].
Places = Callable[[int, np.ndarray], np.ndarray]
NUM_ANGLES = 24
RING = 0.009  # m, radius at which the bumps lie
PITCH = 0.0034  # m


def random_places(num_envs: int) -> Places:
    return lambda step, middle: np.random.default_rng((11, step)).uniform(-1, 1, (num_envs, 3))


def scan(num_envs: int, workspace: float) -> Places:
    """First the middle, then all around it, with the long side of the array across the radius."""

    def places(step: int, middle: np.ndarray) -> np.ndarray:
        if step == 0:
            return np.zeros((num_envs, 3))
        angle = 2 * np.pi * step / 15
        around = (middle + 0.0155 * np.array([np.cos(angle), np.sin(angle)])) / workspace
        return np.column_stack((around, np.full(num_envs, np.remainder(angle / np.pi + 1, 2) - 1)))

    return places


def episodes(envs: TouchClassifyVectorEnv, places: Places) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Labels (E), touches (E, T, 3), and images (E, T, taxels) in N of one episode per environment."""
    labels = envs.reset(seed=11)[1]["label"]
    middle = np.zeros((envs.num_envs, 2))
    touches, images = [], []
    for step in range(envs.num_touches):
        actions = np.zeros((envs.num_envs, 3 + K), np.float32)
        actions[:, :3] = places(step, middle)
        observation, _, _, _, infos = envs.step(actions)
        image = observation["tactile_image"]
        if step == envs.num_touches - 1:
            image = np.array([row["tactile_image"] for row in infos["final_obs"]])
        touches.append(actions[:, :3].astype(float))
        images.append(image.reshape(envs.num_envs, -1) / 2400)
        if step == 0:
            middle = images[0] @ envs.scene.sensor.taxel_positions[:, :2] / np.maximum(images[0].sum(1, keepdims=True), 1e-9)
    return labels, np.stack(touches, 1), np.stack(images, 1)


def evidence(points: np.ndarray, touches: np.ndarray, images: np.ndarray, workspace: float) -> np.ndarray:
    """Largest force (E, P), N, that any touch measured at points (E, P, 2) of the workspace."""
    largest = np.zeros(points.shape[:2])
    rows = np.arange(len(points))[:, None]
    for t in range(touches.shape[1]):
        x, y = np.moveaxis(points - workspace * touches[:, t, None, :2], -1, 0)
        cos, sin = np.cos(np.pi * touches[:, t, 2:]), np.sin(np.pi * touches[:, t, 2:])
        i = np.rint((cos * x + sin * y) / PITCH + 2.5).astype(int)
        j = np.rint((cos * y - sin * x) / PITCH + 6.5).astype(int)
        inside = (i >= 0) & (i < 6) & (j >= 0) & (j < 14)
        largest = np.maximum(largest, np.where(inside, images[rows, t, np.clip(14 * i + j, 0, 83)], 0))
    return largest


def describe(touches: np.ndarray, images: np.ndarray, workspace: float) -> np.ndarray:
    """Features (E, F) that depend neither on the place nor on the yaw of the object: spectrum of the forces around the strongest point."""
    grid = np.stack(np.meshgrid(*2 * [np.linspace(-0.01, 0.01, 11)], indexing="ij"), -1).reshape(-1, 2)
    forces = evidence(np.broadcast_to(grid, (len(touches), *grid.shape)), touches, images, workspace)
    near = np.exp(-((np.linalg.norm(grid[:, None] - grid[None], axis=-1) / 0.002) ** 2) / 2)
    middle = grid[(forces @ near).argmax(1)]
    angles = 2 * np.pi * np.arange(NUM_ANGLES) / NUM_ANGLES
    ring = middle[:, None] + RING * np.column_stack((np.cos(angles), np.sin(angles)))
    return np.abs(np.fft.rfft(evidence(ring, touches, images, workspace), axis=1))


def accuracy(features: np.ndarray, labels: np.ndarray) -> float:
    """Share of right answers of the 15 nearest neighbours: trained on three quarters, tested on the rest."""
    split = len(labels) * 3 // 4
    scaled = (features - features[:split].mean(0)) / (features[:split].std(0) + 1e-9)
    train, test = scaled[:split], scaled[split:]
    distances = (test**2).sum(1)[:, None] + (train**2).sum(1) - 2 * test @ train.T
    votes = labels[:split][np.argsort(distances, 1)[:, :15]]
    answers = np.array([np.bincount(row, minlength=K).argmax() for row in votes])
    return float((answers == labels[split:]).mean())


def test_touches_tell_the_objects_apart(device: taxelsim.Device) -> None:
    envs = make(device, 1000)
    workspace = envs.workspace
    labels, touches, images = episodes(envs, random_places(envs.num_envs))
    of_random = accuracy(describe(touches, images, workspace), labels)
    blind = accuracy(touches.reshape(len(labels), -1), labels)
    labels, touches, images = episodes(envs, scan(envs.num_envs, workspace))
    of_scan = accuracy(describe(touches, images, workspace), labels)
    one = accuracy(describe(touches[:, :1], images[:, :1], workspace), labels)
    print(f"right answers: {of_scan:.3f} of a scan, {of_random:.3f} of random touches, {one:.3f} of one touch, {blind:.3f} blind")
    # With 1600 environments: 0.61, 0.43, 0.12 and 0.11. The test part has 250 episodes, the standard deviation of a share is 0.03.
    assert of_random > 0.25
    assert of_scan > 0.4
    # 5 standard deviations of chance
    assert max(one, blind) < 1 / K + 5 * math.sqrt((1 - 1 / K) / K / 250)
