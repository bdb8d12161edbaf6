"""Triangles of solids and taxels."""

import numpy as np
import pytest

import taxelsim
from taxelsim.pictures import taxel_axes
from taxelsim.viewer.shapes import flat_shaded, taxel_quads, triangles_of

# A polygon of n sides has 1 - (2 pi / n)^2 / 6 of the area of its circle. The torus loses most: 0.0029 by 48 sides around its axis, and
# 0.0114 by 24 sides around its tube.
LARGEST_LOSS = 0.0145

SOLIDS = [
    (taxelsim.Sphere(radius=0.01), 4 / 3 * np.pi * 0.01**3),
    (taxelsim.Cylinder(radius=0.01, length=0.03), np.pi * 0.01**2 * 0.03),
    (taxelsim.Capsule(radius=0.01, length=0.03), np.pi * 0.01**2 * 0.03 + 4 / 3 * np.pi * 0.01**3),
    (taxelsim.Cone(radius=0.01, height=0.02), np.pi * 0.01**2 * 0.02 / 3),
    (taxelsim.Torus(major_radius=0.02, minor_radius=0.005), 2 * np.pi**2 * 0.02 * 0.005**2),
    (taxelsim.Box(size=[0.01, 0.02, 0.03]), 6e-6),
]


@pytest.mark.parametrize(("solid", "volume"), SOLIDS, ids=lambda value: type(value).__name__)
def test_solids_are_closed_and_face_outwards(solid, volume):
    vertices, triangles = triangles_of(solid, 1)
    corners = vertices[triangles].astype(np.float64)
    signed = np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6  # divergence theorem
    assert (1 - LARGEST_LOSS) * volume <= signed <= volume * (1 + 1e-6)
    low, high = taxelsim.bounds_of(solid)
    np.testing.assert_allclose([vertices.min(0), vertices.max(0)], [low, high], atol=1e-8)


def test_half_space_is_a_square_that_faces_down():
    vertices, triangles = triangles_of(taxelsim.HalfSpace(), 0.05)
    np.testing.assert_allclose([vertices.min(0), vertices.max(0)], [[-0.05, -0.05, 0], [0.05, 0.05, 0]])
    _, normals = flat_shaded(vertices, triangles)
    np.testing.assert_array_equal(normals, np.tile([0, 0, -1], (6, 1)))


def test_taxel_quads_of_a_curved_sensor_lie_in_their_patches():
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/fingertip_sphere.yaml")
    vertices, triangles = taxel_quads(sensor)
    corners = vertices.reshape(-1, 4, 3)
    np.testing.assert_allclose(corners.mean(1), sensor.taxel_positions, atol=1e-8)
    offsets = corners - sensor.taxel_positions[:, None]
    np.testing.assert_allclose(np.einsum("tcs,ts->tc", offsets, sensor.taxel_normals), 0, atol=1e-8)
    np.testing.assert_allclose(np.cross(*np.moveaxis(taxel_axes(sensor), 1, 0)), sensor.taxel_normals, atol=1e-12)
    assert triangles.max() == len(vertices) - 1
