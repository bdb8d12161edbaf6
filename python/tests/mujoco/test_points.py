"""MuJoCo's contacts as contact points."""

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
from taxelsim.mujoco.batch import Batch

from .models import WTS, mujoco_4

GRAVITY = 9.81  # m/s^2
MASSES = (0.05, 0.1, 0.2)  # kg
SOLVED = 1e-3  # relative: forces of the last of 2,000 time steps, in which a body comes to rest

DRIFT = 1e-5  # m: a body at rest on four points creeps by less
YAW = np.deg2rad(40)  # of the pad

# Of the two bodies that touch, the one with the site is the first or the second in the model.
PAD = '<body name="pad" pos=".1 .2 .3" euler="0 0 40"><geom type="box" size=".02 .03 .01" pos="0 0 -.01"/><site name="palm"/></body>'
BOX = '<body name="box" pos=".1 .2 .3101"><freejoint/><geom type="box" size=".003 .004 .01" mass="1"/></body>'


def model_of(*bodies: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(f'<mujoco><option timestep=".001"/><worldbody>{"".join(bodies)}</worldbody></mujoco>')


@mujoco_4
@pytest.mark.parametrize("bodies", [(PAD, BOX), (BOX, PAD)])
def test_weights_at_rest(device: taxelsim.Device, bodies: tuple[str, str]) -> None:
    model = model_of(*bodies)
    batch = Batch(model, len(MASSES))
    batch.expand("body_mass")[:, model.body("box").id] = MASSES
    batch.expand("body_inertia")[:, model.body("box").id] *= np.array(MASSES)[:, np.newaxis]
    batch.set_const()
    batch.step(nstep=2000)
    points = taxelsim.mujoco.points_of(model, batch, "palm")
    simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(WTS)), len(MASSES), max_contacts=8)
    simulator.set_contacts(*points)
    simulator.step(0.001)
    truth = simulator.read().ground_truth
    np.testing.assert_allclose(truth.total_force, np.array(MASSES) * GRAVITY, rtol=SOLVED)
    np.testing.assert_array_equal(truth.off_array_contacts, 0)
    assert (np.diff(points.offsets) == 4).all()  # the corners of the box
    corners = sorted(
        (x * np.cos(YAW) + y * np.sin(YAW), y * np.cos(YAW) - x * np.sin(YAW)) for x in (-0.003, 0.003) for y in (-0.004, 0.004)
    )
    np.testing.assert_allclose(sorted(points.positions[:4, :2].tolist()), corners, atol=DRIFT)


def test_data_and_other_contacts() -> None:
    """Contacts between other bodies do not count. Nothing touches: no points."""
    floor = '<geom type="plane" size="1 1 1" pos="0 0 .2"/><body pos="0 0 .209"><freejoint/><geom size=".01"/></body>'
    model = model_of(floor, PAD)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.ncon == 1
    points = taxelsim.mujoco.points_of(model, [data, data], "palm")
    np.testing.assert_array_equal(points.offsets, [0, 0, 0])


def test_refused_input() -> None:
    model = model_of(PAD, BOX)
    with pytest.raises(taxelsim.InputError, match="site 'hand' is not in the model; it has 'palm'"):
        taxelsim.mujoco.points_of(model, mujoco.MjData(model), "hand")
    with pytest.raises(taxelsim.InputError, match="int is not allowed: MjData"):
        taxelsim.mujoco.points_of(model, 3, "palm")
    with pytest.raises(taxelsim.InputError, match="MjData of another model"):
        taxelsim.mujoco.points_of(model, mujoco.MjData(model_of(PAD, BOX, '<body><geom size="1"/></body>')), "palm")
