"""One step of a simulator as a function of poses and loads, with its gradient. taxelsim.torch and taxelsim.jax share it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ._arguments import checked_names
from ._core import OutputOptions, Sensor
from ._counts import newtons_of_counts
from .errors import InputError
from .frame import Frame
from .simulator import Simulator

Floats = npt.NDArray[np.floating]

OUTPUTS = ("forces", "image")
"""Names of values: true normal forces (N), or the tactile image in newtons by the nominal curve."""

Z = 2  # index of the translation along z in a twist


class Step(NamedTuple):
    """Values of one step and their derivatives, copied."""

    values: npt.NDArray[np.float32]
    """(N, num_rows, num_cols), or (N, num_taxels) for sensors of several patches, N."""
    by_twist: npt.NDArray[np.float32]
    """(N, 6, num_taxels): derivative of the values by a twist of the object, v of the origin of S, then w, in S."""
    load_by_twist: npt.NDArray[np.float32]
    """(N, 6): the same of the force on the object along z of S."""


def outputs_for(outputs: OutputOptions | None = None) -> OutputOptions:
    """`outputs`, default OutputOptions(), with those that the functions of taxelsim.torch and taxelsim.jax need."""
    return (outputs or OutputOptions()).replace(taxel_jacobian=True, clean_tactile_jacobian=True)


def image_shape(sensor: Sensor) -> tuple[int, ...]:
    """Shape of the values of one instance."""
    patches = sensor.patches
    return (patches[0].num_rows, patches[0].num_cols) if len(patches) == 1 else (sensor.num_taxels,)


def check(simulator: Simulator, output: str) -> None:
    """Raises InputError for another output, several objects in an instance, and a simulator without outputs_for()."""
    checked_names("output", output, OUTPUTS)
    if simulator.num_slots != 1 or simulator.options.max_contacts > 0:
        raise InputError("simulator: slots or contact points are not allowed: one object in each instance")
    wanted = simulator.options.outputs
    if not (wanted.taxel_jacobian and wanted.clean_tactile_jacobian and wanted.tactile_normal_force):
        raise InputError("simulator: these outputs are not allowed: Simulator(..., outputs=outputs_for())")


def take_step(simulator: Simulator, ids: npt.ArrayLike, dt: float, output: str, poses: Floats, loads: Floats | None) -> Step:
    """Sets poses and loads, steps and reads. Raises what set_objects(), set_loads() and step() raise."""
    simulator.set_objects(ids, poses)
    simulator.set_loads(loads)
    simulator.step(dt)
    frame = simulator.read()
    truth = frame.ground_truth
    by_twist = -np.asarray(truth.taxel_jacobian, np.float32).reshape(len(poses), 6, -1)  # of the object: minus that of the sensor
    values = np.array(truth.tactile_normal_force)
    if output == "image":
        values, passes = _image(simulator, frame)
        by_twist *= passes.reshape(len(poses), 1, -1)
    return Step(values, by_twist, np.array(truth.jacobian.contact_wrench[:, Z]) * np.asarray(truth.load_reached)[:, np.newaxis])


def _image(simulator: Simulator, frame: Frame) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.bool_]]:
    """The image in newtons, and the taxels above the trigger and below saturation, where the nominal curve follows the force."""
    table, image = newtons_of_counts(simulator.model.sensor.readout), np.array(frame.tactile_image)
    newtons = np.asarray(image if image.dtype == np.float32 else table[image], np.float32)
    passes: npt.NDArray[np.bool_] = (newtons > 0) & (newtons < table[-1])
    return newtons, passes


def pull_back(step: Step, poses: Floats, by_load: bool, cotangent: Floats) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Gradients of a loss by the poses (N, 7) and by the loads (N), from its gradient by the values.

    A twist (v, w) moves the position p by v + w x p and the quaternion q by (0, w) q / 2. With a load the object also moves along z until
    the load is carried: the twists that matter change it by nothing.
    """
    twist = np.einsum("nkt,nt->nk", step.by_twist, np.reshape(cotangent, (len(poses), -1)), dtype=np.float64)
    load_gradient = np.zeros(len(poses))
    if by_load:
        rate = step.load_by_twist.astype(np.float64)
        np.divide(twist[:, Z], rate[:, Z], out=load_gradient, where=rate[:, Z] != 0)
        twist -= load_gradient[:, np.newaxis] * rate
    gradient = np.zeros((len(poses), 7))
    gradient[:, :3] = twist[:, :3]
    torque = twist[:, 3:] - np.cross(poses[:, :3], twist[:, :3])
    w, vector = poses[:, 3:4], poses[:, 4:]
    gradient[:, 3] = -2 * np.einsum("nk,nk->n", torque, vector)
    gradient[:, 4:] = 2 * (w * torque + np.cross(torque, vector))
    return gradient, load_gradient
