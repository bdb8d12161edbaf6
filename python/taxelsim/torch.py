"""Tactile forces as a differentiable function of PyTorch. Import this module only where torch is installed."""

from __future__ import annotations

from typing import Any

import numpy.typing as npt
import torch

from . import _differentiation as differentiation
from ._arrays import to_numpy
from ._differentiation import outputs_for
from .simulator import Simulator

__all__ = ["outputs_for", "tactile"]


class _Tactile(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(ctx: Any, simulator: Simulator, ids: npt.ArrayLike, dt: float, output: str, poses: torch.Tensor, loads: Any) -> Any:
        pose_array = to_numpy("poses", poses).astype("float64")
        step = differentiation.take_step(simulator, ids, dt, output, pose_array, None if loads is None else to_numpy("loads", loads))
        ctx.step, ctx.poses, ctx.dtypes = step, pose_array, (poses.dtype, None if loads is None else loads.dtype)
        return torch.from_numpy(step.values)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        of_poses, of_loads = ctx.dtypes
        by_pose, by_load = differentiation.pull_back(ctx.step, ctx.poses, of_loads is not None, to_numpy("gradient", gradients[0]))
        return (None,) * 4 + (torch.from_numpy(by_pose).to(of_poses), None if of_loads is None else torch.from_numpy(by_load).to(of_loads))


def tactile(
    simulator: Simulator,
    poses: torch.Tensor,
    loads: torch.Tensor | None = None,
    gains: torch.Tensor | None = None,
    *,
    ids: npt.ArrayLike = 0,
    dt: float = 0.01,
    output: str = "forces",
) -> torch.Tensor:
    """Normal forces of the taxels (N, num_rows, num_cols), float32, N; (N, num_taxels) for sensors of several patches. Steps and waits.

    simulator: with outputs=outputs_for(), one object in each instance.
    poses: (N, 7), position (m) and quaternion of the object in S, as in Simulator.set_objects(), floats on the CPU.
    loads: (N), N; None: driven by pose. With loads, poses along z have no effect and a gradient of 0.
    gains: of each taxel, broadcast to the forces, which they multiply.
    ids: (N) objects, or one for all.
    dt: s, of the step.
    output: "forces", true ones; or "image", the tactile image in newtons by the nominal curve, whose derivative is that of the force above
        the trigger and below saturation, and 0 elsewhere.

    Differentiable by poses, loads and gains, once. The derivatives are those of frame.ground_truth.taxel_jacobian: friction and
    relaxation count as in the last step; see taxelsim.vjp(). A gradient by a quaternion is orthogonal to it: normalise after an update.
    Later steps do not change a result. Raises what Simulator.set_objects(), set_loads() and step() raise, and InputError for a simulator
    with other outputs.
    """
    differentiation.check(simulator, output)
    forces: torch.Tensor = _Tactile.apply(simulator, ids, dt, output, poses, loads)
    return forces if gains is None else forces * gains
