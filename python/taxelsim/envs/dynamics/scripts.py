"""Scripted policies of the tasks with dynamics: functions of observations, with touch and blind.

A script gets the observations `contact`, `shear`, `proprioception` and `goal`, and the numbers of steps since the start of each episode.
A blind script replaces what is felt by what is assumed: it is the same program otherwise. A script without shear does so for shear only.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..draws import Array
from . import peg_insert, push, roll
from .models import SERVO

SENSES = ("shear", "normal", "blind")
"""What a script uses: all, all but shear, or nothing that the sensor reports."""

Observation = dict[str, NDArray[Any]]


class Script:
    """A scripted policy of N environments. Keeps the first observations of each episode."""

    def __init__(self, sense: str) -> None:
        self.sense = sense
        self.first: Observation = {}

    def __call__(self, observation: Observation, steps: NDArray[np.int64]) -> NDArray[np.float32]:
        """Actions (N, A). steps (N): number of steps of each episode so far; 0 in its first observation."""
        started = steps == 0
        for name, values in observation.items():
            kept = self.first.setdefault(name, values.copy())
            kept[started] = values[started]
        return np.clip(self.act(observation, steps), -1, 1).astype(np.float32)

    def act(self, observation: Observation, steps: NDArray[np.int64]) -> Array:
        """Actions (N, A), not yet clipped."""
        raise NotImplementedError


class Push(Script):
    """Turns the pad about the point of contact until it pushes towards the target. A turn about the disc would slide along it and drag it.

    With touch the disc is one radius in front of the centre of pressure. Blind it is assumed in front of the middle.
    """

    def act(self, observation: Observation, steps: NDArray[np.int64]) -> Array:
        goal, contact = observation["goal"].astype(np.float64), observation["contact"]
        side = np.zeros(len(goal)) if self.sense == "blind" else np.where(contact[:, 3] > 0, contact[:, 1], 0)
        ahead, aside = goal[:, 0] - push.RADIUS, goal[:, 1] - side
        turn = np.clip(3 * np.arctan2(aside, np.maximum(ahead, 0.03)), -1, 1)  # rad/s
        forward = 3 * ahead + turn * side
        return np.column_stack((forward / 0.06, np.zeros(len(goal)), turn))


class Roll(Script):
    """Moves the palm until the ball is at the goal: the ball rolls half as far as the palm, so it moves back under it.

    Blind the ball is assumed to start in the middle of the array.
    """

    def act(self, observation: Observation, steps: NDArray[np.int64]) -> Array:
        contact, joints = observation["contact"], observation["proprioception"].astype(np.float64)
        assumed = -joints[:, :2] / 2
        felt = np.where(contact[:, 3:] > 0, contact[:, :2], assumed)
        ball = assumed if self.sense == "blind" else felt
        return -8 * (observation["goal"] - ball) / roll.SPEED


class GraspHold(Script):
    """Grips as hard as the load needs.

    With shear: 1.3 times the shear force over the friction coefficient. Without shear: a force that is felt, and holds a middling load.
    Blind: the position of the fingers stays.
    """

    CONSTANT = 3.0  # N

    def act(self, observation: Observation, steps: NDArray[np.int64]) -> Array:
        grip = observation["contact"][:, 3].astype(np.float64)
        if self.sense == "blind":
            return np.zeros((len(grip), 1))
        wanted = np.full(len(grip), self.CONSTANT)
        if self.sense == "shear":
            shear = np.hypot(*observation["shear"][:, :2].astype(np.float64).T)
            wanted = np.maximum(1.3 * shear / observation["goal"][:, 0] + 0.2, 0.5)
        return (0.6 * (wanted - grip))[:, np.newaxis]


class PegInsert(Script):
    """Lowers the peg until it stands on the plate, and moves it towards the hole while it presses lightly.

    The force on the plate comes from the lag of the servo. The plate pushes up on the side of the peg that is away from the hole, which
    tilts the peg in the grasp. A tilt about y of S moves the centre of pressure along x of S, and gives the direction along x of the
    world. A tilt about z of S twists the skin, which is shear, and gives the direction along y. Where nothing is felt, as with the peg over
    a corner of the hole, which carries it on two sides, it moves on a spiral.
    """

    FELT = 0.003  # N m

    def act(self, observation: Observation, steps: NDArray[np.int64]) -> Array:
        joints = observation["proprioception"].astype(np.float64)
        lag = joints[:, 2] - joints[:, 5]  # m; the servo presses with 4000 N/m
        force = SERVO * lag
        standing = force > 1
        down = np.where(standing, -0.4 * (4 - force), -1.0)
        lever, twist, side = self._felt(observation)
        angle, radius = steps * 0.06, 0.003 * np.minimum(steps / 200, 1)
        spiral = np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))
        move = 100 * (spiral - joints[:, :2])
        felt = np.zeros_like(move)
        inside = joints[:, 2] < -peg_insert.START_HEIGHT - 0.0012  # then walls push from the sides: give way
        if self.sense != "blind":
            felt[:, 0] = np.where(~inside & (np.abs(lever) > self.FELT), 100 * lever, 0)
        if self.sense == "shear":
            felt[:, 1] = np.where(inside, 0.1 * side, np.where(np.abs(twist) > self.FELT, -100 * twist, 0))
        follow = (felt.any(axis=1) & standing) | (inside & (self.sense != "blind"))
        move = np.where(follow[:, np.newaxis], felt, move)
        return np.column_stack((np.clip(move, -0.7, 0.7), down))

    def _felt(self, observation: Observation) -> tuple[Array, Array, Array]:
        """Moments about y and z of S of the force that pushes the peg up, N m, and force along y of S, N; changes since the start.

        The moment about y is the shift of the centre of pressure times the first force: the reading of a constant force creeps, its centre
        does not. Friction under a peg that moves is a force along the plate with a lever of GRIP, which is subtracted from the moment about
        z.
        """
        now, then = (frame["contact"].astype(np.float64) for frame in (observation, self.first))
        shear = observation["shear"].astype(np.float64) - self.first["shear"]
        lever = then[:, 3] * (now[:, 0] - then[:, 0])
        return lever, shear[:, 2] - peg_insert.GRIP * shear[:, 1], shear[:, 1]


SCRIPTS = {"Push": Push, "Roll": Roll, "GraspHold": GraspHold, "PegInsert": PegInsert}
"""Scripts by the name of their task."""
