"""Finds where a stamp presses from one tactile image, by Gauss-Newton steps with the tactile Jacobian.

The Jacobian has the derivatives of all taxel forces by the pose. All guesses are improved at once, one in each instance. Prints how many of
them find the pose, and their error.

python3 examples/pose_from_image.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import draw_taxels, save_figure

N, TRUTH = 128, np.array([0.0012, -0.0031, 0.0004, 0.5])  # guesses; x, y, depth (m) and yaw (rad) of the stamp
SCALE = np.array([1e-3, 1e-3, 1e-4, 0.1])  # of a step, in the same units


def main() -> None:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").replace(depth_sampling="area")
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Box([0.012, 0.007, 0.01])])  # m
    simulator = taxelsim.Simulator(model, N, outputs=taxelsim.OutputOptions(taxel_jacobian=True))

    def press(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y, depth, yaw = places.T
        simulator.reset()  # each press is a first step, without memory of the one before
        simulator.set_objects(0, np.column_stack((x, y, -depth, np.cos(yaw / 2), 0 * x, 0 * x, np.sin(yaw / 2))), anchor="lowest")
        simulator.step(0.01)
        truth = simulator.read().ground_truth
        return truth.tactile_normal_force.reshape(N, -1).astype(float), truth.taxel_jacobian.reshape(N, 6, -1)

    image = press(np.tile(TRUTH, (N, 1)))[0]
    places = [TRUTH + np.random.default_rng(4).uniform(-1, 1, (N, 4)) * [0.003, 0.003, 0.0002, 0.4]]
    for _ in range(30):
        forces, jacobian = press(places[-1])
        # By x, y, depth and yaw of the stamp: its twist at the origin of S is the opposite of the sensor's.
        v_x, v_y, v_z, w_z = (-jacobian[:, k] for k in (0, 1, 2, 5))
        x, y = places[-1].T[:2, :, None]
        matrix = np.stack((v_x, v_y, -v_z, w_z + y * v_x - x * v_y), axis=1) * SCALE[:, None]
        normal = matrix @ matrix.transpose(0, 2, 1)
        normal += 1e-3 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(4)  # damping
        step = np.linalg.solve(normal, matrix @ (image - forces)[:, :, None])[:, :, 0]
        places.append(np.clip(places[-1] + np.clip(step, -0.5, 0.5) * SCALE, [-1, -1, 1e-5, -9], [1, 1, 0.0015, 9]))
    error = np.abs(places[-1] - TRUTH)
    print(f"found from {(error.max(axis=1) < 1e-4).sum()} of {N} guesses; median error {1e6 * np.median(error[:, :2]):.3f} um")

    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(figsize=(12, 5.6), layout="constrained")
    figure.colorbar(draw_taxels(axes, sensor, image[0]), label="force (N)")
    ways = 1e3 * np.array(places)  # mm
    axes.plot(ways[:, :, 1], ways[:, :, 0], "o-", color="white", linewidth=0.7, markersize=4, markevery=[0])
    axes.plot(1e3 * TRUTH[1], 1e3 * TRUTH[0], "+", color="tab:red", markersize=24, markeredgewidth=3)
    axes.set(title="tactile image, 128 guesses, and their ways to the pose", xlim=(-16, 10), ylim=(8, -6))
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "pose_from_image.png", figure)


if __name__ == "__main__":
    main()
