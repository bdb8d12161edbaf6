"""Weighs boxes with a tactile pad in MuJoCo: boxes of 20 g to 1 kg fall on the skin and come to rest on it.

The coupling is two-way: the skin pushes the boxes, and MuJoCo has no contact of its own. Prints the largest error of the weight at rest.

python3 examples/mujoco_weigh.py [PICTURE]    needs MuJoCo: pip install 'taxelsim[mujoco]'
"""

import sys

import matplotlib.pyplot as plt
import mujoco
import numpy as np
from mujoco.batch import Batch

import taxelsim
import taxelsim.mujoco
from taxelsim.pictures import colour_map, save_figure

MODEL = """<mujoco>
  <option timestep="0.001"/>
  <worldbody>
    <body name="pad"><site name="skin"/></body>
    <body name="box" pos="0 0 0.0101"><freejoint/><geom name="box" type="box" size="0.009 0.02 0.01" mass="1"/></body>
  </worldbody>
</mujoco>"""


def main() -> None:
    masses = np.geomspace(0.02, 1, 8)  # kg
    model = mujoco.MjModel.from_xml_string(MODEL)
    batch = Batch(model, len(masses))
    body = model.body("box").id
    batch.expand("body_mass")[:, body] = masses
    batch.expand("body_inertia")[:, body] = model.body_inertia[body] * masses[:, np.newaxis]
    batch.set_const()
    pad = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
    tactile = taxelsim.mujoco.couple(model, {"skin": pad}, ["box"], num_instances=len(masses))
    weights = []  # kg, at each time
    for _ in range(60):
        frame = tactile.step(batch, nstep=5)["skin"]
        weights.append(-frame.ground_truth.contact_wrench[:, 2] / -model.opt.gravity[2])
    print(f"largest error of the weight {100 * np.abs(weights[-1] / masses - 1).max():.2f} %")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplots(figsize=(12, 5.5), layout="constrained")
    for index, mass in enumerate(masses):
        axes.semilogy(5 * np.arange(1, 61), 1e3 * np.array(weights)[:, index], color=colour_map()(index / 8))
        axes.text(302, 1e3 * mass, f"{1e3 * mass:.0f} g", va="center")
    axes.set(
        xlabel="time (ms)",
        ylabel="weight on the skin (g)",
        xlim=(0, 325),
        ylim=(10, 3000),
        title="boxes fall on the skin; labels: true mass",
    )
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "mujoco_weigh.png", figure)


if __name__ == "__main__":
    main()
