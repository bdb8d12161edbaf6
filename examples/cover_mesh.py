"""Covers a mesh with taxels, presses a ball against 64 places of it, and reads each place from the centre of pressure.

The mesh is a scanned figure of a rabbit. Its upper side gets square taxels of 4 mm, evenly spaced. The ball comes along the normal of the
surface, 0.5 mm deep. Prints how many taxels there are, and how far the centres of pressure lie from the touched places: in a hollow
the ball touches twice, and the centre lies between.

python3 examples/cover_mesh.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim import patterns
from taxelsim.pictures import colour_map, save_figure

RADIUS, DEPTH, PITCH = 0.01, 0.0005, 0.004  # m
NUM_PLACES = 64


def main() -> None:
    mesh = taxelsim.load_mesh(taxelsim.SCENES / "objects/bunny.obj", scale=0.01)
    sensor = patterns.cover_shape(mesh, PITCH, direction=(0, 0, 1), half_angle=1.0).sensor
    places, normals = np.asarray(sensor.taxel_positions), np.asarray(sensor.taxel_normals)
    chosen = np.random.default_rng(1).choice(sensor.num_taxels, NUM_PLACES, replace=False)
    poses = np.tile([0.0, 0, 0, 1, 0, 0, 0], (NUM_PLACES, 1))
    poses[:, :3] = places[chosen] + (RADIUS - DEPTH) * normals[chosen]
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(RADIUS)]), NUM_PLACES)
    simulator.set_objects(0, poses)
    simulator.step(0.01)
    frame = simulator.read()
    found = frame.center_of_pressure
    errors = 1e3 * np.linalg.norm(found - places[chosen], axis=1)
    print(f"{sensor.num_taxels} taxels; centre of pressure off by {np.median(errors):.2f} mm in the median, {errors.max():.2f} mm at most")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([[0, 1, 2], ["error"] * 3], figsize=(12, 8), layout="constrained", height_ratios=[2, 1])
    x, y, _ = 1e3 * places.T
    for panel, press in enumerate(np.argsort(errors)[[0, NUM_PLACES // 2, -1]]):
        image = frame.tactile_image[press]
        axes[panel].scatter(x, y, c=image, cmap=colour_map(), s=30, marker="s", vmin=0, vmax=image.max())
        axes[panel].plot(*(1e3 * places[chosen[press], :2]), "o", color="tab:red", markersize=22, fillstyle="none")
        axes[panel].plot(*(1e3 * found[press, :2]), "+", color="tab:red", markersize=22)
        axes[panel].set(title=f"off by {errors[press]:.1f} mm", xlabel="x (mm)", aspect="equal")
    axes[0].set_ylabel("y (mm)")
    axes["error"].hist(errors, np.arange(0, errors.max() + 0.5, 0.25), color=colour_map()(0.4))
    axes["error"].set(xlabel="distance of the centre of pressure (plus) from the touched place (circle), mm", ylabel="places")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "cover_mesh.png", figure)


if __name__ == "__main__":
    main()
