"""Compares a skin that is an elastic layer with one of independent springs (Winkler), made of the same rubber.

A stamp presses with 4 N on both. Springs carry the same pressure under the whole stamp. A layer is pushed down around the stamp as well,
and its pressure rises to the rim, as contact mechanics predicts. Prints the pressure at the rim relative to that in the middle.

python3 examples/elastic_layer.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure

DIAMETER, LOAD = 0.0086, 4.0  # m, N
PITCH, COUNT = 0.001, 15  # m, taxels per side: a fine array shows the pressure


def main() -> None:
    rubber = taxelsim.KnownModulus(taxelsim.shore_a_modulus(20), match_pin_diameter=DIAMETER)
    skins = taxelsim.skins_of(taxelsim.skin_stiffness(taxelsim.SkinData(thickness=0.01, poisson_ratio=0.4, stiffness=rubber)))
    laws = {"springs": taxelsim.Winkler, "elastic layer": taxelsim.ElasticLayer}
    device = taxelsim.Device.open()
    grid = taxelsim.GridPatch(name="pad", num_rows=COUNT, num_cols=COUNT, pitch=PITCH)
    images = {}
    for name, law in laws.items():
        skin = next(skin for skin in skins if isinstance(skin.law, law))
        sensor = taxelsim.Sensor(name=name, patches=[grid], samples_per_taxel=2, skin=skin, depth_sampling="area")
        simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=DIAMETER / 2, length=0.01)]))
        depth = taxelsim.pin_depth(skin, DIAMETER, LOAD)  # m, which theory predicts
        simulator.set_objects(0, [[0, 0, -depth, 1, 0, 0, 0]], anchor="lowest")
        for _ in range(5):  # frames of the solver of the layer
            simulator.step(0.01)
            truth = simulator.read().ground_truth
        images[name] = 1e-3 * truth.tactile_normal_force[0] / PITCH**2  # kPa
        line = images[name][COUNT // 2]
        rim = line.max() / line[COUNT // 2]
        print(f"{name}: {truth.total_force[0]:.2f} N; pressure at the rim {rim:.2f} times that in the middle")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([[*laws, "line"]], figsize=(12, 4.5), layout="constrained", width_ratios=[1, 1, 1.3])
    positions = (np.arange(COUNT) - (COUNT - 1) / 2) * 1e3 * PITCH  # mm
    for (name, image), colour in zip(images.items(), (colour_map()(0.75), colour_map()(0.3)), strict=True):
        drawn = draw_taxels(axes[name], sensor, image, range=max(image.max() for image in images.values()))
        axes[name].set_title(name)
        axes["line"].plot(positions, image[COUNT // 2], color=colour, drawstyle="steps-mid", label=name)
    figure.colorbar(drawn, ax=[axes[name] for name in laws], label="pressure (kPa)", location="bottom", shrink=0.6)
    axes["line"].set(xlabel="y (mm)", ylabel="pressure (kPa)", title="through the middle")
    axes["line"].legend(loc="lower center", fontsize=12)
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "elastic_layer.png", figure)


if __name__ == "__main__":
    main()
