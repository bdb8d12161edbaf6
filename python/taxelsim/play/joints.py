"""Sliders of joints in the side panel."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import viser

from .._core import Robot

_NUM_STEPS = 500  # per slider


def add_joint_sliders(gui: viser.GuiApi, robot: Robot, positions: Sequence[float], use: Callable[[tuple[float, ...]], None]) -> None:
    """A slider for each joint, degrees or mm, from limit to limit; half a turn or 1 m to each side without limits.

    positions: (num_joints), rad or m, at the start. use: gets all positions, within the limits, when a browser has moved a slider.
    """
    newest = list(positions)

    def add(index: int, name: str, is_revolute: bool, lower: float, upper: float) -> None:
        free, unit, factor = (math.pi, "deg", 180 / math.pi) if is_revolute else (1.0, "mm", 1e3)
        low, high = (limit if math.isfinite(limit) else side * free for limit, side in ((lower, -1), (upper, 1)))
        start = min(max(newest[index], low), high)
        slider = gui.add_slider(
            f"{name}, {unit}", factor * low, factor * high, max(factor * (high - low) / _NUM_STEPS, 1e-6), factor * start
        )

        def update(_: object) -> None:
            if math.isfinite(slider.value):
                newest[index] = min(max(slider.value / factor, low), high)
                use(tuple(newest))

        slider.on_update(update)

    with gui.add_folder("joints"):
        for index, (name, is_revolute, lower, upper, _) in enumerate(robot.joints):
            add(index, name, is_revolute, lower, upper)
