"""Reads the angle of a pen that lies on the skin from one tactile image, at any angle.

A pen presses with 1 N at 200 random places and angles. The major axis of the forces, from their second moments, is the feature `edge_angle`
that every frame has; the window and the grid of the taxels bound its accuracy. Prints the median and the largest error.

python3 examples/edge_angle.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure

PEN = taxelsim.Capsule(radius=0.004, length=0.012)  # m


def main() -> None:
    random = np.random.default_rng(3)
    angles = np.linspace(-np.pi / 2, np.pi / 2, 200)  # rad, from x of the sensor frame S
    places = random.uniform(-0.0017, 0.0017, (len(angles), 2))  # m: within a taxel
    poses = np.zeros((len(angles), 7))
    poses[:, :2] = places
    half = angles / 2
    poses[:, 3:] = np.sqrt(0.5) * np.column_stack(
        (np.cos(half), -np.sin(half), np.cos(half), np.sin(half))
    )  # z of the pen lies along the angle

    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), sensor, [PEN]), len(angles))
    simulator.reset(noise=10)  # counts, standard deviation
    simulator.set_objects(0, poses, anchor="lowest")
    simulator.set_loads(1.0)  # N
    simulator.step(0.01)
    frame = simulator.read()
    error = np.degrees((frame.edge_angle - angles + np.pi / 2) % np.pi - np.pi / 2)
    print(f"error of the edge angle: median {np.median(np.abs(error)):.2f} degrees, largest {np.abs(error).max():.2f} degrees")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([[0, 1, 2], ["curve"] * 3], figsize=(12, 6), layout="constrained", height_ratios=[1, 1.6])
    for panel, index in enumerate((60, 110, 160)):
        draw_taxels(axes[panel], sensor, frame.tactile_image[index])
        x, y = 1e3 * frame.center_of_pressure[index, :2]
        along = 9 * np.array([-1, 1])  # mm
        axes[panel].plot(y + along * np.sin(frame.edge_angle[index]), x + along * np.cos(frame.edge_angle[index]), color="tab:red")
        axes[panel].set_title(f"{np.degrees(angles[index]):.0f}° pressed, {np.degrees(frame.edge_angle[index]):.0f}° read")
    axes["curve"].plot(np.degrees(angles), error, ".", color=colour_map()(0.4), markersize=9)
    axes["curve"].set(xlabel="angle of the pen (degrees)", ylabel="error (degrees)", xticks=range(-90, 91, 30))
    axes["curve"].axhline(0, color="0.6", linewidth=1)
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "edge_angle.png", figure)


if __name__ == "__main__":
    main()
