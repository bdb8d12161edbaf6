"""Presses a mesh made of NumPy arrays on a tactile array, with loads from 0 to 5 N.

A plate with bumps presses on 64 instances of the sensor at once, each with its own load. The simulator finds the depth at which the skin
carries the load, so the forces of all taxels add up to it. Prints the largest difference of that sum from the load.

python3 examples/press_mesh.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure


def bumps(width: float, height: float, spacing: float) -> taxelsim.Mesh:
    """A square plate with bumps that point down, -z, at the skin. Lengths in m; the lowest points are at z = 0."""
    line = np.linspace(-width / 2, width / 2, 49)
    x, y = (axis.ravel() for axis in np.meshgrid(line, line, indexing="ij"))
    z = height * (1 - np.cos(2 * np.pi * x / spacing) / 2 - np.cos(2 * np.pi * y / spacing) / 2)
    first = (np.arange(48)[:, None] * 49 + np.arange(48)).ravel()  # corner of each cell, which has two triangles
    triangles = np.vstack([np.column_stack((first, first + 50, first + k)) for k in (49, 1)])
    return taxelsim.Mesh(np.column_stack((x, y, z)), triangles)


def main() -> None:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    mesh = bumps(width=0.03, height=0.0015, spacing=0.01)
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [mesh])
    loads = np.linspace(0, 5, 64)  # N
    simulator = taxelsim.Simulator(model, len(loads))
    simulator.set_objects(0, np.tile([0, 0, 0, 1, 0, 0, 0], (len(loads), 1)))  # x y z, then quaternion w x y z, of the mesh in S
    simulator.set_loads(loads)
    simulator.step(0.01)  # s
    frame = simulator.read()
    print(f"sum of the taxel forces: within {np.abs(frame.ground_truth.total_force - loads).max():.5f} N of each load")

    plt.rcParams["font.size"] = 15
    figure = plt.figure(figsize=(12, 6), layout="constrained")
    plate = figure.add_subplot(1, 2, 1, title="height of the mesh over the skin", xlabel="y (mm)", ylabel="x (mm)", aspect="equal")
    x, y, z = 1e3 * mesh.vertices.T
    figure.colorbar(plate.tricontourf(y, x, mesh.triangles, z, 12, cmap=colour_map()), ax=plate, label="mm", location="bottom")
    plate.invert_yaxis()
    for row, index in enumerate((12, 36, 63)):
        axes = figure.add_subplot(3, 2, 2 * row + 2, title=f"load {loads[index]:.1f} N")
        image = draw_taxels(axes, sensor, frame.tactile_image[index], range=frame.tactile_image.max())
        axes.set_xlabel("y (mm)" if row == 2 else "")
        figure.colorbar(image, ax=axes, label="counts")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "press_mesh.png", figure)


if __name__ == "__main__":
    main()
