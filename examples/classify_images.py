"""Makes labelled tactile images of six objects, and trains a linear classifier on them, with NumPy alone.

Each image has a random object, place, yaw, load, gains and noise. The classifier sees the sorted taxels, which do not depend on place and
yaw, and is a least-squares fit. Prints the share of new images that it names right.

python3 examples/classify_images.py [PICTURE] [NUM_IMAGES]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure

NAMES = ["ball", "pin", "stamp", "ring", "knob", "tripod"]
SOLIDS = [taxelsim.Sphere(0.012), taxelsim.Cylinder(0.003, 0.02), taxelsim.Box([0.012, 0.012, 0.02]), taxelsim.Torus(0.009, 0.002)]  # m
MESHES = [taxelsim.SCENES / "objects/knob_5k.obj", taxelsim.SCENES / "objects/touch_three.obj"]
SENSOR = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")


def make_images(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    labels, half_yaws = random.integers(len(NAMES), size=count), random.uniform(0, np.pi, count)
    poses = np.zeros((count, 7))
    poses[:, :2] = random.uniform(-1, 1, (count, 2)) * [0.003, 0.008]
    poses[:, 3], poses[:, 6] = np.cos(half_yaws), np.sin(half_yaws)
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), SENSOR, [*SOLIDS, *MESHES]), count)
    simulator.reset(episodes=np.arange(count) + count * seed, gain_spread=0.05, noise=10)
    simulator.set_objects(labels, poses, anchor="lowest")
    simulator.set_loads(random.uniform(0.5, 2, count))
    simulator.step(0.01)
    return simulator.read().tactile_image.reshape(count, -1).astype(float), labels


def features_of(images: np.ndarray) -> np.ndarray:
    largest = images.max(axis=1, keepdims=True) + 1
    ordered = -np.sort(-images / largest, axis=1)[:, :24]  # the ratio removes most of the load
    return np.hstack((ordered, ordered**2, ordered[:, :-1] * ordered[:, 1:], np.log(largest), np.ones((len(images), 1))))


def main() -> None:
    images, labels = make_images(int(sys.argv[2]) if len(sys.argv) > 2 else 4096, seed=1)
    weights = np.linalg.lstsq(features_of(images), np.eye(len(NAMES))[labels], rcond=None)[0]
    images, labels = make_images(1024, seed=2)
    answers = (features_of(images) @ weights).argmax(1)
    print(f"{np.mean(answers == labels):.1%} of 1024 new images right; chance {1 / len(NAMES):.1%}")
    plt.rcParams["font.size"] = 13
    figure, axes = plt.subplot_mosaic([["all", *row] for row in np.reshape(NAMES, (3, 2))], figsize=(12, 6), layout="constrained")
    axes["all"].imshow(np.histogram2d(labels, answers, bins=np.arange(7) - 0.5)[0], colour_map())
    axes["all"].set(xlabel="answer", ylabel="object", xticks=range(6), yticks=range(6), xticklabels=NAMES, yticklabels=NAMES)
    for index, name in enumerate(NAMES):
        image = draw_taxels(axes[name], SENSOR, images[labels == index][0])
        image.axes.set(title=name, xlabel="", ylabel="", xticks=[], yticks=[])
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "classify_images.png", figure)


if __name__ == "__main__":
    main()
