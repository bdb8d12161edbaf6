"""Tactile forces as a differentiable function of JAX. Import this module only where jax is installed."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import numpy.typing as npt
from jax.experimental import io_callback

from . import _differentiation as differentiation
from ._differentiation import outputs_for
from .simulator import Simulator

__all__ = ["outputs_for", "tactile"]


def tactile(
    simulator: Simulator,
    poses: jax.Array,
    loads: jax.Array | None = None,
    gains: jax.Array | None = None,
    *,
    ids: npt.ArrayLike = 0,
    dt: float = 0.01,
    output: str = "forces",
) -> jax.Array:
    """As taxelsim.torch.tactile(), for jax.grad() and jax.jit(): calls of one simulator run on the host, in the order of the program.

    Raises InputError for a simulator with other outputs; an error of a step is raised by the computation.
    """
    differentiation.check(simulator, output)
    num_instances, sensor = simulator.num_instances, simulator.model.sensor
    result = differentiation.Step(
        *(
            jax.ShapeDtypeStruct((num_instances, *rest), np.float32)
            for rest in (differentiation.image_shape(sensor), (6, sensor.num_taxels), (6,))
        )
    )
    has_loads = loads is not None

    def take_step(poses: Any, loads: Any) -> differentiation.Step:
        pressed = np.asarray(loads) if has_loads else None
        return differentiation.take_step(simulator, ids, dt, output, np.asarray(poses, np.float64), pressed)

    def pull_back(step: Any, poses: Any, cotangent: Any) -> tuple[Any, Any]:
        arrays = differentiation.Step(*map(np.asarray, step))
        gradients = differentiation.pull_back(arrays, np.asarray(poses, np.float64), has_loads, np.asarray(cotangent))
        return tuple(gradient.astype(np.float32) for gradient in gradients)  # type: ignore[return-value]

    def forward(poses: Any, loads: Any) -> tuple[Any, Any]:
        step = io_callback(take_step, result, poses, loads, ordered=True)
        return step.values, (step, poses, loads)

    def backward(residuals: Any, cotangent: Any) -> Any:
        step, poses, loads = residuals
        shapes = (jax.ShapeDtypeStruct((num_instances, 7), np.float32), jax.ShapeDtypeStruct((num_instances,), np.float32))
        by_pose, by_load = jax.pure_callback(pull_back, shapes, step, poses, cotangent)
        return by_pose.astype(poses.dtype), by_load.astype(loads.dtype)

    function = jax.custom_vjp(lambda poses, loads: forward(poses, loads)[0])
    function.defvjp(forward, backward)
    forces: jax.Array = function(poses, loads if loads is not None else np.zeros(num_instances, np.float32))
    return forces if gains is None else forces * gains
