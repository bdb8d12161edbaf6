"""Newton models of the tests. Needs newton; the campaign `newton` installs it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import taxelsim

newton = pytest.importorskip("newton")
wp = pytest.importorskip("warp")

N = 5
WTS = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
BALL, RADIUS = "ball", 0.01
# Position and quaternion (x, y, z, w) of the site on the body of the pad.
SITE = (0.01, -0.02, 0.03, *(np.array([0.1, -0.2, 0.3, 0.9]) / np.sqrt(0.95)))

Add = Callable[[Any, int], int]
"""A function that adds a shape to a body of a builder."""


def transform(pose: Any) -> Any:
    """A Warp transform of position and quaternion (x, y, z, w)."""
    return wp.transform(wp.vec3(*map(float, pose[:3])), wp.quat(*map(float, pose[3:])))


def add_ball(builder: Any, body: int) -> int:
    return builder.add_shape_sphere(body, radius=RADIUS, label=BALL)


def world(*shapes: Add) -> Any:
    """A builder of a body `pad` with the site `palm`, and a free body `object` with shapes."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    pad = builder.add_body(label="pad", mass=1.0, inertia=wp.mat33(np.eye(3)))
    builder.add_site(pad, xform=transform(SITE), label="palm")
    body = builder.add_body(label="object", mass=1.0, inertia=wp.mat33(np.eye(3)))
    for add in shapes or (add_ball,):
        add(builder, body)
    return builder


def worlds(builder: Any, count: int = N) -> Any:
    """The model of `count` copies of a world."""
    model = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    model.replicate(builder, count)
    return model.finalize(device="cpu")


def direct(device: taxelsim.Device, shape: Any, poses: Any, dt: float = 0.01) -> taxelsim.Frame:
    """The frame of a Simulator without Newton, at poses (N, 7)."""
    simulator = taxelsim.Simulator(taxelsim.Model(device, taxelsim.load_sensor(WTS), [shape]), len(poses))
    simulator.set_objects(0, poses)
    simulator.step(dt)
    return simulator.read().copy()
