"""The scene of a data set, read from its manifest and the files that the manifest names."""

from __future__ import annotations

import glob
import hashlib
import json
import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from .._core import Mesh, Scene, Sensor, load_scene, readable_scene
from .._log import silenced
from ..errors import InputError
from ..program import SCENES

# A resolved scene names a file, without its folder, and its SHA-256 on the next line.
_FILE = re.compile(r'\b(mesh|file): (.+)\n +sha256: "([0-9a-f]{64})"$', re.MULTILINE)

# A scene cannot be read without its meshes: what the reader gets where a mesh is not found. It is never drawn.
_TETRAHEDRON = "v 0 0 0\nv 0.001 0 0.001\nv 0 0.001 0.001\nv -0.001 -0.001 0.001\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n"


# The same for the files of recorded contact points, which only a simulation reads, by the text in front of their key. The scene has the
# numbers of episodes and steps itself.
_RECORDINGS = {
    "contact_points:\n  ": "episode,step,x_m,y_m,z_m,normal_force_N\n0,0,0,0,0,0\n",
    "  sensor_poses:\n    ": "episode,step,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,0,1,0,0,0\n",
}


def _candidates(name: str, folders: Sequence[Path]) -> Iterator[Path]:
    for folder in folders:
        yield from (file for file in sorted(folder.rglob(glob.escape(name))) if file.is_file())


def sha256_of(file: Path) -> str:
    """SHA-256 of a file."""
    digest = hashlib.sha256()
    with file.open("rb") as stream:
        while block := stream.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def sensor_of(scene: Scene, name: str | None) -> Sensor:
    """The sensor of that name of a scene of several, or its only or first one."""
    return dict(scene.sensors).get(name or "", scene.sensor)


def scene_of(text: str, folders: Sequence[Path], origin: Path) -> tuple[Scene, set[int]]:
    """The scene of a data set, and the indices of objects whose mesh is not found: a tetrahedron of 1 mm keeps the
    place of each, and the caller does not draw it. Contact points that are not found are left out.

    text: the resolved scene. folders: searched with their subfolders for the files that it names, by name and SHA-256; then the scenes of
    the package. origin: data set, for messages. Raises InputError for another file that is not found, such as a URDF,
    and for a file that is named with a folder: no file elsewhere is opened.
    """
    text = readable_scene(text)
    is_found: list[bool] = []  # of each mesh, in the order of the objects
    with tempfile.TemporaryDirectory() as root:

        def collected(found: re.Match[str]) -> str:
            key, quoted, sha256 = found.groups()
            try:
                name = json.loads(quoted) if quoted.startswith('"') else quoted
            except ValueError as error:
                raise InputError(f"{origin}: scene: {key}: {quoted} is not allowed: the name of a file") from error
            if not name or Path(name).name != name:
                raise InputError(f"{origin}: scene: {key}: {name!r} is not allowed: the name of a file without a folder")
            file = next((file for file in _candidates(name, [*folders, SCENES]) if sha256_of(file) == sha256), None)
            if key == "mesh":
                is_found.append(file is not None)
            if file is not None:
                shutil.copyfile(file, Path(root, name))
                return found[0]
            for place, (before, content) in enumerate(_RECORDINGS.items()):
                if text[: found.start()].endswith(before):
                    Path(root, f"missing_{place}.csv").write_text(content)
                    return f"file: missing_{place}.csv"
            if key != "mesh":
                raise InputError(f"{origin}: {name} with SHA-256 {sha256} is not found; assets names the folder that holds it")
            Path(root, "missing.obj").write_text(_TETRAHEDRON)
            return "mesh: missing.obj"

        file = Path(root, "scene.yaml")
        file.write_text(_FILE.sub(collected, text), encoding="utf-8")
        with silenced():
            scene = load_scene(file, refuse_folders=True)
    meshes = [index for index, item in enumerate(scene.objects) if isinstance(item.shape, Mesh)]
    return scene, {index for index, found in zip(meshes, is_found, strict=True) if not found}
