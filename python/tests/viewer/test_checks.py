"""Warnings about where an object is."""

import numpy as np
import pytest

import taxelsim
from taxelsim._arrays import rotation_matrices
from taxelsim.viewer.checks import place_warning
from taxelsim.viewer.source import Episode

BAR = taxelsim.Object(taxelsim.Box(size=[0.01, 0.04, 0.01]), "bar")


def episode_at(sensor, position, counts=1, num_frames=2):
    poses = np.tile([*position, 1, 0, 0, 0], (num_frames, 1))
    images = np.full((num_frames, 6, 14), counts, np.uint16)
    return Episode(7, {"data/time": np.arange(num_frames), "data/pose": poses, "data/tactile_image": images}, sensor)


@pytest.mark.parametrize(
    ("position", "counts", "message"),
    [
        ((0, 0, 0.0045), 1, None),
        ((0, 0, 0.0045), 0, "episode 7: object bar does not touch the sensor in any frame"),
        ((0, 0, 0.03), 1, None),
        ((0, 0, 0.1), 0, "episode 7: object bar is not near the sensor: 0.095 m away, the sensor is 0.0476 m long"),
        ((0, 0, -0.0045), 1, "episode 7: object bar starts behind the skin: is it, or the sensor, upside down?"),
    ],
)
def test_place_of_an_object(sensor, position, counts, message):
    assert place_warning(BAR, episode_at(sensor, position, counts)) == message


def test_a_half_space_is_always_near(sensor):
    assert place_warning(taxelsim.Object(taxelsim.HalfSpace(), "table"), episode_at(sensor, (0, 0, 0))) is None


def test_rotation_matrices_are_those_of_poses():
    generator = np.random.default_rng(1)
    rotations = generator.normal(size=(20, 4))
    rotations /= np.linalg.norm(rotations, axis=1, keepdims=True)
    for rotation, matrix in zip(rotations, rotation_matrices(rotations), strict=True):
        pose = taxelsim.Pose(rotation=rotation)
        np.testing.assert_allclose(matrix.T, [pose.transform(axis) for axis in np.eye(3)], atol=1e-12)
