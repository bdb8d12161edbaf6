"""Contact points of an engine in the frames of the sensors."""

import numpy as np
import pytest

import taxelsim

HALF = 0.5**0.5
POSES = np.array([[0, 0, 0, 1, 0, 0, 0], [1, 2, 3, HALF, 0, HALF, 0], [0, 0, 0.1, 0, 1, 0, 0]], float)  # z of S: z, x, -z of W


def test_points_in_the_sensor_frames() -> None:
    points = taxelsim.contact_points([1, 0, 1], [[1, 2.01, 2.98], [0.003, 0, 0], [1, 2, 3]], [[-2, 5, 5], [0, 0, -1], [3, 0, 0]], POSES)
    np.testing.assert_array_equal(points.offsets, [0, 1, 3, 3])
    np.testing.assert_allclose(points.positions, [[0.003, 0, 0], [0.02, 0.01, 0], [0, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(points.normal_forces, [1, 2, 0], atol=1e-12)  # the last one pulls


def test_a_step_of_a_batch(device: taxelsim.Device, sensor: taxelsim.Sensor) -> None:
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor), 3, max_contacts=4)
    exported = np.from_dlpack(np.array([[0, 0, -1.5], [0, 0, 0.5]]))  # as of another library
    simulator.set_contacts(*taxelsim.contact_points([0, 2], [[0, 0, 0], [0.003, 0, 0.1]], exported, POSES))
    simulator.step(0.001)
    truth = simulator.read().ground_truth
    np.testing.assert_allclose(truth.total_force, [1.5, 0, 0.5], rtol=1e-6)  # rounding of float32
    assert truth.center_of_pressure[2, 0] > 0


def test_no_points() -> None:
    points = taxelsim.contact_points(np.empty(0, int), np.empty((0, 3)), np.empty((0, 3)), POSES)
    np.testing.assert_array_equal(points.offsets, [0, 0, 0, 0])
    assert points.positions.shape == (0, 3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"instances": [0, 3]}, "instances: 3 of index 1 is not allowed: 0 to 2"),
        ({"instances": [0.0, 1.0]}, "instances: dtype float64 is not allowed: integers"),
        ({"positions": [[0, 0, 0]]}, "positions: shape .1, 3. is not allowed"),
        ({"forces": [[0, 0, 0], [0, np.nan, 0]]}, "forces: .* is not finite"),
        ({"X_WS": [[0, 0, 0, 2, 0, 0, 0]], "instances": [0, 0]}, "quaternion of length 2 found in instance 0, 1 allowed"),
    ],
)
def test_refused_input(changes: dict[str, object], message: str) -> None:
    arguments = {"instances": [0, 1], "positions": np.zeros((2, 3)), "forces": np.zeros((2, 3)), "X_WS": POSES, **changes}
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.contact_points(**arguments)
