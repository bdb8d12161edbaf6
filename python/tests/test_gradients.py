"""Gradients by pose and gains against central differences of the simulated forces."""

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
# Of the sum of the magnitudes of a gradient's terms: some 60 roundings of float32 (a spread of 9 taxels in both, products, and sums of 8
# lanes of 11 taxels). The magnitudes are those after the spread, which averages changes of both signs: before it they are a few times as
# large.
ROUNDING = 4 * 60 * 2.0**-24


class Presser:
    """Presses objects 0 and 1 in turn on the instances of one simulator."""

    def __init__(self, sampling: taxelsim.DepthSampling, device: taxelsim.Device, count: int) -> None:
        sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").replace(depth_sampling=sampling)
        model = taxelsim.Model(device, sensor, [taxelsim.Box(size=[0.009, 0.006, 0.012]), taxelsim.Sphere(radius=0.006)])
        self.simulator = taxelsim.Simulator(model, count, outputs=taxelsim.OutputOptions(taxel_jacobian=True, vjp=True))

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
    found = presser.simulator.vjp(cotangent).twist
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


@pytest.mark.parametrize("gain", [1.0, np.linspace(0.5, 1.5, 84).reshape(6, 14)], ids=["no gains", "gains"])
def test_device_computes_what_the_host_does(device: taxelsim.Device, gain: float | np.ndarray) -> None:
    poses = np.zeros((5, 7))
    poses[:, 0], poses[:, 2], poses[:, 3] = np.linspace(-0.01, 0.01, 5), LIFT - 0.0004, 1
    presser = Presser(taxelsim.DepthSampling.AREA, device, len(poses))
    frame = presser.frame(poses)
    cotangent = np.random.default_rng(1).normal(size=(5, 6, 14))
    found, expected = presser.simulator.vjp(cotangent, gain), taxelsim.vjp(frame, cotangent, gain)
    terms = np.abs(frame.ground_truth.taxel_jacobian * (gain * cotangent)[:, None])
    assert (np.abs(found.twist - expected.twist) <= ROUNDING * terms.sum((2, 3))).all()
    np.testing.assert_allclose(found.gain, expected.gain, rtol=2.0**-22)
    assert found.twist.dtype == found.gain.dtype == np.float32
    assert np.abs(found.twist).max() > 0
    kept = found.twist.copy()
    presser.frame(poses[::-1])
    presser.simulator.vjp(cotangent)
    np.testing.assert_array_equal(found.twist, kept)


def test_device_refuses_in_one_line(device: taxelsim.Device) -> None:
    pose = np.array([[0, 0, LIFT - 0.0004, 1, 0, 0, 0]], dtype=float)
    simulator = Presser(taxelsim.DepthSampling.AREA, device, 1).simulator
    cotangent = np.ones((1, 6, 14))
    with pytest.raises(RuntimeError, match="before the first frame"):
        simulator.vjp(cotangent)
    simulator.set_objects(0, pose)
    simulator.step(0.01)
    with pytest.raises(RuntimeError, match=r"vjp\(\) between step\(\) and read\(\)"):
        simulator.vjp(cotangent)
    simulator.read()
    with pytest.raises(taxelsim.InputError, match=r"cotangent: shape \(3,\) is not allowed: \(N, 6, 14\) = \(1, 6, 14\)"):
        simulator.vjp(np.zeros(3))
    with pytest.raises(taxelsim.InputError, match="cotangent: inf of instance 0 is not finite"):
        simulator.vjp(np.inf * cotangent)
    with pytest.raises(taxelsim.InputError, match="gain: nan of instance 0 is not finite"):
        simulator.vjp(cotangent, np.nan)
    with pytest.raises(taxelsim.InputError, match=r"gain: shape \(5,\) is not allowed: \(1, 6, 14\), or one that broadcasts to it"):
        simulator.vjp(cotangent, np.ones(5))
    with pytest.raises(taxelsim.InputError, match=r"cotangent x gain of instance 0, taxel 0: inf is not allowed"):
        simulator.vjp(1e30 * cotangent, 1e30)
    without = taxelsim.Simulator(simulator.model, 1)
    with pytest.raises(taxelsim.InputError, match=r"needs a simulator with outputs.vjp"):
        without.vjp(cotangent)


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
