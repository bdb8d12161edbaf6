"""Poses of sensors and geoms of a batch, from the present state of each simulation."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._arrays import product, rotation_matrices
from ..errors import InputError
from .batch import STATE, Batch
from .mounts import Mount

Array = NDArray[np.float64]

# Model fields that may differ between the simulations of a Batch.
POSE_FIELDS = [f"{kind}_{field}" for field in ("pos", "quat") for kind in ("body", "geom", "site")]
POSE_FIELDS += ["jnt_pos", "jnt_axis", "qpos0"]
DERIVED_FIELDS = ["body_sameframe", "geom_sameframe", "site_sameframe"]  # of poses and masses
MASS_FIELDS = ["body_ipos", "body_iquat", "body_mass", "body_inertia", "body_subtreemass", "dof_armature", "dof_damping", "dof_M0"]
# Fields that may not: the tree and the shapes.
STRUCTURE_FIELDS = ["body_parentid", "body_jntadr", "jnt_type", "geom_bodyid", "site_bodyid"]
STRUCTURE_FIELDS += ["geom_type", "geom_size", "geom_dataid", "mesh_vertadr", "mesh_vert", "mesh_face"]


class Kinematics:
    """Poses at the present state, whatever stage the caller's simulations have computed.

    A Batch of its own without collisions, constraints and sensors takes their state: their derived fields stay as they are.
    """

    def __init__(self, model: Any, num_instances: int, *, with_masses: bool) -> None:
        """with_masses: whether the simulations must have the masses of the model."""
        self.model = model
        self._fields = [*STRUCTURE_FIELDS, *POSE_FIELDS, *(MASS_FIELDS if with_masses else ())]
        self._equal_models = {model._address: model}
        bare = copy.copy(model)
        off = mujoco.mjtDisableBit
        bare.opt.disableflags |= int(off.mjDSBL_CONTACT | off.mjDSBL_CONSTRAINT | off.mjDSBL_SENSOR)
        bare.opt.enableflags = 0
        self.num_instances = num_instances
        self.batch = Batch(bare, num_instances)
        self.site_positions: Array = self.batch.bind("site_xpos")
        self.site_rotations: Array = self.batch.bind("site_xmat")
        self.site_quaternions: Array = self.batch.bind("site_xquat")
        self.geom_positions: Array = self.batch.bind("geom_xpos")
        self.geom_rotations: Array = self.batch.bind("geom_xmat")
        self.geom_quaternions: Array = self.batch.bind("geom_xquat")
        if with_masses:
            self._inertia: Array = self.batch.bind("M")  # the lower triangle, by rows
            self._rows = np.repeat(np.arange(model.nv), model.M_rownnz)

    def update(self, source: Any) -> None:
        """Computes the poses of a Batch, an MjData or a sequence of MjData. Raises InputError if it is of another size or model."""
        if isinstance(source, Batch):
            self._take_batch(source)
        else:
            self._take_data(source if isinstance(source, Sequence) else [source])
        self.batch.forward(stage=mujoco.mjtStage.mjSTAGE_POS.value)

    def _take_batch(self, source: Any) -> None:
        self._check(source.nsim, source.model, "Batch")
        if source.models is not None:
            raise InputError("Batch with set_models(): its shapes may differ from those of the attached model")
        if source.expanded("geom_size") is not None:
            raise InputError("Batch with expanded geom_size: all simulations must have the shapes of the attached model")
        for name in [*POSE_FIELDS, *DERIVED_FIELDS, *MASS_FIELDS]:
            values = source.expanded(name)
            if values is not None:
                self.batch.expand(name)[:] = values
        self.batch.state[:] = source.state

    def _take_data(self, datas: Sequence[Any]) -> None:
        for data in datas:
            if not isinstance(data, mujoco.MjData):
                raise InputError(f"{type(data).__name__} is not allowed: MjData, a sequence of MjData, or mujoco.batch.Batch")
            self._check(len(datas), data.model, "MjData")
        for row, data in zip(self.batch.state, datas, strict=True):
            mujoco.mj_getState(data.model, data, row, STATE)

    def _check(self, count: int, model: Any, kind: str) -> None:
        if count != self.num_instances:
            raise InputError(f"{kind}: {count} simulations found, {self.num_instances} attached")
        sizes = [(name, getattr(model, name), getattr(self.model, name)) for name in ("nq", "nbody", "ngeom", "nsite")]
        for name, found, expected in sizes:
            if found != expected:
                raise InputError(f"{kind} of another model: {name} is {found}, {expected} in the attached model")
        if model._address in self._equal_models:
            return
        for name in self._fields:
            if not np.array_equal(getattr(model, name), getattr(self.model, name)):
                raise InputError(f"{kind} of another model: {name} differs from that of the attached model")
        self._equal_models[model._address] = model

    def frames_of(self, mount: Mount) -> tuple[Array, Array, Array]:
        """Positions (N, 3), rotations (N, 3, 3) and quaternions (N, 4) of the frame of a sensor in the world."""
        if mount.kind == "site":
            site = mount.index
            return self.site_positions[:, site], self.site_rotations[:, site].reshape(-1, 3, 3), self.site_quaternions[:, site]
        rotations = self.geom_rotations[:, mount.index].reshape(-1, 3, 3)
        positions = self.geom_positions[:, mount.index] + rotations @ mount.X.position
        turn = np.array(mount.X.rotation)
        return positions, rotations @ rotation_matrices(turn[np.newaxis])[0], product(self.geom_quaternions[:, mount.index], turn)

    def relative(self, mount: Mount, geoms: Sequence[int], R_GO: Array) -> Array:
        """X_SO (N, G, 7) of geoms in the frame of a sensor. R_GO (G, 4): rotations of the objects in the frames of their geoms."""
        origins, rotations, quaternions = self.frames_of(mount)
        offsets = self.geom_positions[:, geoms] - origins[:, np.newaxis]
        positions = offsets @ rotations  # rows times R_WS: rotated by its transpose
        inverse = quaternions[:, np.newaxis] * (1, -1, -1, -1)
        return np.concatenate((positions, product(inverse, product(self.geom_quaternions[:, geoms], R_GO))), axis=2)

    def mass_matrices(self, dt: float) -> tuple[Array, Array]:
        """M (N, nv, nv), and M + dt D with the damping of the joints, which MuJoCo integrates implicitly."""
        model, columns = self.model, self.model.M_colind
        mass = np.zeros((self.num_instances, model.nv, model.nv))
        mass[:, self._rows, columns] = self._inertia
        mass[:, columns, self._rows] = self._inertia
        damping = self.batch.expanded("dof_damping")
        implicit = mass.copy()
        diagonal = np.arange(model.nv)
        implicit[:, diagonal, diagonal] += dt * (model.dof_damping if damping is None else damping)
        return mass, implicit
