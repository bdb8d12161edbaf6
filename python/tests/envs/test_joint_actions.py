"""Joint velocities as actions of environments and policies."""

import numpy as np
import pytest

import taxelsim
from taxelsim.envs import TactileVectorEnv
from taxelsim.policies import Policy

from .conftest import NUM_STEPS, PAN_TILT, write_scene

SPEED = np.deg2rad(59 * 6)  # rad/s, velocity limit of both joints: 59 rpm

# An arm of one joint without a velocity limit.
URDF = """<robot name="arm"><link name="base"/><link name="tip"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint></robot>"""


def test_actions_are_parts_of_the_velocity_limits(device, pan_tilt_scene):
    envs = TactileVectorEnv(pan_tilt_scene, 2, action="joint_velocities", observations="proprioception", device=device)
    assert envs.single_action_space.shape == (2,)
    envs.reset(seed=1)
    observation, *_ = envs.step(np.array([[0.01, -0.02], [0, 0.03]]))
    assert observation[:, 7:] == pytest.approx(np.array([[0.01, -0.02], [0, 0.03]]) * SPEED * 0.01, rel=1e-6)
    tilt = TactileVectorEnv(pan_tilt_scene, 1, action="joint_velocities", actions="tilt", angular_scale=0.5, device=device)
    assert tilt.single_action_space.shape == (1,)
    tilt.reset(seed=1)
    tilt.step(np.array([[1.0]]))
    assert tilt._frame.joint_positions[0] == pytest.approx([0, 0.005], rel=1e-12)


def twist(observation: np.ndarray) -> np.ndarray:
    """w_y and w_z, rad/s."""
    return np.tile([0.9, 0.3], (len(observation), 1))


def joint_velocities(observation: np.ndarray) -> np.ndarray:
    """J^+ of the same twist: pan about z of the base, tilt about y of the sensor. The second joint has tilted the sensor."""
    w_y, w_z = twist(observation).T
    return np.stack([w_z / np.cos(observation[:, 8].astype(float)), w_y], axis=1)


def test_pseudo_inverse_of_a_twist_moves_as_the_twist(device, pan_tilt_scene, tmp_path):
    common = {"observations": "proprioception", "angular_scale": 1.0, "identity": "test"}
    policies = {
        "twist": Policy(twist, name="twist", actions=("w_y", "w_z"), **common),
        "joints": Policy(joint_velocities, name="joints", action="joint_velocities", **common),
    }
    scene = taxelsim.load_scene(write_scene(tmp_path, robot=PAN_TILT, record="tactile_image, robot"))
    positions, verdicts = {}, {}
    for name, policy in policies.items():
        taxelsim.generate(scene, tmp_path / name, policy=policy, device=device)
        positions[name] = taxelsim.Dataset(tmp_path / name)["data/robot/joint_position"][:]
        verdicts[name] = taxelsim.evaluate(scene, policy=policy, device=device)[0].verdicts
    # The observed tilt t < 0.13 is rounded to float32, by at most 2^-28: pan' = w_z / cos t is off by 0.3 tan(t) / cos(t) 2^-28 < 2e-10
    # rad/s for 0.12 s.
    assert np.abs(positions["joints"] - positions["twist"]).max() < 2e-10 * 0.12
    assert positions["twist"][NUM_STEPS] == pytest.approx([0.036, 0.108], rel=1e-2)
    assert verdicts["joints"]["travel"] == pytest.approx(verdicts["twist"]["travel"], rel=1e-5)
    assert (verdicts["twist"]["travel"] > 1e-3).all()


def late(change):
    calls = []

    def act(observation):
        calls.append(1)
        actions = np.zeros((len(observation), 2))
        return actions if len(calls) < 5 else change(actions)

    return Policy(act, action="joint_velocities", check_batch=False)


def failing(actions):
    raise KeyError("no weights")


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (
            lambda actions: np.where(np.arange(24)[:, None] == 2, np.nan, actions),
            taxelsim.InputError,
            r"nan found in episode 2 \(instance 2\)",
        ),
        (lambda actions: actions[:, :1], taxelsim.InputError, r"shape \(24, 1\) is not allowed: \(24, 2\)"),
        (lambda actions: actions.T, taxelsim.InputError, r"\(2, 24\) is not allowed: .*; did you mean"),
        (failing, KeyError, "no weights"),
    ],
)
def test_bad_actions_of_policies_are_refused(device, pan_tilt_scene, change, error, message):
    with pytest.raises(error, match=message):
        taxelsim.evaluate(pan_tilt_scene, policy=late(change), device=device, num_slices=1)


def test_bad_actions_of_environments_are_refused(device, pan_tilt_scene):
    envs = TactileVectorEnv(pan_tilt_scene, 3, action="joint_velocities", device=device)
    envs.reset(seed=0)
    actions = np.zeros((3, 2))
    actions[1, 0] = np.nan
    with pytest.raises(taxelsim.InputError, match="nan found in environment 1, dimension 0") as caught:
        envs.step(actions)
    assert caught.value.instance == 1
    with pytest.raises(taxelsim.InputError, match=r"shape \(3, 6\) is not allowed: \(3, 2\)"):
        envs.step(np.zeros((3, 6)))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"action": "torques"}, "action: 'torques' is not allowed: twist, joint_velocities"),
        ({"action": "joint_velocities", "actions": "elbow"}, "actions: 'elbow' is not allowed: pan, tilt"),
        ({"action": "joint_velocities", "angular_scale": 0}, "angular_scale: 0 is not allowed"),
    ],
)
def test_unknown_actions_are_refused(device, pan_tilt_scene, arguments, message):
    with pytest.raises(taxelsim.InputError, match=message):
        TactileVectorEnv(pan_tilt_scene, 1, device=device, **arguments)
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.evaluate(pan_tilt_scene, policy=Policy(twist, **arguments), device=device)


def test_robots_without_joints_or_limits_are_refused(device, scene, tmp_path):
    for run in (TactileVectorEnv, lambda scene, **arguments: taxelsim.evaluate(scene, policy=Policy(twist, **arguments), device=device)):
        with pytest.raises(taxelsim.InputError) as caught:
            run(scene, action="joint_velocities")
        assert str(caught.value) == (
            f"{scene.file}: action: 'joint_velocities' is not allowed: 'twist', as the robot of this scene has no joints"
        )
    (tmp_path / "arm.urdf").write_text(URDF)
    arm = taxelsim.load_scene(write_scene(tmp_path, robot="{urdf: {file: arm.urdf, sensors: [{link: tip}]}}"))
    with pytest.raises(taxelsim.InputError, match="actions: joint 'turn' has no velocity limit, so angular_scale is needed"):
        TactileVectorEnv(arm, 1, action="joint_velocities", device=device)
    TactileVectorEnv(arm, 1, action="joint_velocities", angular_scale=1, device=device)
