"""Puts a tactile pad into a batch of MuJoCo simulations: bars turn over the pad, and the edge angle is read from the images.

MuJoCo moves the bodies, and the pad sees where they touch it. Prints the mean force and the median error of the angle over 64 simulations.

python3 examples/mujoco_batch.py [PICTURE]    needs MuJoCo: pip install 'taxelsim[mujoco]'
"""

import sys

import matplotlib.pyplot as plt
import mujoco
import numpy as np
from mujoco.batch import Batch

import taxelsim
import taxelsim.mujoco
from taxelsim.pictures import colour_map, draw_taxels, save_figure

# A bar hangs over the pad on a vertical slide and a hinge, which motors with position control drive.
MODEL = """<mujoco>
  <option timestep="0.002" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <site name="pad"/>
    <body name="bar" pos="0 0 0.007">
      <joint name="slide" type="slide" axis="0 0 1"/><joint name="hinge" type="hinge" axis="0 0 1"/>
      <geom name="rod" type="capsule" size="0.006 0.03" euler="90 0 0" mass="0.1"/>
    </body>
  </worldbody>
  <actuator><position joint="slide" kp="200" dampratio="1"/><position joint="hinge" kp="0.1" dampratio="1"/></actuator>
</mujoco>"""


def main() -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    angles = np.linspace(-1.0, 1.0, 64)  # rad, goals of the hinges
    batch = Batch(model, len(angles))
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    tactile = taxelsim.mujoco.attach(model, {"pad": sensor}, ["rod"], num_instances=len(angles))
    batch.ctrl[:] = np.column_stack((np.full(len(angles), -0.0016), angles))  # m, rad
    for _ in range(30):
        batch.step(nstep=10)
        frame = tactile.observe(batch, dt=10 * model.opt.timestep)["pad"]
    true = np.pi / 2 + batch.qpos[:, 1]  # the rod is along y of the bar
    error = np.degrees((frame.edge_angle - true + np.pi / 2) % np.pi - np.pi / 2)
    print(f"mean force {frame.total_force.mean():.2f} N; median error of the edge angle {np.median(np.abs(error)):.2f} degrees")

    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplot_mosaic([[0, 21, 42, 63], ["error"] * 4], figsize=(12, 5.5), layout="constrained", height_ratios=[1, 1.6])
    for index in (0, 21, 42, 63):
        draw_taxels(axes[index], sensor, frame.tactile_image[index], range=frame.tactile_image.max())
        axes[index].set(title=f"hinge at {np.degrees(batch.qpos[index, 1]):.0f}°", ylabel="x (mm)" if index == 0 else "")
    axes["error"].plot(np.degrees(batch.qpos[:, 1]), error, "o", color=colour_map()(0.4))
    axes["error"].set(xlabel="angle of the hinge (degrees)", ylabel="error (degrees)")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "mujoco_batch.png", figure)


if __name__ == "__main__":
    main()
