"""Makes labelled tactile images of six objects, and trains a linear classifier on them, with NumPy alone.

python3 examples/classify_images.py [NUM_IMAGES]
"""

import sys

import numpy as np

import taxelsim

OBJECTS = {
    "ball": taxelsim.Sphere(radius=0.012),
    "pin": taxelsim.Cylinder(radius=0.003, length=0.02),
    "stamp": taxelsim.Box(size=[0.012, 0.012, 0.02]),
    "ring": taxelsim.Torus(major_radius=0.009, minor_radius=0.002),
    "knob": taxelsim.load_mesh(taxelsim.SCENES / "objects/knob_5k.obj"),
    "tripod": taxelsim.load_mesh(taxelsim.SCENES / "objects/touch_three.obj"),
}


def make_images(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Images (count, taxels), counts, and labels (count): random objects, places, yaws and loads of 0.5 to 2 N."""
    random = np.random.default_rng(seed)
    labels = random.integers(len(OBJECTS), size=count)
    yaws = random.uniform(0, 2 * np.pi, count)
    poses = np.zeros((count, 7))
    poses[:, 0] = random.uniform(-0.003, 0.003, count)
    poses[:, 1] = random.uniform(-0.008, 0.008, count)
    poses[:, 3], poses[:, 6] = np.cos(yaws / 2), np.sin(yaws / 2)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    model = taxelsim.Model(taxelsim.Device.open(), sensor, list(OBJECTS.values()))
    simulator = taxelsim.Simulator(model, count)
    simulator.reset(episodes=np.arange(count) + count * seed, gain_spread=0.05, noise=10)
    simulator.set_objects(labels, poses)
    simulator.set_loads(random.uniform(0.5, 2, count))
    simulator.step(0.01)
    return simulator.read().tactile_image.reshape(count, -1).astype(float), labels


def features_of(images: np.ndarray) -> np.ndarray:
    """Sorted taxels: they do not depend on place and yaw. Relative to the largest, which removes most of the load."""
    ordered = -np.sort(-images, axis=1)[:, :24]
    largest = ordered[:, :1] + 1
    return np.hstack((ordered / largest, np.log(largest), np.ones((len(images), 1))))


def train(features: np.ndarray, labels: np.ndarray, iterations: int = 400) -> np.ndarray:
    """Weights (features, classes) of a softmax regression, by gradient descent with momentum."""
    targets = np.eye(len(OBJECTS))[labels]
    weights = np.zeros((features.shape[1], len(OBJECTS)))
    velocity = np.zeros_like(weights)
    for _ in range(iterations):
        scores = features @ weights
        likelihood = np.exp(scores - scores.max(1, keepdims=True))
        likelihood /= likelihood.sum(1, keepdims=True)
        velocity = 0.9 * velocity - 0.5 * features.T @ (likelihood - targets) / len(labels)
        weights += velocity
    return weights


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 4096
    images, labels = make_images(count, seed=1)
    features = features_of(images)
    mean, spread = features[:, :-1].mean(0), features[:, :-1].std(0) + 1e-6

    def scaled(rows: np.ndarray) -> np.ndarray:
        return np.hstack(((rows[:, :-1] - mean) / spread, rows[:, -1:]))

    weights = train(scaled(features), labels)
    images, labels = make_images(1024, seed=2)
    answers = (scaled(features_of(images)) @ weights).argmax(1)
    for index, name in enumerate(OBJECTS):
        print(f"{name:8s} {np.mean(answers[labels == index] == index):6.1%} right")
    print(f"all      {np.mean(answers == labels):6.1%} right; chance {1 / len(OBJECTS):.1%}")


if __name__ == "__main__":
    main()
