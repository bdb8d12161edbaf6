"""A tactile pad as scales, two-way with MuJoCo: boxes of 20 g to 1 kg fall on the skin, come to rest on it and are weighed.

pip install 'taxelsim[mujoco]'; python3 examples/mujoco_weigh.py
"""

import mujoco
import numpy as np
from mujoco.batch import Batch

import taxelsim
import taxelsim.mujoco

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
    frame = tactile.step(batch, nstep=300)["skin"]
    weights = -frame.ground_truth.contact_wrench[:, 2] / -model.opt.gravity[2]
    for mass, weight, force in zip(masses, weights, frame.total_force, strict=True):
        print(f"{1e3 * mass:7.1f} g on the skin as {1e3 * weight:7.1f} g; the taxels read {force:6.3f} N")
    print(f"largest error of the weight {100 * np.abs(weights / masses - 1).max():.2f} %")


if __name__ == "__main__":
    main()
