"""Touch in environments of robosuite and Gymnasium-Robotics, compared with MuJoCo's contacts and with the touch sensors of a hand.

Not collected by default: needs python/requirements/robots.txt, which has MuJoCo 3 (scripts/campaign robots).
"""

import gymnasium
import gymnasium_robotics
import mujoco
import numpy as np
import pytest
import robosuite

import taxelsim
import taxelsim.mujoco
from taxelsim._arrays import rotation_matrices
from taxelsim.mujoco.batch import STATE
from taxelsim.mujoco.environments import TactileObservation, Touch, add_observables

from .models import WTS

gymnasium.register_envs(gymnasium_robotics)

# Stiff enough to carry the grip of a robot on the edge of a pad.
PAD = taxelsim.load_sensor(WTS).replace(skin=taxelsim.load_sensor(WTS).skin.replace(law=taxelsim.Winkler(normal_contact_stiffness=2.5e9)))
PITCH = 0.004  # m, of the grids on the pads of grippers
SUM_ERROR = 1e-3  # relative, of forces="engine" (docs/how_to/mujoco.md)
LEAST_FORCE = 0.05  # N, at which a pad surely has counts: the trigger of a taxel is at a few mN
FINGERS = ("ff", "mf", "rf", "lf", "th")
# Share of frames in which a fingertip of the hand feels the block, or not, as the touch sensors of the environment do. Taxels are flat:
# their corners lie up to 0.2 mm over a tip, and their samples miss a corner of the block that is less than 0.07 mm deep. The sensors of the
# environment belong to the start of the last time step, 2 ms before the frame.
AGREEMENT = 0.98


def contact_forces(data: mujoco.MjData, sensors: dict[str, taxelsim.mujoco.GeomSensor], other: str) -> dict[str, tuple[float, np.ndarray]]:
    """Of MuJoCo's contacts of each sensor's geom with another at the present state: force along -z of S, N, and points (C, 3) in S, m."""
    model, state = data.model, np.empty(mujoco.mj_stateSize(data.model, STATE))
    now = mujoco.MjData(model)
    mujoco.mj_getState(model, data, state, STATE)
    mujoco.mj_setState(model, now, state, STATE)
    mujoco.mj_forward(model, now)
    results = {}
    for name, sensor in sensors.items():
        turn = now.geom_xmat[sensor.geom].reshape(3, 3)
        origin = now.geom_xpos[sensor.geom] + turn @ sensor.X_GS.position
        rotation = turn @ rotation_matrices(np.array([sensor.X_GS.rotation]))[0]
        total, points, wrench = 0.0, [], np.empty(6)
        for k, contact in enumerate(now.contact):
            if set(contact.geom) == {sensor.geom, model.geom(other).id}:
                mujoco.mj_contactForce(model, now, k, wrench)
                total += wrench[0] * abs(contact.frame[:3] @ rotation[:, 2])
                points.append((contact.pos - origin) @ rotation)
        results[name] = total, np.array(points)
    return results


def check_pads(touch: Touch, observation: dict, data: mujoco.MjData, sensors: dict, other: str) -> list[bool]:
    """Pads feel what MuJoCo's contacts press with, and between their points. Returns which are touched."""
    frames = touch.tactile.observe(data, forces="engine")
    touched = []
    for name, (force, points) in contact_forces(data, sensors, other).items():
        assert frames[name].ground_truth.total_force[0] == pytest.approx(force, rel=SUM_ERROR)
        is_touched = bool(np.any(observation[f"{name}/tactile_image"]))
        if force == 0 or force > LEAST_FORCE:
            assert is_touched == (force > 0)
            assert np.all(observation[f"{name}/binary_contact"] == is_touched)
        if is_touched:
            center = observation[f"{name}/center_of_pressure"]
            assert (center[:2] > points[:, :2].min(axis=0) - PITCH).all()
            assert (center[:2] < points[:, :2].max(axis=0) + PITCH).all()
        touched.append(is_touched)
    return touched


OPTIONS = {"forces": "engine", "observations": ("tactile_image", "binary_contact", "center_of_pressure")}


def test_pads_of_a_panda_lift_a_cube(device: taxelsim.Device) -> None:
    env = robosuite.make(
        "Lift", robots="Panda", has_renderer=False, has_offscreen_renderer=False, use_camera_obs=False, initialization_noise=None, seed=0
    )

    def pads(model: mujoco.MjModel) -> dict[str, taxelsim.mujoco.GeomSensor]:
        return {
            f"pad{k}": taxelsim.mujoco.grid_on_geom(
                model, f"gripper0_right_finger{k}_pad_collision", 4, 4, PITCH, direction=(0, side, 0), like=PAD
            )
            for k, side in ((1, -1), (2, 1))
        }

    touch = add_observables(env, pads, ["cube_g0"], device=device, **OPTIONS)
    first = touch.tactile
    observation = env.reset()  # makes a new model
    assert touch.tactile is not first
    assert observation["pad1/tactile_image"].shape == (4, 4)
    model, data = env.sim.model._model, env.sim.data._data
    sensors, both = pads(model), 0
    for step in range(36):
        error = observation["cube_pos"] - observation["robot0_eef_pos"]
        is_closing = step > 22
        move = np.clip(20 * error * (1, 1, step > 5), -1, 1)
        env.step([*(0 * move if is_closing else move), 0, 0, 0, 1 if is_closing else -1])
        observation = env._get_observations(force_update=True)
        touched = check_pads(touch, observation, data, sensors, "cube_g0")
        assert is_closing or not any(touched)
        both += all(touched)
    assert both >= 5
    for enabled in (False, True):  # an observable that was off gives the present state, not that at which the others were read last
        env.modify_observable("pad1/tactile_image", "enabled", enabled)
        assert ("pad1/tactile_image" in env._get_observations(force_update=not enabled)) == enabled
    data.time += 0.01
    env.sim.data.set_joint_qpos("cube_joint0", [0, 0, 2, 1, 0, 0, 0])
    assert not env._get_observations(force_update=True)["pad1/tactile_image"].any()
    with pytest.raises(taxelsim.InputError, match=r"^sensors: 'pad1/binary_contact' is an observation of the environment already$"):
        add_observables(env, pads, ["cube_g0"], device=device, **OPTIONS)


def test_fingers_of_fetch_grip_a_block(device: taxelsim.Device) -> None:
    """The fingers are boxes that point along x of the gripper; finger r is at +y and faces -y."""

    def fingers(model: mujoco.MjModel) -> dict[str, taxelsim.mujoco.GeomSensor]:
        return {
            side: taxelsim.mujoco.grid_on_geom(
                model, f"robot0:{side}_gripper_finger_link", 18, 6, PITCH, direction=(0, -1 if side == "r" else 1, 0), like=PAD
            )
            for side in "rl"
        }

    env = TactileObservation(gymnasium.make("FetchPickAndPlace-v4"), fingers, ["object0"], device=device, **OPTIONS)
    observation, _ = env.reset(seed=0)
    sensors, both = fingers(env.unwrapped.model), 0
    for step in range(24):
        assert env.observation_space.contains(observation)
        error = observation["observation"][6:9]  # from the gripper to the block
        is_closing = step > 14
        move = np.clip(20 * error * (1, 1, step > 4), -1, 1)
        observation, *_ = env.step(np.array([*(0 * move if is_closing else move), -1 if is_closing else 1], np.float32))
        touched = check_pads(env.touch, observation, env.unwrapped.data, sensors, "object0")
        assert is_closing or not any(touched)
        both += all(touched)
    assert both >= 3


def test_fingertips_feel_what_the_touch_sensors_of_a_hand_feel(device: taxelsim.Device) -> None:
    def tips(model: mujoco.MjModel) -> dict[str, taxelsim.mujoco.GeomSensor]:
        return {finger: taxelsim.mujoco.cover_geom(model, f"robot0:C_{finger}distal", 0.0025) for finger in FINGERS}

    base = gymnasium.make("HandManipulateBlock_BooleanTouchSensors-v1")
    env = TactileObservation(base, tips, ["object"], device=device, observations="binary_contact")
    model, data = env.unwrapped.model, env.unwrapped.data
    names = [model.sensor(int(k)).name for k in env.unwrapped._touch_sensor_id]
    columns = {finger: [k for k, name in enumerate(names) if name.startswith(f"robot0:TS_{finger}tip")] for finger in FINGERS}
    block, felt, theirs = model.geom("object").id, [], []
    random = np.random.default_rng(0)
    for step in range(120):
        if step % 60 == 0:
            env.reset(seed=step)
        if step % 10 == 0:
            action = random.uniform(-1, 1, 20).astype(np.float32)
        observation, *_ = env.step(action)
        touch = observation["observation"][-len(names) :]
        for finger in FINGERS:
            tip = model.geom(f"robot0:C_{finger}distal").id
            if not any(tip in pair and block not in pair for pair in data.contact.geom):  # fingers touch each other as well
                felt.append(observation[f"{finger}/binary_contact"][0] == 1)
                theirs.append(touch[columns[finger]].any())
    felt, theirs = np.array(felt), np.array(theirs)
    print(f"{len(felt)} fingertips: {felt.sum()} touched, {theirs.sum()} by the environment; {np.mean(felt == theirs):.4f} agree")
    assert min(theirs.sum(), (~theirs).sum()) > 50
    assert np.mean(felt == theirs) >= AGREEMENT
