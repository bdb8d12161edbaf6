"""Environments and policies of scenes of kind grasp: several sensors of different kinds, joints as actions."""

import json
from dataclasses import replace

import numpy as np
import pytest

import taxelsim
from taxelsim.commands.evaluate import main
from taxelsim.envs import Reward, TactileEnv, TactileVectorEnv
from taxelsim.policies import Policy

from ..policies.networks import write_mlp

GRIPPER = taxelsim.SCENES / "gripper_grasp.yaml"  # sensors left (6 x 4), right (6 x 14), below (6 x 4); fingers left and below; 100 Hz
JOINTS = ("jaw", "bend")
ALL = (
    "contact",
    "tactile_image",
    "binary_contact",
    "target_force",
    "joint_positions",
    "joint_velocities",
    "right/features",
    "proprioception",
)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> taxelsim.Scene:
    """Grasps of 90 frames: the jaws touch after 50 frames or earlier."""
    text = GRIPPER.read_text().replace("robots/", f"{taxelsim.SCENES.resolve()}/robots/").replace("num_steps: 150", "num_steps: 90")
    file = tmp_path_factory.mktemp("hand") / "hand.yaml"
    file.write_text(text.replace("episodes: 64", "episodes: 5") + "task: {tolerance: 0.25, hold: 0.1}\n")
    return taxelsim.load_scene(file)


def holding(observation: dict) -> np.ndarray:
    """Closes until a finger touches, then by the relative error of its force: a policy without memory."""
    forces = -observation["contact"][:, [0, 2], 5]
    return np.where(forces > 0, 0.1 * (observation["target_force"] - forces) / observation["target_force"], 1.0)


POLICY = Policy(holding, "holding", "test", ("contact", "target_force"), linear_scale=0.05, angular_scale=1)


def trajectory(envs: TactileVectorEnv, num_steps: int, row: int) -> list[bytes]:
    observation, _ = envs.reset(seed=4)
    seen = []
    for step in range(num_steps):
        actions = np.sin(0.1 * step + np.arange(envs.num_envs)[:, None] + np.arange(envs.num_actions)).astype(np.float32)
        observation, reward, *_ = envs.step(actions)
        seen.append(b"".join(values[row].tobytes() for values in observation.values()) + reward[row].tobytes())
    return seen


def test_trajectories_do_not_depend_on_the_number_of_environments(device, scene):
    """Nor on other environments that are reset at other times."""
    envs = TactileVectorEnv(scene, 3, observations=ALL, device=device)
    alone = TactileVectorEnv(scene, 2, observations=ALL, device=device)
    expected = trajectory(envs, 95, 1)  # beyond the end of the first episode
    assert len(set(expected)) == 95
    assert trajectory(alone, 95, 1) == expected
    assert trajectory(envs, 95, 1) == expected
    disturbed = TactileVectorEnv(scene, 3, observations=ALL, device=device, autoreset_mode="Disabled")
    disturbed.reset(seed=4)
    seen = []
    for step in range(60):
        if step in (7, 31):
            disturbed.reset(options={"reset_mask": np.array([True, False, True])})
        actions = np.sin(0.1 * step + np.arange(3)[:, None] + np.arange(2)).astype(np.float32)
        observation, reward, *_ = disturbed.step(actions)
        seen.append(b"".join(values[1].tobytes() for values in observation.values()) + reward[1].tobytes())
    assert seen == expected[:60]


def test_environment_generate_and_evaluate_play_the_same_episodes(device, scene, tmp_path):
    """Frames of a data set and verdicts are those of an environment that gets the same velocities."""
    taxelsim.generate(scene, tmp_path / "a", policy=POLICY, device=device, batch_size=2)
    taxelsim.generate(scene, tmp_path / "b", policy=POLICY, device=device, batch_size=5)
    data = taxelsim.Dataset(tmp_path / "a")
    evaluation, by_law = taxelsim.evaluate_grasp(scene, [10], policy=POLICY, device=device, batch_size=3)
    assert (evaluation.policy, by_law.policy, by_law.gain) == ("holding", "", 10)
    batch = taxelsim.GraspEnvironment(device, scene, 5)
    batch.reset(np.ones(5, bool), np.arange(5))
    frames = [batch.observe().copy()]
    for frame in range(89):
        velocities = data["data/robot/joint_velocity"][frame + 1 :: 90]
        batch.step_joints(velocities)
        frames.append(batch.observe().copy())
    for name in ("left", "right", "below"):
        images = np.stack([frame.sensors[name].tactile_image for frame in frames], axis=1)
        assert np.array_equal(data[f"data/{name}/tactile_image"][:], images.reshape(-1, *images.shape[2:]))
        assert np.array_equal(taxelsim.Dataset(tmp_path / "b")[f"data/{name}/tactile_image"][:], data[f"data/{name}/tactile_image"][:])
    verdicts = batch.judge(np.arange(5))
    for name, values in evaluation.verdicts.items():
        np.testing.assert_array_equal(values, verdicts[name], err_msg=name)
    assert evaluation.total.num_held == 5  # of a force within 25 %
    assert not np.array_equal(evaluation.verdicts["peak_force"], by_law.verdicts["peak_force"])
    with pytest.raises(taxelsim.InputError, match="policy"):
        taxelsim.generate(scene, tmp_path / "a", policy=replace(POLICY, identity="other"), device=device)


def test_observations_of_sensors_and_joints(device, scene):
    names = (*ALL, "left/contact", "below/tactile_image", "left/center_of_pressure")
    envs = TactileVectorEnv(scene, 2, observations=names, device=device, action="joint_positions")
    observation, _ = envs.reset(seed=0)
    shapes = {name: values.shape[1:] for name, values in observation.items()}
    assert shapes == {
        "contact": (3, 6),
        "tactile_image": (24 + 84 + 24,),
        "binary_contact": (3,),
        "target_force": (2,),
        "joint_positions": (2,),
        "joint_velocities": (2,),
        "right/features": (13,),
        "proprioception": (23,),
        "left/contact": (6,),
        "below/tactile_image": (6, 4),
        "left/center_of_pressure": (3,),
    }
    for _ in range(60):
        observation, *_ = envs.step(np.ones((2, 2), np.float32))
    frame = envs._environment.observe()
    images = [frame.sensors[name].tactile_image.reshape(2, -1) for name in ("left", "right", "below")]
    assert np.array_equal(observation["tactile_image"], np.concatenate(images, axis=1))
    assert np.array_equal(observation["below/tactile_image"], frame.sensors.below.tactile_image)
    forces = np.stack([frame.sensors[name].total_force for name in ("left", "right", "below")], axis=1)
    assert np.array_equal(observation["contact"][..., 5], -forces)
    assert np.array_equal(observation["binary_contact"], forces > 0)
    assert observation["binary_contact"].any()
    assert np.array_equal(observation["left/contact"], observation["contact"][:, 0])
    assert np.array_equal(observation["left/center_of_pressure"], observation["contact"][:, 0, :3])


def test_normalised_counts_reach_from_0_to_1_with_history(device, scene):
    envs = TactileVectorEnv(scene, 1, observations="tactile_image", normalized=True, history=3, device=device)
    space = envs.single_observation_space
    assert space.shape == (3, 132)
    assert (space.low.min(), space.high.max()) == (0, 1)
    assert space.contains(envs.reset(seed=0)[0][0])


def test_positions_are_parts_of_the_joints_range(device, scene):
    """Action 1 is the upper limit: a joint gets there at its velocity limit, and stays."""
    limits = {name: (velocity, lower, upper) for name, _, velocity, lower, upper in taxelsim._core.joints_of(scene)}
    envs = TactileVectorEnv(scene, 1, action="joint_positions", actions="bend", observations="joint_positions", device=device)
    start = envs.reset(seed=0)[0][0]
    velocity, lower, upper = limits["bend"]
    goal = lower + 0.75 * (upper - lower)
    for step in range(1, 60):
        position = envs.step(np.array([[0.5]]))[0][0]
        distance = min(abs(goal - start[1]), velocity * 0.01 * step)
        assert position[1] == pytest.approx(start[1] + np.sign(goal - start[1]) * distance, rel=1e-6, abs=1e-7)
        assert position[0] == start[0]
    assert position[1] == pytest.approx(goal, rel=1e-6)


def test_actions_hold_for_a_control_period(device, scene, tmp_path):
    slow = tmp_path / "slow.yaml"
    slow.write_text(scene.file.read_text().replace("simulation_rate: 100", "simulation_rate: 100, control_rate: 25"))
    calls = []

    def counted(observation):
        calls.append(len(observation))
        return np.full((len(observation), 2), 0.2)

    policy = Policy(counted, observations="left/contact", identity="counted", check_batch=False)
    taxelsim.generate(taxelsim.load_scene(slow), tmp_path / "out", policy=policy, device=device)
    assert calls == [5] * 23  # frames 0, 4, ..., 88 of 90
    envs = TactileVectorEnv(slow, 1, device=device)
    assert (envs.step_time, envs.max_episode_steps) == (0.04, 23)
    envs.reset(seed=0)
    ends = [envs.step(np.full((1, 2), 0.2))[3][0] for _ in range(23)]
    assert ends == [False] * 22 + [True]


def test_reward_counts_fingers_that_hold(device, scene):
    """A finger without contact is off by its whole target, 4 tolerances of 25 %: exp(-16)."""
    envs = TactileVectorEnv(scene, 1, device=device, reward=Reward(force_penalty=0))
    envs.reset(seed=0)
    _, rewards, *_, infos = envs.step(np.zeros((1, 2)))
    assert rewards[0] == pytest.approx(np.exp(-16.0), rel=1e-6)
    assert infos["force_error"][0] == pytest.approx(envs._frame.target_forces[0])
    rewards = []
    for _ in range(85):
        observation = {"contact": envs._observe(), "target_force": envs._frame.target_forces}
        rewards.append(envs.step(POLICY.function(observation) * np.array([0.05, 1]) / envs._actions.scales)[1][0])
    assert rewards[-1] > 0.8
    envs.reset(seed=0)
    for _ in range(65):
        envs.step(np.ones((1, 2)))
    for _ in range(30):
        _, rewards, terminated, _, infos = envs.step(-np.ones((1, 2)))
        if infos["num_losses"].any():
            break
    assert rewards[0] == -1  # contact was lost
    assert not terminated[0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"action": "twist"}, "action: 'twist' is not allowed: joint_velocities, joint_positions"),
        ({"action": "joint_torques"}, "'joint_torques' is not allowed: joint_velocities, joint_positions"),
        ({"actions": "elbow"}, "actions: 'elbow' is not allowed: jaw, bend"),
        ({"action": "joint_positions", "angular_scale": 1}, "angular_scale: 1 is not allowed with 'joint_positions'"),
        ({"observations": "top/contact"}, "observations: 'top/contact' is not allowed: contact"),
        ({"observations": "taxel_counts"}, "'taxel_counts' needs a sensor with readout.three_axis"),
        ({"observations": ("binary_contact", "binary_contact")}, "'binary_contact' found twice"),
    ],
)
def test_what_a_hand_has_not_is_refused(device, scene, arguments, message):
    for run in (TactileVectorEnv, lambda scene, **each: taxelsim.evaluate_grasp(scene, policy=Policy(holding, **each), device=device)):
        with pytest.raises(taxelsim.InputError, match=message):
            run(scene, **arguments, **({"device": device} if run is TactileVectorEnv else {}))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda actions: np.where(np.arange(len(actions))[:, None] == 1, np.inf, actions), r"inf found in episode 1 \(instance 1\)"),
        (lambda actions: actions[:, :1], r"shape \(5, 1\) is not allowed: \(5, 2\)"),
        (lambda actions: actions.astype(int), "dtype int64 is not allowed"),
    ],
)
def test_bad_actions_are_refused(device, scene, change, message, tmp_path):
    policy = Policy(lambda o: change(np.zeros((len(o), 2))), identity="bad", check_batch=False)
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.evaluate_grasp(scene, policy=policy, device=device)
    envs = TactileVectorEnv(scene, 5, device=device)
    envs.reset(seed=0)
    with pytest.raises(taxelsim.InputError, match=message.replace(r"episode 1 \(instance 1\)", "environment 1")):
        envs.step(change(np.zeros((5, 2))))
    batch = taxelsim.GraspEnvironment(device, scene, 2)
    batch.reset([True, True], [0, 1])
    with pytest.raises(taxelsim.InputError, match="nan of instance 1 is not finite"):
        batch.step_joints([[0.0, 0], [np.nan, 0]])
    assert batch.observe().frame_numbers.tolist() == [0, 0]


def test_command_compares_a_network_with_gains(device, scene, tmp_path, capsys):
    network = write_mlp(tmp_path / "net.onnx", 18 + 2, 2, settings={"observations": "contact,target_force", "actions": "jaw,bend"})
    arguments = [str(scene.file), "--policy", str(network), "--gain", "10"]
    assert main([*arguments, "--save-failures", str(tmp_path / "failures"), "--max-failures", "2"]) == 0
    output = capsys.readouterr()
    assert output.out.splitlines()[2].split()[:2] == ["policy", "finger"]
    assert "net - gain 10: " in output.out
    assert "wrote 2 of 5 failed episodes" in output.err
    assert taxelsim.Dataset(tmp_path / "failures")["meta/episode"][:].tolist() == [0, 1]
    assert main([*arguments, "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    control = taxelsim.evaluate_grasp(scene, [10], device=device)[0].total.num_held
    assert [entry["successes"] for entry in content["evaluations"]] == [0, control]
    assert control > 0
    for part in ("1/2", "2/2"):
        assert main([*arguments, "--part", part, "-o", str(tmp_path / "parts")]) == 0
    capsys.readouterr()
    assert main([*arguments, "--merge", str(tmp_path / "parts"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == content
    assert main([str(scene.file), "--policy", str(network), "--controller", "x"]) == 2
    assert "controllers are not allowed in a scene of kind grasp" in capsys.readouterr().err


def test_parts_together_are_the_evaluation(device, scene):
    """Also through text. A part of other gains or another policy is refused."""
    whole = taxelsim.evaluate_grasp(scene, [10], policy=POLICY, device=device)
    parts = [
        taxelsim.evaluate_part(scene, gains=[10], policy=POLICY, episodes=numbers, device=device, batch_size=2)
        for numbers in (range(3, 5), range(3))
    ]
    assert parts[0].controllers == ["holding", "gain 10"]
    assert taxelsim.EvaluationPart.from_json(parts[0].to_json()) == parts[0]
    merged = taxelsim.merge_grasp_evaluations(scene, parts, [10], policy=POLICY)
    for mine, expected in zip(merged, whole, strict=True):
        assert (mine.policy, mine.gain, mine.total.num_held) == (expected.policy, expected.gain, expected.total.num_held)
        for name, values in expected.verdicts.items():
            np.testing.assert_array_equal(mine.verdicts[name], values)
    with pytest.raises(taxelsim.InputError, match=r"part 0: has another set of controllers \(holding, gain 10 there, holding, gain 5 exp"):
        taxelsim.merge_grasp_evaluations(scene, parts, [5], policy=POLICY)
    with pytest.raises(taxelsim.InputError, match=r"episodes 0\.\.2 are missing"):
        taxelsim.merge_grasp_evaluations(scene, parts[:1], [10], policy=POLICY)
    with pytest.raises(taxelsim.InputError, match="differs from its SHA-256"):
        taxelsim.EvaluationPart.from_json(parts[0].to_json().replace('"num_fingers": 2', '"num_fingers": 3'))


def test_pictures_show_all_sensors(device, scene):
    env = TactileEnv(scene, device=device, render_mode="rgb_array")
    env.reset(seed=0)
    dark = env.render()
    for _ in range(60):
        env.step(np.ones(2))
    assert dark.shape == env.render().shape
    assert (env.render() != dark).any()
