"""Slides a ball over a skin with friction and watches the shear: it sticks, it slips, and it remembers.

A ball under 2 N is pulled to and fro. The skin holds it like a spring until its shear reaches the friction coefficient times the load; the
rim of the contact slips first. Prints the ratio of shear and load while the ball slides, which is the friction coefficient.

python3 examples/slide_and_shear.py [PICTURE]
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure

FRICTION, LOAD, RADIUS = 0.6, 2.0, 0.02  # 1, N, m


def main() -> None:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    friction = taxelsim.Friction(tangential_stiffness=5e7, friction_coefficient=FRICTION)  # N/m^3, 1
    sensor = sensor.replace(skin=sensor.skin.replace(friction=friction))
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(RADIUS)]))
    simulator.set_loads(LOAD)
    time = np.arange(0, 2, 0.01)  # s
    places = np.interp(time, [0, 0.5, 1.5, 2], [0, 0.003, -0.003, 0])  # m, along y: to and fro
    frames = []
    for y in places:
        simulator.set_objects(0, [[0, y, RADIUS - 0.0005, 1, 0, 0, 0]])
        simulator.step(0.01)
        frames.append(simulator.read().copy())
    shear = np.array([frame.ground_truth.tactile_shear_force[0, :, :, 1].sum() for frame in frames])  # N
    print(f"shear while sliding: {np.abs(shear).max() / LOAD:.3f} of the load; friction coefficient {FRICTION}")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([["time", "loop"], ["stick", "slip"]], figsize=(12, 7.5), layout="constrained")
    axes["time"].plot(time, shear, color=colour_map()(0.4))
    axes["time"].set(xlabel="time (s)", ylabel="shear force (N)")
    axes["loop"].plot(1e3 * places, shear, color=colour_map()(0.4))
    axes["loop"].set(xlabel="position of the ball (mm)", title="hysteresis")
    for name in ("time", "loop"):
        axes[name].axhspan(-FRICTION * LOAD, FRICTION * LOAD, color="0.93")
    for name, index in (("stick", 4), ("slip", 40)):
        truth = frames[index].ground_truth
        limit = FRICTION * truth.tactile_normal_force[0]  # N, of each taxel
        share = np.divide(truth.tactile_shear_force[0, :, :, 1], limit, out=np.zeros((6, 14)), where=limit > 0)
        image = draw_taxels(axes[name], sensor, share, range=1)
        axes[name].set_title(f"{'sticks' if name == 'stick' else 'slips'}, {time[index]:.2f} s")
        axes["time"].plot(time[index], shear[index], "o", color="tab:red", markersize=11)
    figure.colorbar(image, ax=[axes["stick"], axes["slip"]], label="shear / friction limit", location="bottom", shrink=0.5)
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "slide_and_shear.png", figure)


if __name__ == "__main__":
    main()
