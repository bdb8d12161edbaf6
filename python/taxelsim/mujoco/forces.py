"""The forces of MuJoCo's contacts on the body of a sensor, by geom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from .._arrays import rotation_matrices
from .batch import STATE, Batch
from .mounts import Mount
from .poses import Array


def forwarded(model: Any, source: Any, count: int | None = None) -> Iterator[tuple[Any, Any]]:
    """Model and MjData of the first `count` simulations of `source`, after mj_forward() at the present state; default: of all.

    Each MjData is valid until the next one. The simulations of `source` are only read.
    """
    if isinstance(source, Batch):
        for i in range(source.nsim)[:count]:
            of_simulation, data = source.get_model(i), source.get_data(i)
            mujoco.mj_forward(of_simulation, data)
            yield of_simulation, data
        return
    scratch, state = mujoco.MjData(model), np.empty(mujoco.mj_stateSize(model, STATE))
    for data in (list(source) if isinstance(source, Sequence) else [source])[:count]:
        mujoco.mj_getState(data.model, data, state, STATE)
        mujoco.mj_setState(data.model, scratch, state, STATE)
        mujoco.mj_forward(data.model, scratch)
        yield data.model, scratch


def normal_forces(model: Any, source: Any, mounts: Mapping[str, Mount], geoms: Sequence[int], count: int | None = None) -> dict[str, Array]:
    """(N, G), N, >= 0: by sensor, the component along -z of S of the normal forces of the contacts of each geom with its body.

    At the present state, computed by mj_forward(), one simulation after the other. count: of the first simulations only.
    """
    rows: dict[str, list[Array]] = {name: [] for name in mounts}
    for of_simulation, data in forwarded(model, source, count):
        pressures = [_pressure(of_simulation, data, k) for k in range(data.ncon)]
        for name, mount in mounts.items():
            rows[name].append(_along_sensor(of_simulation, data, mount, geoms, pressures))
    return {name: np.maximum(np.array(values).reshape(-1, len(geoms)), 0) for name, values in rows.items()}


def _pressure(model: Any, data: Any, contact: int) -> Array:
    """Normal force (3) of a contact on its second geom, in the world."""
    wrench: NDArray[np.float64] = np.empty(6)
    mujoco.mj_contactForce(model, data, contact, wrench)
    normal: Array = wrench[0] * data.contact.frame[contact][:3]
    return normal


def _along_sensor(model: Any, data: Any, mount: Mount, geoms: Sequence[int], pressures: Sequence[Array]) -> Array:
    """(G): sum along -z of the sensor of the forces on its body."""
    matrices = data.site_xmat if mount.kind == "site" else data.geom_xmat
    z = matrices[mount.index].reshape(3, 3) @ rotation_matrices(np.array([mount.X.rotation]))[0][:, 2]
    sums = np.zeros(len(geoms))
    for (first, second), force in zip(data.contact.geom, pressures, strict=True):
        for own, other, sign in ((first, second, -1), (second, first, 1)):
            if own >= 0 and model.geom_bodyid[own] == mount.body and other in geoms:
                sums[list(geoms).index(other)] -= sign * force @ z
    return sums
