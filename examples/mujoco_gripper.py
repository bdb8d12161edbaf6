"""Holds a weight in MuJoCo with a gripper that has tactile skins on both jaws, and finds the grip force at which it slips.

Eleven grippers press a box of 100 g with 0.5 to 1.5 N. The skins have friction 0.6 and carry the box by shear alone, up to twice the
friction coefficient times the grip force. Prints which grip forces hold the box; the least is 0.82 N in theory.

python3 examples/mujoco_gripper.py [PICTURE]    needs MuJoCo: pip install 'taxelsim[mujoco]'
"""

import sys

import matplotlib.pyplot as plt
import mujoco
import numpy as np
from mujoco.batch import Batch

import taxelsim
import taxelsim.mujoco
from taxelsim.pictures import colour_map, save_figure

# z of the sites points out of the skins, along y of the world; x is up. Motors press the jaws together.
MODEL = """<mujoco>
  <option timestep="0.001" integrator="implicitfast"/><worldbody>
    <body name="left" pos="0 -.01 0"><joint name="left" type="slide" axis="0 1 0" damping="9"/><site name="left" xyaxes="0 0 1 1 0 0"/>
      <geom type="box" size="0.02 0.002 0.01" pos="0 -0.003 0" mass="0.1" contype="0" conaffinity="0"/></body>
    <body name="right" pos="0 .01 0"><joint name="right" type="slide" axis="0 -1 0" damping="9"/><site name="right" xyaxes="0 0 1 -1 0 0"/>
      <geom type="box" size="0.02 0.002 0.01" pos="0 0.003 0" mass="0.1" contype="0" conaffinity="0"/></body>
    <body name="box"><freejoint/><geom name="box" type="box" size="0.015 0.01 0.015" mass="0.1" contype="0" conaffinity="0"/></body>
  </worldbody>
  <actuator><motor joint="left"/><motor joint="right"/></actuator></mujoco>"""


def main() -> None:
    grips = np.linspace(0.5, 1.5, 11)  # N
    model = mujoco.MjModel.from_xml_string(MODEL)
    batch = Batch(model, len(grips))
    batch.ctrl[:] = grips[:, None]
    pad = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    pad = pad.replace(skin=pad.skin.replace(friction=taxelsim.Friction(tangential_stiffness=1e8, friction_coefficient=0.6)))
    tactile = taxelsim.mujoco.couple(model, {"left": pad, "right": pad}, ["box"], num_instances=len(grips))
    heights, shears = [], []
    for _ in range(30):
        frames = tactile.step(batch, nstep=10)
        heights.append(1e3 * batch.qpos[:, 4])  # mm
        shears.append(sum(frame.ground_truth.contact_wrench[:, 0] for frame in frames.values()))
    held = grips[heights[-1] > -1].min()  # N
    print(f"held from a grip force of {held:.1f} N on; shear on the skins {-shears[-1][-1]:.3f} N, weight {0.1 * 9.81:.3f} N")

    colours = plt.cycler(color=colour_map()(np.linspace(0, 0.9, len(grips))))
    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3, "axes.prop_cycle": colours})
    figure, axes = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    axes[0].plot(np.arange(10, 301, 10), heights, label=[f"{grip:.1f} N" for grip in grips])
    axes[1].plot(np.arange(10, 301, 10), -np.array(shears))
    axes[0].set(xlabel="time (ms)", ylabel="height of the box (mm)", ylim=(-25, 1))
    axes[1].set(xlabel="time (ms)", ylabel="shear on both skins (N)")
    axes[0].legend(title="grip force", fontsize=11, ncols=2, loc="center right")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "mujoco_gripper.png", figure)


if __name__ == "__main__":
    main()
