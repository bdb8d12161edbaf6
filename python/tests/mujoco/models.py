"""MuJoCo models of the tests."""

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
from taxelsim.mujoco.batch import Batch, DataBatch

WTS = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
mujoco_4 = pytest.mark.skipif(Batch is DataBatch, reason="MuJoCo 3 has no Batch, and its contacts of cylinders creep")
TETRAHEDRON = "0 0 0  .02 0 .01  0 .02 .01  -.02 -.02 .01"  # a tip that points down
BALL = '<geom name="ball" size=".01"/>'


def scene(body: str = BALL, pad: str = "", world: str = "", timestep: float = 0.001) -> mujoco.MjModel:
    """A pad with site `palm`, tilted and away from the origin, and a free body `object`. Names of all geoms: see the parts."""
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
  <option timestep="{timestep}"/>
  <asset><mesh name="tip" vertex="{TETRAHEDRON}"/></asset>
  <worldbody>{world}
    <body name="pad" pos=".1 .2 .3" euler="20 -30 40">
      <freejoint/><site name="palm" pos=".01 0 .02" euler="5 10 15"/>
      <geom name="base" type="box" size=".01 .02 .01" contype="0" conaffinity="0"/>{pad}
    </body>
    <body name="object"><freejoint/>{body}</body>
  </worldbody>
</mujoco>""")


def place(model: mujoco.MjModel, data: mujoco.MjData, X_SO: tuple[float, ...]) -> None:
    """Moves the free body `object` to a pose (x, y, z, qw, qx, qy, qz) in the site."""
    mujoco.mj_kinematics(model, data)
    rotation = data.site("palm").xmat.reshape(3, 3)
    site, quaternion = np.empty(4), np.empty(4)
    mujoco.mju_mat2Quat(site, data.site("palm").xmat)
    mujoco.mju_mulQuat(quaternion, site, np.array(X_SO[3:]) / np.linalg.norm(X_SO[3:]))
    data.joint(int(model.body("object").jntadr[0])).qpos[:] = [*(data.site("palm").xpos + rotation @ X_SO[:3]), *quaternion]


def direct(device: taxelsim.Device, shape: taxelsim.mujoco.geoms.Shape, *poses: tuple[float, ...]) -> taxelsim.Frame:
    """The frame of a Simulator without MuJoCo, with an instance per pose."""
    simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(WTS), [shape]), len(poses))
    simulator.set_objects(0, [[*pose[:3], *(np.array(pose[3:]) / np.linalg.norm(pose[3:]))] for pose in poses])
    simulator.step(0.001)
    return simulator.read().copy()
