"""Where objects lie and press."""

import numpy as np
import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco

from .tools import write_cube

# == Every shape pushes back wherever areas are sampled ==


def test_a_plane_over_the_default_sensor_presses_where_it_touches_only(device):
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.HalfSpace()]), 2)
    floor_behind = [0, 0, -0.03, 0, 1, 0, 0]
    simulator.set_objects(0, np.array([[0, 0, 0.03, 1, 0, 0, 0], floor_behind]))
    simulator.step(0.001)
    assert simulator.read().ground_truth.total_force.tolist() == [0, 0]
    simulator.set_loads(5)
    simulator.step(0.001)
    truth = simulator.read().ground_truth
    assert truth.load_reached.tolist() == [True, False]
    assert truth.total_force[0] == pytest.approx(5, abs=1e-4)


# == Meshes lie where a new user expects them ==


def test_the_lowest_point_of_a_mesh_is_placed_as_in_scenes(device, sensor, tmp_path):
    corner = taxelsim.load_mesh(write_cube(tmp_path / "cube.obj", 0.01))
    cube = taxelsim.Mesh(corner.vertices + np.array([0.5, 0, 0]), corner.triangles)  # its origin is half a metre away
    low, high = taxelsim.bounds_of(cube.centered())
    assert np.add(low, high) == pytest.approx(np.zeros(3), abs=1e-7)
    assert taxelsim.lowest_point(cube) == pytest.approx([0.505, 0.005, 0])
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [cube, taxelsim.Sphere(0.01)]), 4)
    simulator.set_loads(1)
    poses = np.tile([0, 0, 0, *taxelsim.axis_angle([1, 0, 0], 0.2)], (4, 1))
    reached = {}
    for anchor in ("origin", "lowest", taxelsim.lowest_point(cube, poses[0, 3:])):
        simulator.set_objects([0, 0, 1, 1], poses, anchor=anchor)
        simulator.step(0.01)
        frame = simulator.read().copy()
        reached[str(anchor)] = frame.ground_truth.load_reached.tolist()
        if anchor == "lowest":
            assert frame.center_of_pressure[:, :2] == pytest.approx(np.zeros((4, 2)), abs=2e-3)  # half a taxel
    assert list(reached.values()) == [[False, False, True, True], [True] * 4, [True, True, False, False]]
    with pytest.raises(taxelsim.InputError, match="anchor: 'middle' is not allowed: 'origin', 'lowest' or a point"):
        simulator.set_objects(0, poses, anchor="middle")


def test_loads_out_of_reach_are_warned_of_once(device, sensor, caplog):
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Sphere(0.01)]), 3)
    simulator.set_objects(0, [[0, 0, 0.01, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0]])
    simulator.set_loads(1)
    for _ in range(2):
        simulator.step(0.01)
        simulator.read()
    assert [record.getMessage()[:83] for record in caplog.records] == [
        "2 of 3 instances did not reach their load, instance 1 first (frame.ground_truth.loa"
    ]


def test_a_mesh_file_is_scaled_to_a_size(tmp_path):
    file = write_cube(tmp_path / "cube.obj", 700)
    assert taxelsim.bounds_of(taxelsim.load_mesh(file, size=0.03))[1] == pytest.approx([0.03, 0.03, 0.03])
    with pytest.raises(taxelsim.InputError, match="scale and size"):
        taxelsim.load_mesh(file, size=0.03, scale=0.001)
    with pytest.raises(taxelsim.InputError, match=r"size: 0 is not allowed"):
        taxelsim.load_mesh(file, size=0)
