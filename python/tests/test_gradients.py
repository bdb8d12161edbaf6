"""Gradients by pose and gains against central differences of the simulated forces."""

from __future__ import annotations

import numpy as np
import pytest

import taxelsim

LIFT = 0.006  # m
STEP = 2e-6  # m; and 200 times as much in rad
# Of the largest derivative. The pressure at a side of a taxel is the mean of the cells on both sides of it: where an outline crosses the
# side, the flux is off by up to half of a cell's, stiffness x depth (0.6 mm) x cell (0.85 mm) / 2. The force of the taxel changes with the
# depth by stiffness x 16 cells. Ratio: 0.022 a side; an outline crosses two sides of each of some eight taxels, whose cotangents have
# random signs: 0.022 sqrt(16) = 0.09.
TOLERANCE = 0.09


class Presser:
    """Presses objects 0 and 1 in turn on the instances of one simulator."""

    def __init__(self, sampling: taxelsim.DepthSampling, device: taxelsim.Device, count: int) -> None:
        sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").replace(depth_sampling=sampling)
        model = taxelsim.Model(device, sensor, [taxelsim.Box(size=[0.009, 0.006, 0.012]), taxelsim.Sphere(radius=0.006)])
        self.simulator = taxelsim.Simulator(model, count, outputs=taxelsim.OutputOptions(taxel_jacobian=True))

    def frame(self, poses: np.ndarray) -> taxelsim.Frame:
        self.simulator.reset()
        self.simulator.set_objects(np.arange(len(poses)) % 2, poses)
        self.simulator.step(0.01)
        return self.simulator.read().copy()


def moved(pose: np.ndarray, k: int, step: float) -> np.ndarray:
    """The pose of an object seen from a sensor that moved by coordinate `k` of its twist: the object moves back."""
    result = pose.copy()
    if k < 3:
        result[k] -= step
        return result
    axis = np.eye(3)[k - 3]
    c, s = np.cos(-step / 2), np.sin(-step / 2) * axis
    result[:3] = pose[:3] + 2 * np.cross(s, np.cross(s, pose[:3]) + c * pose[:3])
    w, v = pose[3], pose[4:]
    result[3:] = [c * w - s @ v, *(c * v + w * s + np.cross(s, v))]
    return result


@pytest.fixture(scope="module")
def device() -> taxelsim.Device:
    return taxelsim.Device.open()


def errors(sampling: taxelsim.DepthSampling, device: taxelsim.Device) -> np.ndarray:
    """Of a loss's gradient by the twist, relative to the largest of velocities and of rotations, for eight contacts."""
    rng = np.random.default_rng(3)
    poses = np.zeros((8, 7))
    poses[:, :2] = rng.uniform(-0.004, 0.004, (8, 2))
    poses[:, 2] = LIFT - rng.uniform(0.0003, 0.0006, 8)
    yaw = rng.uniform(0, np.pi, 8)
    poses[:, 3], poses[:, 6] = np.cos(yaw / 2), np.sin(yaw / 2)
    presser = Presser(sampling, device, len(poses))
    frame = presser.frame(poses)
    cotangent = rng.normal(size=frame.ground_truth.tactile_normal_force.shape)
    found = taxelsim.vjp(frame, cotangent).twist
    steps = STEP * np.array([1, 1, 1, 200, 200, 200])
    expected = np.empty_like(found)
    for k in range(6):
        ends = []
        for sign in (-1, 1):
            at = np.array([moved(pose, k, sign * steps[k]) for pose in poses])
            force = presser.frame(at).ground_truth.tactile_normal_force.astype(float)
            ends.append((force * cotangent).reshape(8, -1).sum(1))
        expected[:, k] = (ends[1] - ends[0]) / (2 * steps[k])
    scale = np.repeat([np.abs(expected[:, :3]).max(1), np.abs(expected[:, 3:]).max(1)], 3, axis=0).T
    return np.abs(found - expected) / scale


def test_pose_gradient_is_that_of_differences(device: taxelsim.Device) -> None:
    area = errors(taxelsim.DepthSampling.AREA, device)
    assert area.max() < TOLERANCE
    assert errors(taxelsim.DepthSampling.POINT, device).mean() > 2 * area.mean()  # the baseline


def test_gradient_by_gains_and_what_is_refused(device: taxelsim.Device) -> None:
    pose = np.array([[0, 0, LIFT - 0.0004, 1, 0, 0, 0]], dtype=float)
    frame = Presser(taxelsim.DepthSampling.AREA, device, 1).frame(pose)
    force = frame.ground_truth.tactile_normal_force
    gain = np.linspace(0.5, 1.5, force.size).reshape(force.shape)
    found = taxelsim.vjp(frame, gain * force, gain)  # of the loss sum((gain * force)^2) / 2
    np.testing.assert_allclose(found.gain, gain * np.square(force, dtype=np.float64))
    assert found.twist.shape == (1, 6)
    np.testing.assert_allclose(found.twist, taxelsim.vjp(frame, gain * gain * force).twist)
    with pytest.raises(taxelsim.InputError, match=r"cotangent: shape \(3,\) is not allowed: \(1, 6, 14\)"):
        taxelsim.vjp(frame, np.zeros(3))
    with pytest.raises(taxelsim.InputError, match="gain: nan is not allowed"):
        taxelsim.vjp(frame, force, np.nan)
    with pytest.raises(taxelsim.InputError, match=r"gain: shape \(5,\) is not allowed"):
        taxelsim.vjp(frame, force, np.ones(5))
