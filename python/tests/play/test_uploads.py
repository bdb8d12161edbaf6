"""Uploaded meshes: units, limits, and files that are none."""

import struct

import numpy as np
import pytest

import taxelsim

pytest.importorskip("viser", reason="viser as in python/requirements/test.txt")

from taxelsim.play.uploads import MAX_BYTES, Upload, checked_name


def stl_of(triangles):
    """A binary STL of triangles (N, 3, 3)."""
    records = b"".join(bytes(12) + np.asarray(triangle, "<f4").tobytes() + bytes(2) for triangle in triangles)
    return bytes(80) + struct.pack("<I", len(triangles)) + records


def tetrahedron(side):
    corners = side * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return corners[[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]]


def test_a_mesh_in_millimetres_is_scaled():
    upload = Upload.of("C:\\parts\\part.STL", stl_of(tetrahedron(20.0)))
    assert (upload.name, upload.likely_unit, upload.num_triangles) == ("part.STL", "mm", 4)
    assert upload.sides == (20, 20, 20)
    np.testing.assert_allclose(np.ptp(upload.mesh("mm", "z", 1e-5).vertices, axis=0), 0.02, rtol=1e-6)
    assert Upload.of("part.stl", stl_of(tetrahedron(0.02))).likely_unit == "m"
    with pytest.raises(taxelsim.InputError, match="unit"):
        upload.mesh("furlong", "z", 1e-5)


@pytest.mark.parametrize("name", ["part.gltf", "part", "../../etc/passwd", ".stl/", "a\nb.stl", ""])
def test_names_of_other_formats_are_refused(name):
    with pytest.raises(taxelsim.InputError, match=r"^mesh: .* is not allowed: a file of \.stl"):
        checked_name(name)


BAD = {
    "noise.stl": bytes(range(256)) * 4,
    "short.stl": stl_of(tetrahedron(1.0))[:-3],
    "huge_claim.stl": bytes(80) + struct.pack("<I", 2**32 - 1),
    "not_finite.stl": stl_of(np.full((1, 3, 3), np.nan)),
    "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999999\n",
    "names_a_file.glb": b"glTF" + struct.pack("<II", 2, 20) + b"{}",
    "header.ply": b"ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n",
    "empty.stl": b"",
}


@pytest.mark.parametrize("name", BAD)
def test_a_file_that_is_no_mesh_is_refused_in_one_line(name):
    with pytest.raises(taxelsim.InputError, match=rf"^{name}: [^\n]+$"):
        Upload.of(name, BAD[name])


def test_a_file_that_is_too_large_is_refused_before_it_is_read():
    with pytest.raises(taxelsim.InputError, match="bytes are not allowed"):
        Upload.of("part.stl", bytes(MAX_BYTES + 1))
