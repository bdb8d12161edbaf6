"""A batch of MuJoCo simulations with a tactile pad: bars turn over the pad, and the edge angle is read from the images.

pip install 'taxelsim[mujoco]'; python3 examples/mujoco_batch.py
"""

import mujoco
import numpy as np
from mujoco.batch import Batch

import taxelsim
import taxelsim.mujoco

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
  <actuator>
    <position joint="slide" kp="200" dampratio="1"/><position joint="hinge" kp="0.1" dampratio="1"/>
  </actuator>
</mujoco>"""


def main() -> None:
    num_simulations = 64
    model = mujoco.MjModel.from_xml_string(MODEL)
    batch = Batch(model, num_simulations)
    tactile = taxelsim.mujoco.attach(
        model, {"pad": taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"}, ["rod"], num_instances=num_simulations
    )
    angles = np.linspace(-1.0, 1.0, num_simulations)  # rad, goals of the hinges
    batch.ctrl[:] = np.column_stack((np.full(num_simulations, -0.0016), angles))  # m, rad
    for _ in range(30):
        batch.step(nstep=10)
        frame = tactile.observe(batch, dt=10 * model.opt.timestep)["pad"]

    found = np.pi / 2 + batch.qpos[:, 1]  # the rod is along y of the bar
    error = (frame.edge_angle - found + np.pi / 2) % np.pi - np.pi / 2
    print(f"image of the first simulation, counts:\n{frame.tactile_image[0]}")
    print(f"mean force {frame.total_force.mean():.2f} N; median error of the edge angle {np.rad2deg(np.median(np.abs(error))):.2f} degrees")


if __name__ == "__main__":
    main()
