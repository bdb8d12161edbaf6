"""Rolls a curved fingertip over a table and reads the tilt of the table from the tactile image.

The sensor is a spherical cap with 65 taxels on its surface. Where the table touches, the skin's normal is the table's, so that the centre
of pressure gives the tilt in all directions. Prints the median error of the tilt.

python3 examples/curved_fingertip.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, save_figure

RADIUS, DEPTH = 0.008, 0.0006  # m: of the fingertip, whose apex is the origin of S, and of the table in its skin


def main() -> None:
    tilts = np.radians(np.linspace(-50, 50, 101))  # about x of S
    # A half space has its surface at its origin, and its inside along its z.
    poses = np.zeros((len(tilts), 7))
    poses[:, 1] = -(RADIUS - DEPTH) * np.sin(tilts)
    poses[:, 2] = (RADIUS - DEPTH) * np.cos(tilts) - RADIUS
    poses[:, 3], poses[:, 4] = np.cos(tilts / 2), np.sin(tilts / 2)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/fingertip_sphere.yaml")
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.HalfSpace()]), len(tilts))
    simulator.set_objects(0, poses)
    simulator.step(0.01)
    frame = simulator.read()
    center = frame.center_of_pressure
    found = np.degrees(np.arctan2(-center[:, 1], center[:, 2] + RADIUS))
    error = np.abs(found - np.degrees(tilts))
    print(f"error of the tilt: median {np.median(error):.2f} degrees, largest {error.max():.2f} degrees")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([[0, 1, 2], ["curve"] * 3], figsize=(12, 7.5), layout="constrained", height_ratios=[1.2, 1])
    x, y, _ = 1e3 * sensor.taxel_positions.T
    for panel, index in enumerate((15, 50, 85)):
        axes[panel].scatter(y, x, c=frame.tactile_image[index], cmap=colour_map(), s=330, vmin=0, vmax=frame.tactile_image.max())
        axes[panel].plot(*(1e3 * center[index, 1::-1]), "+", color="tab:red", markersize=22)
        axes[panel].set(
            title=f"table at {np.degrees(tilts[index]):.0f}°", xlabel="y (mm)", xlim=(-9.5, 9.5), ylim=(9.5, -9.5), aspect="equal"
        )
    axes[0].set_ylabel("x (mm)")
    axes["curve"].plot(np.degrees(tilts), np.degrees(tilts), color="0.7", label="true")
    axes["curve"].plot(np.degrees(tilts), found, ".", color=colour_map()(0.4), markersize=9, label="from the centre of pressure")
    axes["curve"].set(xlabel="tilt of the table (degrees)", ylabel="tilt read (degrees)")
    axes["curve"].legend()
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "curved_fingertip.png", figure)


if __name__ == "__main__":
    main()
