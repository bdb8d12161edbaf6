"""Pulls a ball over three-axis taxels in all directions and reads the direction from their shear.

Each taxel of this array measures the force along x, y and its normal. The sum of the shear points to where the ball is pulled, once the
gain matrix of the data sheet has removed the cross-talk. Arrows are the shear of the taxels. Prints the error of the direction with both.

python3 examples/three_axis.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, save_figure, tactile_pictures

RADIUS, DEPTH, STEP = 0.012, 0.0015, 0.0002  # m: of the ball, in the skin, and along the skin in a time step


def main() -> None:
    directions = np.linspace(-np.pi, np.pi, 180, endpoint=False)  # rad, from x of S
    along = np.column_stack((np.cos(directions), np.sin(directions)))
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/uskin_like_4x4.yaml")
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(RADIUS)])
    simulator = taxelsim.Simulator(model, len(directions), outputs=taxelsim.OutputOptions(taxel_counts=True))
    poses = np.zeros((len(directions), 7))
    poses[:, 2], poses[:, 3] = RADIUS - DEPTH, 1
    for step in range(10):
        poses[:, :2] = step * STEP * along
        simulator.set_objects(0, poses)
        simulator.step(0.01)
        frame = simulator.read()
    counts = frame.taxel_counts  # (N, 4, 4, 3)
    forces = counts @ np.linalg.inv(sensor.readout.three_axis.gain).T  # N: the inverse of the gain matrix removes the cross-talk
    errors = []
    for values in (counts, forces):
        pull = values[..., :2].sum(axis=(1, 2))
        found = np.arctan2(pull[:, 1], pull[:, 0])
        errors.append(np.degrees((found - directions + np.pi) % (2 * np.pi) - np.pi))
    raw, calibrated = np.median(np.abs(errors), axis=1)
    print(f"median error of the direction: {raw:.2f} degrees from raw counts, {calibrated:.2f} degrees without cross-talk")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    shown = [0, 45, 90, 135]
    pictures = tactile_pictures(sensor, counts[shown])
    figure, axes = plt.subplot_mosaic([shown, ["curve"] * 4], figsize=(12, 6.5), layout="constrained", height_ratios=[1.2, 1])
    for index, picture in zip(shown, pictures, strict=True):
        axes[index].imshow(picture, extent=(-9.4, 9.4, 9.4, -9.4))  # mm
        axes[index].set(title=f"pulled to {np.degrees(directions[index]):.0f}°", xlabel="y (mm)")
    axes[0].set_ylabel("x (mm)")
    axes["curve"].plot(np.degrees(directions), errors[0], color="0.7", label="raw counts")
    axes["curve"].plot(np.degrees(directions), errors[1], color=colour_map()(0.4), label="without cross-talk")
    axes["curve"].legend()
    axes["curve"].axhline(0, color="0.6", linewidth=1)
    axes["curve"].set(xlabel="direction of the pull (degrees)", ylabel="error (degrees)", xticks=range(-180, 181, 60))
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "three_axis.png", figure)


if __name__ == "__main__":
    main()
