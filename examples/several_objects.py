"""Presses three objects on one array at once, and finds each of them as a region of the tactile image.

A ball, a block and a ring lie in three slots of every instance, at random places. Regions of connected taxels separate them, each with its
own centre of pressure, force and edge angle. Prints how many contacts are found, and how far they are from the objects.

python3 examples/several_objects.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import draw_taxels, save_figure

OBJECTS = [taxelsim.Sphere(0.005), taxelsim.Box([0.006, 0.006, 0.006]), taxelsim.Torus(major_radius=0.003, minor_radius=0.001)]  # m
NUM_INSTANCES = 100


def main() -> None:
    random = np.random.default_rng(2)
    places = random.uniform(-0.0035, 0.0035, (NUM_INSTANCES, 3, 2)) * [1, 0.2]  # m: of the slots, about the middles of thirds of the array
    places[:, :, 1] += [-0.017, 0, 0.017]
    poses = np.zeros((NUM_INSTANCES, 3, 7))
    poses[:, :, :2], poses[:, :, 3] = places, 1
    poses[:, :, 2] = [-0.0006, -0.0002, -0.0004]  # m: depth of the lowest points
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    outputs = taxelsim.OutputOptions(contact_features=True)
    model = taxelsim.Model(taxelsim.Device.open(), sensor, OBJECTS)
    simulator = taxelsim.Simulator(model, NUM_INSTANCES, num_slots=3, max_regions=3, outputs=outputs)
    simulator.set_objects(np.tile([0, 1, 2], (NUM_INSTANCES, 1)), poses, anchor="lowest")
    simulator.step(0.01)
    frame = simulator.read()
    regions = frame.contact.center_of_pressure[:, -3:, :2]  # (N, 3, 2): the rows before are the sensor and its patch
    separate = frame.contact.num_regions == 3
    errors = np.linalg.norm(places[:, :, None] - regions[:, None], axis=-1).min(axis=2)[separate]  # m
    print(
        f"three regions in {separate.mean():.0%} of {NUM_INSTANCES} images; median distance to the objects {1e3 * np.median(errors):.2f} mm"
    )

    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(2, 2, figsize=(12, 6.5), layout="constrained")
    for panel, index in zip(axes.flat, np.flatnonzero(separate), strict=False):
        image = draw_taxels(panel, sensor, frame.tactile_image[index], range=frame.tactile_image[separate].max())
        panel.plot(*(1e3 * places[index, :, ::-1].T), "o", color="white", markersize=16, fillstyle="none", label="object")
        panel.plot(*(1e3 * regions[index, :, ::-1].T), "+", color="tab:red", markersize=16, markeredgewidth=3, label="region")
        panel.set(xlim=(-23.8, 23.8), ylim=(10.2, -10.2))
    axes[0, 0].legend(loc="lower left", fontsize=12)
    figure.colorbar(image, ax=axes, label="counts")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "several_objects.png", figure)


if __name__ == "__main__":
    main()
