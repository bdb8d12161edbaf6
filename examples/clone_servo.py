"""Clones a servo: generates its demonstrations, fits a ridge regression to them, and evaluates both in new episodes.

The servo aligns the sensor with an edge. The clone sees the features of the tactile image, and products with the direction of the edge.
Prints the success rate of clone and servo.

python3 examples/clone_servo.py [PICTURE] [NUM_DEMONSTRATIONS] [NUM_EPISODES]    needs h5py: pip install 'taxelsim[dataset]'
"""

import sys
import tempfile

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, save_figure
from taxelsim.policies import FEATURES, Policy

SCENE, SERVO = taxelsim.SCENES / "benchmark/edge_align.yaml", 0  # index of the controller that is cloned: `principal_axis`
LIMITS = np.repeat([0.02, 1.0], 3)  # m/s and rad/s, those of the servo: a policy's actions are in these units


def inputs_of(features: np.ndarray) -> np.ndarray:
    """Inputs (frames, 22) of the regression, from features (frames, 13): the angle as a direction of a line, and products with it."""
    force, center, confidence, area = features[:, 0], features[:, 2:4] / 0.01, features[:, 11], features[:, 12] / 1e-4
    line = np.column_stack((np.cos(2 * features[:, 10]), np.sin(2 * features[:, 10]))) * confidence[:, None]
    others = (*center.T, *line.T, confidence, force, force * confidence)
    products = [line[:, i] * other for i in range(2) for other in others]
    return np.column_stack((force, center, line, confidence, area, *products, np.ones(len(features))))


def main() -> None:
    picture, num_demonstrations, num_episodes = (*sys.argv[1:], *("clone_servo.png", "2000", "400")[len(sys.argv) - 1 :])
    names = [f"data/{name}" for name, _, _ in FEATURES]
    with tempfile.TemporaryDirectory() as folder:
        taxelsim.generate(taxelsim.load_scene(SCENE, num_episodes=int(num_demonstrations)), folder)
        frames = taxelsim.Dataset(folder).frames(slice(None), [*names, "data/action", "meta/controller"])
    chosen = frames["meta/controller"] == SERVO
    inputs = inputs_of(np.hstack([frames[name].reshape(len(chosen), -1) for name in names])[chosen])
    twists = frames["data/action"][chosen] / LIMITS
    weights = np.linalg.solve(inputs.T @ inputs + 1e-3 * len(inputs) * np.eye(inputs.shape[1]), inputs.T @ twists)
    scene = taxelsim.load_scene(SCENE, num_episodes=int(num_episodes), seed=99)
    settings = {"observations": "features", "linear_scale": LIMITS[0], "angular_scale": LIMITS[-1]}
    # Not `inputs @ weights`: in a matrix product, the last bits of a row may depend on the number of rows.
    policy = Policy(lambda seen: (inputs_of(seen.astype(float))[:, :, None] * weights).sum(1), name="clone", **settings)
    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    for evaluation in taxelsim.evaluate(scene, [scene.controllers[SERVO]], policy=policy):
        success = evaluation.verdicts["success"].mean()
        print(f"{evaluation.controller:8s} success in {success:6.1%} of {num_episodes} episodes")
        axes[1].bar(evaluation.controller, 100 * success, color=colour_map()(0.45))
    axes[0].plot(twists[:4000, 5], (inputs[:4000] @ weights)[:, 5], ".", color=colour_map()(0.3), markersize=3)
    axes[0].set(xlabel="rotation of the servo (rad/s)", ylabel="rotation of the clone (rad/s)")
    axes[1].set(ylabel="success (%)", ylim=(0, 100))
    save_figure(picture, figure)


if __name__ == "__main__":
    main()
