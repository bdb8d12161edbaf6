"""Paths in the manifest of a data set: no file outside of the given folders is opened."""

import hashlib
import re
from pathlib import Path

import pytest

import taxelsim
from taxelsim.viewer.scene_files import scene_of

MESH = "v 0 0 0\nv 0.01 0 0.01\nv 0 0.01 0.01\nv -0.01 -0.01 0.01\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n"
SCENE = """format_version: 1
name: touch
kind: contacts
sensor: {sensor}
objects: [{{sphere: {{radius_mm: 5}}}}]
randomization: {{load: 1}}
data_set: {{episodes: 1}}
"""


@pytest.fixture
def mesh(tmp_path) -> Path:
    (tmp_path / "secret.obj").write_text(MESH)
    return tmp_path / "secret.obj"


@pytest.fixture(scope="module")
def resolved(tmp_path_factory) -> str:
    """A resolved scene of a sphere, as a manifest has it."""
    file = tmp_path_factory.mktemp("scene") / "touch.yaml"
    file.write_text(SCENE.format(sensor=(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve()))
    return taxelsim.load_scene(file).resolved


def with_object(resolved: str, lines: str) -> str:
    """The scene with another object."""
    return re.sub(r"(?<=^objects:\n)(  .*\n)+", lambda _: "  - name: a\n" + lines, resolved, flags=re.MULTILINE)


def test_a_mesh_is_found_by_name_and_checksum(resolved, mesh):
    digest = hashlib.sha256(mesh.read_bytes()).hexdigest()
    text = with_object(resolved, f'    mesh: secret.obj\n    sha256: "{digest}"\n')
    assert scene_of(text, [mesh.parent], mesh)[1] == set()
    assert scene_of(text, [], mesh)[1] == {0}


@pytest.mark.parametrize(
    "lines",
    [
        "    mesh: {path}\n",
        "    mesh: {up}\n",
        '    "m\\x65sh": "{path}"\n',
        "    mesh: {path}\n    sha256: {digest}\n",
        '    mesh: {up}\n    sha256: "{digest}"\n',
        '    mesh: {path}\n    sha256: "{digest}"\n',
        '    mesh: "\\q"\n    sha256: "{digest}"\n',
        '    mesh: ""\n    sha256: "{digest}"\n',
        "    sphere: {{radius: 0.005}}\n    edge: {{contour: {{file: {path}}}}}\n",
        "    sphere: {{radius: 0.005}}\n    motion: {{waypoints: {{file: {up}}}}}\n",
    ],
)
def test_a_path_is_refused(resolved, mesh, lines):
    digest = hashlib.sha256(mesh.read_bytes()).hexdigest()
    up = "../" * 12 + str(mesh).lstrip("/")
    text = with_object(resolved, lines.format(path=mesh, up=up, digest=digest))
    with pytest.raises(taxelsim.InputError, match="name of a file") as caught:
        scene_of(text, [], mesh.parent)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["sensor", "robot"])
def test_a_block_from_a_file_is_refused(resolved, mesh, key):
    text = re.sub(rf"^{key}:.*\n(  .*\n)*", "", resolved, flags=re.MULTILINE) + f"{key}: {mesh}\n"
    with pytest.raises(taxelsim.InputError, match=f"{key}: .* is not allowed: the name of a file without a folder"):
        scene_of(text, [], mesh.parent)
