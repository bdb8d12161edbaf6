"""Finds the gains of all taxels, and where a ball pressed, from tactile images alone: gradient steps with Simulator.vjp().

The simulator pulls the gradient of the image error back to the poses of 192 presses and to the gains of 84 taxels, on the device. Prints
how far gains and places are off at first and at the end.

python3 examples/gains_from_images.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import draw_taxels, save_figure

N, STEPS, UNITS = 192, 600, np.array([1e-3, 1e-3, 1e-4])  # presses; gradient steps; m, of steps in x, y and depth


def main() -> None:
    random = np.random.default_rng(5)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").replace(depth_sampling="area")
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(radius=0.01)])
    simulator = taxelsim.Simulator(model, N, outputs=taxelsim.OutputOptions(vjp=True))

    def forces(places: np.ndarray) -> np.ndarray:
        simulator.reset()  # each press is a first step, without memory of the one before
        simulator.set_objects(0, np.column_stack((places * [1, 1, -1], np.tile([1, 0, 0, 0], (N, 1)))), anchor="lowest")
        simulator.step(0.01)
        return simulator.read().ground_truth.tactile_normal_force.astype(float)

    truth = np.column_stack((random.uniform([-0.0102, -0.0238], [0.0102, 0.0238], (N, 2)), random.uniform(0.0004, 0.0009, N)))
    true_gain = np.exp(0.15 * random.normal(size=(6, 14)))
    true_gain /= true_gain.mean()  # a factor on all gains looks like deeper presses
    images = true_gain * forces(truth)
    places, gain = truth + random.uniform(-1, 1, truth.shape) * UNITS, np.ones((6, 14))
    mean, square, errors = 0.0, 0.0, []
    for n in range(STEPS):
        errors.append((100 * np.abs(gain / true_gain - 1).mean(), 1e6 * np.median(np.hypot(*(places - truth)[:, :2].T))))
        gradient = simulator.vjp(gain * forces(places) - images, gain)  # of the loss: half the sum of squares of the first argument
        # The ball moves against the sensor. A step of Kingma and Ba, "Adam: a method for stochastic optimization", ICLR 2015.
        slope = np.append(gradient.twist[:, :3] * [-1, -1, 1] * UNITS, gradient.gain.sum(0))
        mean, square = mean + 0.1 * (slope - mean), square + 0.01 * (slope**2 - square)
        step = -0.1 * (1 - n / STEPS) * mean / (1 - 0.9 ** (n + 1)) / (np.sqrt(square / (1 - 0.99 ** (n + 1))) + 1e-12)
        places += UNITS * step[:-84].reshape(N, 3)
        gain += step[-84:].reshape(6, 14)
        gain /= gain.mean()
    print("gains off by {:.1f} %, places by {:.0f} um at first; gains by {:.2f} %, places by {:.1f} um now".format(*errors[0], *errors[-1]))
    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([["true gains", "gains found"], ["error"] * 2], figsize=(12, 6.5), layout="constrained")
    for name, values in (("true gains", true_gain), ("gains found", gain)):
        figure.colorbar(draw_taxels(axes[name], sensor, values, range=1.5), ax=axes[name], label=name)
    axes["error"].semilogy(errors, label=["gains (%)", "places (µm)"])
    axes["error"].set(xlabel="gradient step", ylabel="error")
    axes["error"].legend()
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "gains_from_images.png", figure)


if __name__ == "__main__":
    main()
