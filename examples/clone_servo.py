"""Behaviour cloning: generates demonstrations of a servo, fits a ridge regression to them, and evaluates both. Needs h5py.

python3 examples/clone_servo.py [NUM_DEMONSTRATIONS] [NUM_EPISODES]
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import taxelsim
from taxelsim.policies import FEATURES, Policy

SCENE = taxelsim.SCENES / "benchmark/edge_align.yaml"
SERVO = 0  # index of the controller that is cloned: `principal_axis`
RIDGE = 1e-3
LIMITS = np.repeat([0.02, 1.0], 3)  # m/s and rad/s, those of the servo: a policy's actions are in these units


def read_demonstrations(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Features (frames, 13) in the order of an observation, and twists (frames, 6), of the servo's episodes."""
    names = [f"data/{name}" for name, _, _ in FEATURES]
    frames = taxelsim.Dataset(folder).frames(slice(None), [*names, "data/action", "meta/controller"])
    chosen = frames["meta/controller"] == SERVO
    columns = [frames[name].reshape(len(chosen), -1) for name in names]
    return np.hstack(columns)[chosen], frames["data/action"][chosen]


def inputs_of(features: np.ndarray) -> np.ndarray:
    """Inputs (frames, 22) of the regression: the angle as a direction of a line, and products with it."""
    force, center, confidence, area = features[:, 0], features[:, 2:4] / 0.01, features[:, 11], features[:, 12] / 1e-4
    angle = 2 * features[:, 10]
    line = np.column_stack((np.cos(angle), np.sin(angle))) * confidence[:, None]
    first = np.column_stack((force, center, line, confidence, area))
    products = np.column_stack(
        [line[:, i] * other for i in range(2) for other in (*center.T, *line.T, confidence, force, force * confidence)]
    )
    return np.column_stack((first, products, np.ones(len(features))))


def main() -> None:
    num_demonstrations = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    num_episodes = int(sys.argv[2]) if len(sys.argv) > 2 else 400
    with tempfile.TemporaryDirectory() as folder:
        taxelsim.generate(taxelsim.load_scene(SCENE, num_episodes=num_demonstrations), folder)
        features, twists = read_demonstrations(Path(folder))
    inputs = inputs_of(features)
    weights = np.linalg.solve(inputs.T @ inputs + RIDGE * len(inputs) * np.eye(inputs.shape[1]), inputs.T @ (twists / LIMITS))
    print(f"{len(inputs)} frames; largest weight {np.abs(weights).max():.2g}")

    def clone(observation: np.ndarray) -> np.ndarray:
        # Not `inputs @ weights`: in a matrix product, the last bits of a row may depend on the number of rows.
        return (inputs_of(observation.astype(float))[:, :, None] * weights).sum(1)

    scene = taxelsim.load_scene(SCENE, num_episodes=num_episodes, seed=99)
    policy = Policy(clone, name="clone", observations="features", linear_scale=LIMITS[0], angular_scale=LIMITS[-1])
    for evaluation in taxelsim.evaluate(scene, [scene.controllers[SERVO]], policy=policy):
        print(f"{evaluation.controller:8s} success in {evaluation.verdicts['success'].mean():6.1%} of {num_episodes} episodes")


if __name__ == "__main__":
    main()
