"""Feeds contact points of your own physics engine to a tactile array, and reads where a ball rolls.

Any engine that reports contact points with forces will do; here they come from a file, one row for each point and step. `contact_points()`
turns points in the world into inputs of a batch, in which every step is an instance. Prints the error of the centre of pressure and of the
force.

python3 examples/contact_points.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure


def main() -> None:
    file = taxelsim.SCENES / "contact_points/rolling_and_sliding.csv"
    rows = np.genfromtxt(file, delimiter=",", names=True, skip_header=1)
    rows = rows[rows["episode"] == 0]  # a ball rolls over the skin
    steps = rows["step"].astype(int)
    positions = np.column_stack([rows[name] for name in ("x_m", "y_m", "z_m")])
    forces = np.column_stack([rows[name] for name in ("fx_N", "fy_N", "fz_N")])  # on the sensor
    num_steps = steps.max() + 1
    X_WS = np.tile([0, 0, 0.5, 1, 0, 0, 0], (num_steps, 1))  # the skin is 0.5 m over the origin of the world

    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    model = taxelsim.Model(taxelsim.Device.open(), sensor)
    simulator = taxelsim.Simulator(model, num_steps, max_contacts=4, contact_band=1e-3)  # m, above the skin
    simulator.set_contacts(*taxelsim.contact_points(steps, positions, forces, X_WS))
    simulator.step(0.01)
    frame = simulator.read()
    center = 1e3 * frame.center_of_pressure[:, 1]  # mm, along y
    true = 1e3 * np.bincount(steps, positions[:, 1]) / np.bincount(steps)
    error = np.median(np.abs(center - true))
    off = np.abs(frame.ground_truth.total_force - np.bincount(steps, -forces[:, 2])).max()
    print(f"median error of the centre of pressure {error:.2f} mm, half a taxel is 1.70 mm; largest error of the force {off:.4f} N")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    shown = (5, 25, 45)
    figure, axes = plt.subplot_mosaic([[*shown], ["track"] * 3], figsize=(12, 6), layout="constrained", height_ratios=[1, 1.6])
    for index in shown:
        draw_taxels(axes[index], sensor, frame.tactile_image[index], range=frame.tactile_image.max())
        axes[index].plot(true[index], 1e3 * positions[steps == index, 0].mean(), "+", color="tab:red", markersize=16)
        axes[index].set(title=f"step {index}", ylabel="x (mm)" if index == 5 else "")
    axes["track"].plot(true, color="0.7", label="contact point of the engine")
    axes["track"].plot(center, ".", color=colour_map()(0.4), markersize=10, label="centre of pressure")
    axes["track"].set(xlabel="step", ylabel="y (mm)")
    axes["track"].legend()
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "contact_points.png", figure)


if __name__ == "__main__":
    main()
