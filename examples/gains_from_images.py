"""Finds the gains of all taxels, and where a ball pressed, from tactile images alone: gradient steps with Simulator.vjp().

python3 examples/gains_from_images.py
"""

import numpy as np

import taxelsim

NUM_PRESSES = 192
NUM_STEPS = 600
RADIUS = 0.01  # m, of the ball
UNITS = np.array([1e-3, 1e-3, 1e-4])  # m: steps along x, y and depth


class Adam:
    """Steps of D. P. Kingma and J. Ba, "Adam: a method for stochastic optimization", ICLR 2015."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.mean, self.square, self.count = np.zeros(shape), np.zeros(shape), 0

    def step(self, gradient: np.ndarray, rate: float) -> np.ndarray:
        """What to add to the parameters."""
        self.count += 1
        self.mean += 0.1 * (gradient - self.mean)
        self.square += 0.01 * (gradient**2 - self.square)
        return -rate * (self.mean / (1 - 0.9**self.count)) / (np.sqrt(self.square / (1 - 0.99**self.count)) + 1e-12)


def main() -> None:
    """Presses with unknown gains at unknown places, and finds both."""
    random = np.random.default_rng(5)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").replace(depth_sampling=taxelsim.DepthSampling.AREA)
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(radius=RADIUS)])
    simulator = taxelsim.Simulator(model, NUM_PRESSES, outputs=taxelsim.OutputOptions(vjp=True))

    def forces(places: np.ndarray) -> np.ndarray:
        poses = np.zeros((NUM_PRESSES, 7))
        poses[:, :2], poses[:, 2], poses[:, 3] = places[:, :2], RADIUS - places[:, 2], 1
        simulator.reset()  # each press is a first step, without memory of the one before
        simulator.set_objects(0, poses)
        simulator.step(0.01)
        return simulator.read().ground_truth.tactile_normal_force.astype(float)

    half = 0.5 * np.array([6, 14]) * 0.0034  # m, of the array
    truth = np.column_stack((random.uniform(-half, half, (NUM_PRESSES, 2)), random.uniform(0.0004, 0.0009, NUM_PRESSES)))
    true_gain = np.exp(0.15 * random.normal(size=(6, 14)))
    true_gain /= true_gain.mean()  # a factor on all gains cannot be told from deeper presses
    images = true_gain * forces(truth)

    places, gain = truth + random.uniform(-1, 1, truth.shape) * UNITS, np.ones((6, 14))
    before = places.copy()
    for_places, for_gain = Adam(places.shape), Adam(gain.shape)
    for n in range(NUM_STEPS):
        rate = 0.1 * (1 - n / NUM_STEPS)
        residual = gain * forces(places) - images  # of the loss sum(residual^2) / 2
        gradient = simulator.vjp(residual, gain)
        # The ball moves against the sensor, and its depth against z.
        places += UNITS * for_places.step(gradient.twist[:, :3] * [-1, -1, 1] * UNITS, rate)
        gain += for_gain.step(gradient.gain.sum(0), rate)
        gain /= gain.mean()
    print(f"gains: {100 * np.abs(1 / true_gain - 1).mean():.1f} % off at first, {100 * np.abs(gain / true_gain - 1).mean():.2f} % now")
    first, last = (1e6 * np.median(np.hypot(*(found - truth)[:, :2].T)) for found in (before, places))
    print(f"places: {first:.0f} um off at first, {last:.1f} um now")


if __name__ == "__main__":
    main()
