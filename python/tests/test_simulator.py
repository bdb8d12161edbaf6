"""Simulator: inputs, outputs and refused arguments."""

import re

import numpy as np
import pytest

import taxelsim

from .conftest import N


def stepped(simulator: taxelsim.Simulator, poses: np.ndarray) -> taxelsim.Frame:
    simulator.set_objects(0, poses)
    simulator.step(0.001)
    return simulator.read()


def test_arrays_have_the_batch_first_and_are_read_only(simulator, poses):
    frame = stepped(simulator, poses)
    assert frame.tactile_image.shape == (N, 6, 14)
    assert frame.tactile_image.dtype == np.int32
    assert frame.center_of_pressure.shape == (N, 3)
    assert frame.ground_truth.tactile_shear_force.shape == (N, 6, 14, 2)
    assert frame.ground_truth.contact_wrench.shape == (N, 6)
    assert frame.ground_truth.load_reached.dtype == np.bool_
    with pytest.raises(ValueError, match="read-only"):
        frame.tactile_image[0] = 1
    with pytest.raises(AttributeError, match="read-only"):
        frame.tactile_image = frame.tactile_image


def test_deeper_presses_exert_larger_forces(simulator, poses):
    force = stepped(simulator, poses).ground_truth.total_force
    assert force[0] > 0
    assert (np.diff(force) > 0).all()


def test_all_optional_outputs_have_their_shapes(model, poses):
    outputs = taxelsim.OutputOptions(contact_features=True, clean_contact_features=True, tactile_jacobian=True, clean_tactile_jacobian=True)
    frame = stepped(taxelsim.Simulator(model, N, outputs=outputs, max_regions=2), poses)
    assert frame.contact.total_force.shape == (N, 4)  # sensor, patch, two regions
    assert frame.contact.tilt.shape == (N, 4, 2)
    assert frame.contact.num_regions.tolist() == [1] * N
    assert taxelsim.ContactType(frame.contact.contact_type[0, 0]) == taxelsim.ContactType.EDGE
    assert frame.jacobian.center_of_pressure.shape == (N, 2, 3, 6)
    assert frame.ground_truth.jacobian.contact_wrench.shape == (N, 6, 6)
    assert "contact" in frame.ground_truth
    assert frame.ground_truth.contact.total_force.shape == (N, 4)


def test_outputs_that_were_not_requested_say_how_to_get_them(simulator):
    with pytest.raises(AttributeError, match=re.escape("Simulator(..., outputs=OutputOptions(clean_contact_features=True))")):
        _ = simulator.read().ground_truth.contact
    with pytest.raises(AttributeError, match=r"has no attribute image; it has .*tactile_image"):
        _ = simulator.read().image


def test_matrices_give_the_same_image_as_quaternions(simulator, poses):
    expected = stepped(simulator, poses).copy()
    matrices = np.tile(np.eye(4), (N, 1, 1))
    matrices[:, :3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    matrices[:, :3, 3] = poses[:, :3]
    assert (stepped(simulator, matrices).tactile_image == expected.tactile_image).all()


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 3), (-3, 1, 0.5)])
@pytest.mark.parametrize("angle", [0.1, 1.5, 3.1, -2.0])
def test_every_rotation_matrix_becomes_its_quaternion(axis, angle):
    w, x, y, z = q = np.array(taxelsim.axis_angle(axis, angle))
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    poses = np.empty((1, 7))
    taxelsim._core.poses_from_matrices(matrix[np.newaxis], poses, 1)
    assert abs(abs(q @ poses[0, 3:]) - 1) < 1e-12


def test_slots_hold_several_objects(model, poses):
    simulator = taxelsim.Simulator(model, N, num_slots=2)
    both = np.stack([poses, poses], axis=1)
    both[:, 0, 1] = -0.01
    both[:, 1, 1] = 0.01
    simulator.set_objects([[0, taxelsim.NO_OBJECT]] * N, both)
    simulator.step(0.001)
    one = simulator.read().ground_truth.total_force.copy()
    simulator.set_objects([[0, 0]] * N, both)
    simulator.step(0.001)
    assert (simulator.read().ground_truth.total_force > one).all()


def test_loads_are_carried_and_summed(simulator, poses):
    loads = np.linspace(1, 5, N)
    simulator.set_objects(0, poses)
    simulator.set_loads(loads, where=np.arange(N) != 2)
    simulator.step(0.001)
    truth = simulator.read().ground_truth
    assert truth.load_reached.all()
    driven = np.arange(N) != 2
    assert truth.total_force[driven] == pytest.approx(loads[driven], rel=1e-3)
    assert truth.load_offset[2] == 0
    simulator.set_loads(None)
    simulator.step(0.001)
    assert (simulator.read().ground_truth.load_offset == 0).all()


def test_contact_points_sum_to_their_forces(device, sensor):
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor), 3, max_contacts=4)
    positions = [[0, 0, 0], [0.003, 0, 0], [0, 0.003, 0]]
    simulator.set_contacts(positions, [1.0, 0.5, 0.25], [0, 2, 2, 3])
    simulator.step(0.001)
    assert simulator.read().ground_truth.total_force == pytest.approx([1.5, 0, 0.25], rel=1e-5)


def test_reset_keys_the_noise_by_episode(device, sensor, poses):
    noisy = sensor.replace(readout=sensor.readout.replace(noise=5.0))
    simulator = taxelsim.Simulator(taxelsim.Model(device, noisy, [taxelsim.Cylinder(radius=0.008, length=0.04)]), N, seed=3)
    same = np.tile(poses[-1], (N, 1))

    def image(*arguments) -> np.ndarray:
        simulator.reset(*arguments)
        return stepped(simulator, same).tactile_image.copy()

    first = image(None, np.arange(N) + 10)
    assert (first[0] != first[1]).any()
    assert (image([0, 1], [11, 10])[:2] == first[[1, 0]]).all()
    simulator.reset()
    second = image(np.arange(N) == 4, 12)
    assert (second[4] == first[2]).all()


def test_traffic_counts_the_bytes_of_a_step(model, poses):
    outputs = taxelsim.OutputOptions(tactile_normal_force=False, tactile_shear_force=False, penetration_depth=False)
    simulator = taxelsim.Simulator(model, N, outputs=outputs)
    assert (simulator.traffic.num_submits, simulator.traffic.bytes_to_device, simulator.traffic.bytes_from_device) == (0, 0, 0)
    stepped(simulator, poses)
    assert simulator.traffic.num_submits == 1
    assert simulator.traffic.bytes_to_device == N * (64 + 32) + 192  # poses, keys and clocks; the step
    assert simulator.traffic.bytes_from_device == N * 4 * (6 * 14 + 40) + 112  # images and features; lists


def test_a_step_of_some_instances_leaves_the_others(simulator, poses):
    before = stepped(simulator, poses).tactile_image.copy()
    simulator.reset([1, 4])
    simulator.set_objects(0, poses[::-1])
    simulator.step(0.001, [1, 4])
    image = simulator.read().tactile_image
    others = [0, 2, 3, 5]
    assert (image[others] == before[others]).all()
    assert (image[[1, 4]] == before[[4, 1]]).all()
    with pytest.raises(RuntimeError, match="reset"):
        simulator.step(0.001, np.arange(N) == 2)


@pytest.mark.parametrize(
    ("ids", "change", "message"),
    [
        (0, lambda p: p.T, r"poses: shape \(7, 6\) is not allowed: \(N, 7\) = \(6, 7\) or .*; did you mean array.T\?"),
        (0, lambda p: p[0], r"poses: shape \(7,\) is not allowed: .*; did you mean np.tile\(array, \(num_instances, 1\)\)\?"),
        (0, lambda p: p[:-1], r"poses: shape \(5, 7\) is not allowed: \(N, 7\) = \(6, 7\)"),
        (0, lambda p: p.reshape(-1), r"did you mean array.reshape\(6, 7\)\?"),
        (0, lambda p: p.astype(complex), "poses: dtype complex128 is not allowed: real numbers"),
        (0, lambda p: p.astype(str), "poses: dtype <U.* is not allowed: real numbers"),
        (0, lambda p: [[1, 2], [3]], "poses: rows of different lengths"),
        (np.zeros(N), lambda p: p, r"ids: dtype float64 is not allowed: integers; did you mean array.astype\(int\)\?"),
        (np.zeros(N + 1, int), lambda p: p, r"ids: shape \(7,\) is not allowed"),
        (np.full(N, 2**40), lambda p: p, "ids: 1099511627776 of instance 0 is not allowed"),
        ([0, 0, 7, 0, 0, 0], lambda p: p, "object 7 of instance 2 is not allowed: 0 to 1, or -1"),
        (0, lambda p: p * [1, 1, 1, 2, 2, 2, 2], "rotation of instance 0: a quaternion of length 2.0"),
    ],
)
def test_wrong_objects_are_refused_in_one_line_and_change_nothing(simulator, poses, ids, change, message):
    before = stepped(simulator, poses).tactile_image.copy()
    with pytest.raises(taxelsim.InputError, match=message) as error:
        simulator.set_objects(ids, change(poses))
    assert "\n" not in str(error.value)
    simulator.step(0.001)
    assert (simulator.read().tactile_image == before).all()


def test_not_a_number_names_its_instance(simulator, poses):
    poses[3, 1] = np.nan
    with pytest.raises(taxelsim.InputError, match="poses: nan of instance 3 is not finite") as error:
        simulator.set_objects(0, poses)
    assert error.value.instance == 3
    with pytest.raises(taxelsim.InputError, match="loads: inf of instance 1"):
        simulator.set_loads([1, np.inf, 1, 1, 1, 1])
    with pytest.raises(taxelsim.InputError, match=r"load of instance 5: -1\.0 is not allowed") as error:
        simulator.set_loads([1, 1, 1, 1, 1, -1])
    assert error.value.instance == 5


def test_matrices_that_are_no_rotation_name_their_instance(simulator):
    matrices = np.tile(np.eye(4), (N, 1, 1))
    matrices[4, 0, 0] = -1  # a reflection
    with pytest.raises(taxelsim.InputError, match="poses of instance 4: the matrix is not allowed"):
        simulator.set_objects(0, matrices)


def test_wrong_resets_are_refused(simulator):
    with pytest.raises(taxelsim.InputError, match="instances: 6 is not allowed: 0 to 5"):
        simulator.reset([0, N])
    with pytest.raises(taxelsim.InputError, match=r"episodes: shape \(3,\) is not allowed: \(K,\) = \(2,\)"):
        simulator.reset([0, 1], [1, 2, 3])
    with pytest.raises(taxelsim.InputError, match="episodes: -1 of index 0 is not allowed"):
        simulator.reset([0], [-1])
    with pytest.raises(taxelsim.InputError, match="gain, gain_spread and noise must be finite"):
        simulator.reset(gain=float("nan"))


def test_inputs_between_step_and_read_are_refused(simulator, poses):
    simulator.step(0.001)
    with pytest.raises(RuntimeError, match=re.escape("set_objects() between step() and read(): call read() first")):
        simulator.set_objects(0, poses)
    with pytest.raises(RuntimeError, match="step"):
        simulator.step(0.001)
    simulator.read()
    with pytest.raises(taxelsim.InputError, match="dt"):
        simulator.step(0)


def test_too_large_batches_say_what_fits(model):
    with pytest.raises(taxelsim.InputError, match="num_instances"):
        taxelsim.Simulator(model, 0)
    plan = taxelsim.Simulator.plan(model, taxelsim.SimulatorOptions(num_instances=4096))
    assert plan.bytes_per_instance > 1000
    assert plan.max_instances > 4096
