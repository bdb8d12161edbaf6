"""Compares taxelsim.torch and taxelsim.jax with central differences. Only the campaign `learn` installs these libraries."""

import numpy as np
import pytest

import taxelsim
from taxelsim import _differentiation as differentiation
from taxelsim._counts import newtons_of_counts

N = 3
LOADS = np.array([2.0, 3.0, 4.0])
# The capsule is much larger than a taxel, because the Jacobian has the slopes in the middle of the cells.
STEP_LENGTH, STEP_ANGLE = 2e-6, 2e-4  # m, rad
TOLERANCE = 0.05  # of the largest entry: slopes in the middle of cells, and float32 forces over differences of 1e-3 N


@pytest.fixture(scope="module")
def simulator(device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    model = taxelsim.Model(device, sensor, [taxelsim.Capsule(radius=0.03, length=0.02)])
    return taxelsim.Simulator(model, N, outputs=differentiation.outputs_for())


def poses():
    rotation = taxelsim.axis_angle((1, 0.2, 0.1), 1.2)
    rows = np.tile([0.001, -0.002, 0.0, *rotation], (N, 1))
    lowest = taxelsim.lowest_point(taxelsim.Capsule(radius=0.03, length=0.02), rotation)
    height = np.array(taxelsim.Pose(rotation=rotation).transform(lowest))[2]
    rows[:, 2] = -height - 3e-4 - 5e-5 * np.arange(N)
    return rows


def moved(rows, axis, size):
    """Poses after a small twist of the objects along or about an axis of S."""
    result = rows.copy()
    if axis < 3:
        result[:, axis] += size
        return result
    turn = taxelsim.Pose(rotation=taxelsim.axis_angle(np.eye(3)[axis - 3], size))
    for row in result:
        pose = turn * taxelsim.Pose(position=row[:3], rotation=row[3:])
        row[:3], row[3:] = pose.position, pose.rotation
    return result


def forces_at(simulator, rows, loads):
    simulator.set_objects(0, rows)
    simulator.set_loads(loads)
    simulator.step(0.01)
    return np.array(simulator.read().ground_truth.tactile_normal_force, np.float64)


def weights(shape):
    return np.random.default_rng(3).uniform(0.5, 1.5, shape)


@pytest.mark.parametrize("loads", [None, LOADS], ids=["pose", "load"])
def test_gradients_are_central_differences(simulator, loads):
    rows = poses()
    step = differentiation.take_step(simulator, 0, 0.01, "forces", rows, loads)
    cotangent = weights(step.values.shape)
    by_pose, by_load = differentiation.pull_back(step, rows, loads is not None, cotangent)

    def loss(rows, loads=loads):
        return (cotangent * forces_at(simulator, rows, loads)).sum((1, 2))

    expected, found = np.zeros((N, 6)), np.zeros((N, 6))
    for axis in range(6):
        size = STEP_LENGTH if axis < 3 else STEP_ANGLE
        ends = [moved(rows, axis, sign * size) for sign in (-1, 1)]
        expected[:, axis] = (loss(ends[1]) - loss(ends[0])) / 2
        found[:, axis] = (by_pose * (ends[1] - ends[0])).sum(1) / 2  # of a quaternion, too
    largest = np.abs(expected).max(1, keepdims=True)
    assert (largest > 0).all()
    assert (np.abs(found - expected) < TOLERANCE * largest).all(), (found, expected)
    if loads is not None:
        np.testing.assert_array_equal(by_pose[:, 2], 0)
        difference = (loss(rows, loads + 0.01) - loss(rows, loads - 0.01)) / 0.02
        np.testing.assert_allclose(by_load, difference, rtol=TOLERANCE)


def test_torch_and_jax_have_these_gradients(simulator):
    torch, jax = pytest.importorskip("torch"), pytest.importorskip("jax")
    import taxelsim.jax
    import taxelsim.torch

    rows = poses()
    step = differentiation.take_step(simulator, 0, 0.01, "forces", rows, LOADS)
    weight, gain = weights(step.values.shape), 1 + weights(step.values.shape)
    by_pose, by_load = differentiation.pull_back(step, rows, True, weight * gain)
    leaves = [torch.tensor(values, requires_grad=True) for values in (rows, LOADS, gain)]
    forces = taxelsim.torch.tactile(simulator, *leaves)
    np.testing.assert_array_equal(forces.detach().numpy(), (gain * step.values))
    simulator.step(0.01)  # changes no result
    (forces * torch.from_numpy(weight)).sum().backward()
    for leaf, expected in zip(leaves, (by_pose, by_load, weight * step.values), strict=True):
        np.testing.assert_allclose(leaf.grad.numpy(), expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())  # float32
    simulator.read()

    def loss(poses, loads, gains):
        return (taxelsim.jax.tactile(simulator, poses, loads, gains) * weight.astype(np.float32)).sum()

    single = [values.astype(np.float32) for values in (rows, LOADS, gain)]
    gradients = jax.jit(jax.grad(loss, argnums=(0, 1, 2)))(*single)
    for gradient, leaf in zip(gradients, leaves, strict=True):
        expected = leaf.grad.numpy()
        np.testing.assert_allclose(np.asarray(gradient), expected, rtol=2e-3, atol=1e-3 * np.abs(expected).max())


def test_an_image_has_the_gradient_of_the_forces_where_the_curve_rises(simulator):
    rows = poses()
    forces = differentiation.take_step(simulator, 0, 0.01, "forces", rows, None)
    image = differentiation.take_step(simulator, 0, 0.01, "image", rows, None)
    saturation = newtons_of_counts(simulator.model.sensor.readout)[-1]
    is_seen, is_saturated = image.values > 0, image.values == saturation
    assert min(is_seen.sum(), (~is_seen).sum(), is_saturated.sum()) > 0
    seen = (is_seen & ~is_saturated).reshape(N, 1, -1)
    np.testing.assert_array_equal(image.by_twist, np.where(seen, forces.by_twist, 0))


def test_wrong_simulators_are_refused(device, model):
    plain = taxelsim.Simulator(model, 2)
    slots = taxelsim.Simulator(model, 2, num_slots=2, outputs=differentiation.outputs_for())
    for wrong, text in ((plain, "outputs"), (slots, "slots")):
        with pytest.raises(taxelsim.InputError, match=text):
            differentiation.check(wrong, "forces")
    with pytest.raises(taxelsim.InputError, match="output: 'counts' is not allowed"):
        differentiation.check(plain, "counts")
