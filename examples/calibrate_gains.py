"""Calibrates an array with uneven gains, noise and dead taxels by pressing it flat with known forces.

Taxels of a real array differ. A flat plate presses all of them with the same known force, so that a straight line through the counts of
each taxel gives its gain; a taxel without slope is dead. Prints the spread of the gains, the error of the fit, and the dead taxels.

python3 examples/calibrate_gains.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import draw_taxels, save_figure


def main() -> None:
    random = np.random.default_rng(7)
    nominal = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    true_gain = np.exp(0.25 * random.normal(size=nominal.num_taxels))
    true_gain[random.choice(nominal.num_taxels, 3, replace=False)] = 0  # dead
    sensor = nominal.replace(readout=nominal.readout.replace(taxel_gain=true_gain.tolist(), noise=10))  # counts
    objects = [taxelsim.HalfSpace(), taxelsim.Torus(major_radius=0.006, minor_radius=0.003)]  # plate; ring, m
    loads = np.append(np.linspace(5, 60, 40), 4)  # N: presses of the plate, then one of the ring
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), sensor, objects), len(loads))
    simulator.set_objects(np.append(np.zeros(40, int), 1), np.tile([0, 0, 0, 1, 0, 0, 0], (len(loads), 1)), anchor="lowest")
    simulator.set_loads(loads)
    simulator.step(0.01)
    counts = simulator.read().tactile_image.reshape(len(loads), -1)

    force = loads[:40] / sensor.num_taxels  # N, on each taxel
    slope = np.polyfit(force, counts[:40], 1)[0]  # counts/N, of each taxel
    dead = slope < 0.1 * np.median(slope)
    gain = np.where(dead, 1, slope / nominal.readout.curve[0])
    error = np.abs(gain / np.where(dead, 1, true_gain) - 1)[~dead]
    spread = true_gain[~dead].std()
    hits, wrong = (dead & (true_gain == 0)).sum(), (dead & (true_gain > 0)).sum()
    print(f"gains differ by {spread:.1%} and are found within {error.max():.2%}; dead taxels: {hits} of 3 found, {wrong} wrong")

    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(2, 2, figsize=(12, 6.5), layout="constrained")
    corrected = np.where(dead, 0, counts[-1] / gain)
    panels = [
        (true_gain, 2, "true gains"),
        (np.where(dead, 0, gain), 2, "gains from 40 flat presses"),
        (counts[-1], counts[-1].max(), "a ring, raw counts"),
        (corrected, counts[-1].max(), "the same, calibrated"),
    ]
    for panel, (values, limit, title) in zip(axes.flat, panels, strict=True):
        figure.colorbar(draw_taxels(panel, sensor, values, range=limit), ax=panel)
        panel.set_title(title)
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "calibrate_gains.png", figure)


if __name__ == "__main__":
    main()
