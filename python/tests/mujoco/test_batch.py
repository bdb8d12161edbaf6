"""Poses of several simulations under MuJoCo 3 and 4, and what needs MuJoCo 4."""

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco
from taxelsim._arrays import rotation_matrices
from taxelsim.envs.dynamics import make_vec
from taxelsim.mujoco import batch as batches

from .models import BALL, WTS, mujoco_4, scene

ROUNDING = 1e-14  # of rotation matrices from quaternions: some 20 operations in double precision


@pytest.mark.parametrize("kind", [batches.DataBatch, pytest.param(batches.Batch, marks=mujoco_4)])
def test_poses_are_those_of_mj_forward(kind: type) -> None:
    """Turned geoms and sites, a mesh, whose frame MuJoCo turns into that of its inertia, and a mocap body."""
    tip = '<geom name="tip" type="mesh" mesh="tip" pos=".1 0 0" euler="3 50 7"/>'
    mocap = '<body name="hand" mocap="true"><geom name="finger" size=".01" pos="0 .02 0" euler="0 0 30"/></body>'
    model = scene(BALL + tip, world=mocap)
    datas = [mujoco.MjData(model) for _ in range(3)]
    batch = kind(model, len(datas))
    bound = {f"{name}_{field}": batch.bind(f"{name}_{field}") for name in ("site", "geom") for field in ("xpos", "xmat", "xquat")}
    rng = np.random.default_rng(3)
    for row, data in zip(batch.state, datas, strict=True):
        data.qpos[:] = rng.normal(size=model.nq)
        data.mocap_pos[:], data.mocap_quat[:] = rng.normal(size=3), rng.normal(size=4)
        mujoco.mj_getState(model, data, row, batches.STATE)
        mujoco.mj_forward(model, data)
    batch.forward(stage=mujoco.mjtStage.mjSTAGE_POS.value)
    for name in ("site", "geom"):
        for field in ("xpos", "xmat"):
            np.testing.assert_array_equal(bound[f"{name}_{field}"], [getattr(data, f"{name}_{field}") for data in datas])
        turned = rotation_matrices(bound[f"{name}_xquat"].reshape(-1, 4)).reshape(len(datas), -1, 9)
        np.testing.assert_allclose(turned, bound[f"{name}_xmat"], atol=ROUNDING)


def test_what_steps_batches_asks_for_mujoco_4(device: taxelsim.Device, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batches, "Batch", batches.DataBatch)
    found = rf"needs MuJoCo 4, {mujoco.__version__} found: pip install 'mujoco>=4,<5'$"
    with pytest.raises(ImportError, match=rf"^taxelsim.mujoco.couple\(\) {found}"):
        taxelsim.mujoco.couple(scene(), {"palm": WTS}, ["ball"], device=device)
    with pytest.raises(ImportError, match=f"^the task Push {found}"):
        make_vec("Push")
