"""Presses a mesh made of NumPy arrays on a sensor, with loads from 0 to 5 N, and prints a tactile image.

python3 examples/press_mesh.py
"""

import numpy as np

import taxelsim


def pyramid(half_width: float, height: float) -> taxelsim.Mesh:
    """A blunt pyramid whose tip points down, -z, at the skin. Lengths in m; the tip is the origin."""
    corners = half_width * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    vertices = np.vstack(([0, 0, 0], np.column_stack((corners, np.full(4, height)))))
    triangles = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [1, 2, 3], [1, 3, 4]]
    return taxelsim.Mesh(vertices, triangles)


def main() -> None:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [pyramid(half_width=0.012, height=0.003)])

    num_instances = 64
    simulator = taxelsim.Simulator(model, num_instances)
    poses = np.tile([0, 0, 0, 1, 0, 0, 0], (num_instances, 1))  # x y z, then quaternion w x y z, of the mesh in the sensor frame
    loads = np.linspace(0, 5, num_instances)  # N; the simulator finds the depth at which the skin carries them
    simulator.set_objects(0, poses)
    simulator.set_loads(loads)
    simulator.step(0.01)
    frame = simulator.read()

    print(f"image under {loads[-1]:.1f} N, counts:\n{frame.tactile_image[-1]}")
    print(f"measured force: {frame.total_force[-1]:.3f} N; sum of the true forces: {frame.ground_truth.total_force[-1]:.3f} N")
    assert np.allclose(frame.ground_truth.total_force, loads, rtol=1e-4, atol=1e-4)


if __name__ == "__main__":
    main()
